#include <algorithm>

#include "innermap/io/pictures.h"

namespace innermap {
namespace {

// 0 to 255, evenly spaced.
const std::vector<Vec3>& stopsOf(Colormap map) {
  static const std::vector<Vec3> kStops[] = {
      {{49, 54, 149},
       {69, 117, 180},
       {116, 173, 209},
       {171, 217, 233},
       {224, 243, 248},
       {255, 255, 191},
       {254, 224, 144},
       {253, 174, 97},
       {244, 109, 67},
       {215, 48, 39},
       {165, 0, 38}},
      {{68, 1, 84},
       {72, 37, 118},
       {65, 68, 135},
       {53, 96, 141},
       {42, 120, 142},
       {33, 144, 140},
       {34, 168, 132},
       {67, 191, 113},
       {122, 209, 81},
       {187, 223, 39},
       {253, 231, 37}},
      {{0, 32, 77},
       {49, 68, 107},
       {102, 105, 112},
       {149, 143, 120},
       {203, 186, 105},
       {255, 234, 70}},
      {{0, 0, 4}, {66, 10, 104}, {147, 38, 103}, {221, 81, 58}, {252, 165, 10}, {252, 255, 164}},
      {{20, 20, 20}, {240, 240, 240}}};
  return kStops[static_cast<int>(map)];
}

}  // namespace

const std::vector<std::pair<std::string, Colormap>>& colormapNames() {
  static const std::vector<std::pair<std::string, Colormap>> kNames = {
      {"red-blue", Colormap::redBlue},
      {"viridis", Colormap::viridis},
      {"cividis", Colormap::cividis},
      {"inferno", Colormap::inferno},
      {"grey", Colormap::grey}};
  return kNames;
}

Vec3 colormapColour(Colormap map, double t) {
  const std::vector<Vec3>& stops = stopsOf(map);
  const auto last = static_cast<double>(stops.size() - 1);
  const double place = t > 0 ? std::min(t, 1.0) * last : 0;
  const auto i = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  const double share = place - static_cast<double>(i);
  return ((1 - share) * stops[i] + share * stops[i + 1]) / 255;
}

Setting colormapSetting(Colormap* colormap) {
  return {"colormap", "NAME", choiceOf<Colormap>(colormap, colormapNames()),
          "colours of the picture, from least to most; colour-blind people can tell them apart"};
}

}  // namespace innermap
