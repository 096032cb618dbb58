// What a run says at its end: its verdict, and where its files are.
#pragma once

#include <string>
#include <vector>

#include "report/report.h"
#include "terminal_text.h"

namespace innermap::tool {

// "self_intersections" as words.
std::string titleOf(const std::string& name);

// A headline, then a line for each finding and what to try; unmet: how many are not met.
std::string verdictText(const std::vector<ReportFinding>& verdict, std::size_t unmet,
                        const TerminalText& style);

// "wrote out/: map.ply (1.2 MB), map.vdb (30 MB)", a line a folder; of many files of one kind the
// first, the last and all together.
std::vector<std::string> writtenLines(const std::vector<ReportOutput>& outputs);

}  // namespace innermap::tool
