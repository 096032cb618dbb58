// Grids of pictures that do not say what they hold.
#include <OpenEXR/ImfChannelList.h>
#include <fmt/format.h>

#include <algorithm>

#include "innermap/core/error.h"
#include "io/volume/detail/volume_source.h"

namespace innermap {
namespace {

using Names = std::vector<std::string>;

Names channelsOf(const Imf::Header& header) {
  Names names;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    names.push_back(c.name());
  return names;
}

std::string layerOf(const std::string& channel) {
  const std::size_t dot = channel.find_last_of('.');
  return dot == std::string::npos ? "" : channel.substr(0, dot + 1);
}

// Vectors (R, G, B or X, Y, Z of one layer) first, then what is left, in the file's order.
std::vector<Names> groups(Names channels) {
  std::vector<Names> vectors, scalars;
  const auto take = [&](const Names& wanted) {
    for (const std::string& name : wanted)
      if (std::find(channels.begin(), channels.end(), name) == channels.end()) return;
    for (const std::string& name : wanted)
      channels.erase(std::find(channels.begin(), channels.end(), name));
    vectors.push_back(wanted);
  };
  for (const std::string& channel : Names(channels)) {
    const std::string layer = layerOf(channel);
    if (channel == layer + "R") take({layer + "R", layer + "G", layer + "B"});
    if (channel == layer + "X") take({layer + "X", layer + "Y", layer + "Z"});
  }
  for (const std::string& channel : channels) scalars.push_back({channel});
  vectors.insert(vectors.end(), scalars.begin(), scalars.end());
  return vectors;
}

}  // namespace

std::vector<VolumeGrid> gridsOfChannels(const std::string& path, const Imf::Header& header,
                                        const Names& names) {
  const Names channels = channelsOf(header);
  std::vector<Names> found = groups(channels);
  if (names.empty())
    throw FileError(path, fmt::format("has no attribute 'gridCount' to say what its channels {} "
                                      "are; give --grids NAME",
                                      fmt::join(channels, ", ")));
  if (names.size() == channels.size()) {
    found.clear();
    for (const std::string& channel : channels) found.push_back({channel});
  }
  if (names.size() != found.size())
    throw FileError(
        path, fmt::format("has the channels {}; give --grids {} name{} (a vector's "
                          "channels together), or one for each channel",
                          fmt::join(channels, ", "), found.size(), found.size() == 1 ? "" : "s"));
  std::vector<VolumeGrid> grids;
  for (std::size_t i = 0; i < names.size(); ++i) {
    VolumeGrid grid;
    grid.name = names[i];
    grid.channels = found[i];
    grid.type = grid.isVector() ? "vec3s" : "float";
    grids.push_back(std::move(grid));
  }
  return grids;
}

}  // namespace innermap
