// Walks through the headers of an EXR file and checks every size in them against the file's,
// because OpenEXR allocates by them before it reads.
#pragma once

#include <cstdint>
#include <istream>
#include <string>

#include "innermap/core/progress.h"

namespace innermap {

// `stream` throws at every access beyond the end. Throws FileError: no EXR file, an attribute
// longer than the rest of the file or not as long as its type says, more pixels than its chunks
// could be listed for.
void verifyExr(const std::string& path, std::istream& stream, std::uint64_t size);

// The same of a file, where it is one of EXR, for libraries that read it themselves.
void verifyIfExr(const std::string& path, const Progress* progress);

}  // namespace innermap
