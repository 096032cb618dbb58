// The JSON of report/parts.h. Files come from other machines: nothing is taken for granted.
#pragma once

#include <string>

#include "report/part.h"

namespace innermap {

std::string fingerprintOf(const PartRun& run);                   // of all that decides results
std::string runName(const std::string& fingerprint);             // "run.HASH.json"
std::string partName(const Part& part, const std::string& run);  // "frame.0012.HASH.json"
std::string runJson(const PartRun& run);
std::string partJson(const Part& part, const std::string& run);  // run: its fingerprint

// Throw DataError naming `path` for what is cut off, or no such file; parsePart also for a part of
// another run.
PartRun parseRun(const std::string& path, const std::string& text);
Part parsePart(const std::string& path, const std::string& text, const std::string& run);

std::string valueText(const FigureValue& value);  // as JSON

}  // namespace innermap
