// Walks through the headers of an EXR file and checks every size in them against the file's,
// because OpenEXR allocates by them before it reads, and reads some values by their type whatever
// the length that the file gives.
#pragma once

#include <cstdint>
#include <istream>
#include <string>

namespace innermap {

// `stream` throws at every access beyond the end. Throws FileError: no EXR file, an attribute
// longer than the rest of the file or than its type, more pixels than its chunks could be listed
// for, tiles far larger than the picture.
void verifyExr(const std::string& path, std::istream& stream, std::uint64_t size);

// The same for the file at `path`.
void verifyExr(const std::string& path);

}  // namespace innermap
