#include "spelling.h"

#include <utility>

namespace innermap::tool {

std::vector<std::string> spellings(const std::string& name) {
  // Whole words: "-ize" alone is also in "size".
  static const std::vector<std::pair<std::string, std::string>> kPairs = {
      {"colour", "color"},
      {"grey", "gray"},
      {"centre", "center"},
      {"neighbour", "neighbor"},
      {"fibre", "fiber"},
      {"regularisation", "regularization"},
      {"normalise", "normalize"},
      {"optimise", "optimize"},
      {"voxelise", "voxelize"},
      {"tetrahedralise", "tetrahedralize"},
      {"hexahedralise", "hexahedralize"}};
  std::vector<std::string> all = {name};
  const auto addWith = [&](const std::string& from, const std::string& to) {
    for (std::size_t i = 0, known = all.size(); i < known; ++i) {
      const std::size_t at = all[i].find(from);
      if (at == std::string::npos) continue;
      std::string other = all[i];
      all.push_back(other.replace(at, from.size(), to));
    }
  };
  for (const auto& [british, american] : kPairs) {
    const bool isBritish = name.find(british) != std::string::npos;
    addWith(isBritish ? british : american, isBritish ? american : british);
  }
  return all;
}

}  // namespace innermap::tool
