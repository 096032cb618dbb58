// What a .usda file says of its volumes, of which it needs to hold no more than writeUsdVolume()
// writes: attributes of a line each, and samples.

#include <algorithm>
#include <string_view>

#include "core/file_bytes.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "io/volume/detail/volume_file_info.h"

namespace innermap {
namespace {

constexpr std::size_t kMostBytes = std::size_t(1) << 28;

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

bool beginsWith(std::string_view text, std::string_view with) {
  return text.substr(0, with.size()) == with;
}

// What stands between the first two of `mark`.
std::string between(std::string_view text, char mark) {
  const std::size_t begin = text.find(mark);
  if (begin == text.npos) return "";
  const std::size_t end = text.find(mark, begin + 1);
  return end == text.npos ? "" : std::string(text.substr(begin + 1, end - begin - 1));
}

}  // namespace

VolumeFileInfo usdInfo(const std::string& path) {
  const OpenFile file(path, "a USD text file");
  if (file.size() > kMostBytes) throw FileError(path, "is too large to refer to volumes");
  std::string text(file.size(), '\0');
  file.read(0, text.data(), text.size());
  if (text.compare(0, 9, "#usda 1.0") != 0)
    throw FileError(path, "does not begin with #usda 1.0: no USD text file");
  VolumeFileInfo info;
  bool asset = false;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size() - 1);
    const std::string_view line = trimmed(rest.substr(0, end + (rest[end] != '\n')));
    rest.remove_prefix(end + 1);
    for (const char* key :
         {"upAxis", "metersPerUnit", "startTimeCode", "endTimeCode", "timeCodesPerSecond"})
      if (beginsWith(line, key) && line.find('=') != line.npos)
        info.facts.emplace_back(key, trimmed(line.substr(line.find('=') + 1)));
    if (beginsWith(line, "def ") || beginsWith(line, "over ")) {
      asset = line.find(" OpenVDBAsset ") != line.npos;
      if (asset) info.grids.emplace_back();
      if (asset) info.grids.back().name = between(line, '"');
    }
    if (!asset) continue;
    VolumeFileInfo::Grid& grid = info.grids.back();
    if (beginsWith(line, "token fieldName ")) grid.name = between(line, '"');
    if (beginsWith(line, "token fieldDataType ")) grid.type = between(line, '"');
    if (const std::string name = between(line, '@'); !name.empty()) grid.files.push_back(name);
  }
  if (info.grids.empty()) throw FileError(path, "refers to no OpenVDB volume");
  return info;
}

}  // namespace innermap
