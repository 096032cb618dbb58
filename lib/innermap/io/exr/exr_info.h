// What an EXR file holds, without its pixels.
#pragma once

#include <string>
#include <vector>

namespace innermap {

struct ExrPart {
  std::string name;
  int width = 0, height = 0;
  std::vector<std::string> channels;
};

// Throws FileError.
std::vector<ExrPart> readExrInfo(const std::string& path);

// For a terminal, a line a part.
std::string describe(const std::vector<ExrPart>& parts, const std::string& path);

}  // namespace innermap
