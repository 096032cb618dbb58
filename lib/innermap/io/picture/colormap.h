// The colours that stand for numbers in pictures.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"

namespace innermap {

// All are told apart by people who are colour-blind. redBlue: blue over pale yellow to red
// (ColorBrewer's RdYlBu turned round; Cynthia Brewer, Apache-2.0). viridis, inferno: dark to light
// (Stéfan van der Walt, Nathaniel Smith, CC0). cividis: dark blue to yellow (Nuñez, Anderton and
// Renslow, "Optimizing colormaps with consideration for color vision deficiency", 2018).
enum class Colormap { redBlue, viridis, cividis, inferno, grey };

// Names as options have them, in the enumeration's order.
const std::vector<std::pair<std::string, Colormap>>& colormapNames();

Setting colormapSetting(Colormap* colormap);

// sRGB, 0 to 1, at t in [0, 1]; beyond, that of the nearer end.
Vec3 colormapColour(Colormap map, double t);

}  // namespace innermap
