// `map --jobs`: the fit as one job, and the voxels in shares after it.
#pragma once

#include <string>
#include <vector>

#include "share.h"

namespace innermap::tool {

// The words of `fit` and of `evaluate` that do what this run of `map` does, with the options that
// were given; output: of map, whose files map.ply and map.vdb are theirs.
struct MapCommands {
  std::vector<std::string> fit, evaluate;
};
// Throws UsageError for options that neither has.
MapCommands mapCommands(const std::vector<std::string>& arguments, const std::string& source,
                        const std::string& target, const std::string& output);

}  // namespace innermap::tool
