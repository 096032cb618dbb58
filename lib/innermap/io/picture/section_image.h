// One picture of a cross-section: a grid's values as colours, from blue (least) to red (most)
// unless another colormap is chosen, with the colour bar, the range, the grid's name and the place
// written on it.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/io/picture/colormap.h"

namespace innermap {

enum class Component { x = 0, y = 1, z = 2, length = 3 };  // of vector grids

// How values go along the colours.
// linear: in even steps. logarithmic: so are their ratios; what is not above 0 has the first
// colour. about1: ratios to 1, which has the middle colour; what is not above 0 is folded, in a
// colour that
//         is in no colormap.
// automatic: about1 for `jacobian`, if there are values from 1/4 to 4; else logarithmic where all
// values are above 0 and the largest
//         is over 100 times the least, outliers aside. linear when a range is given; folds keep
//         their colour.
enum class SectionScale { automatic, linear, logarithmic, about1 };

struct SectionSettings {
  std::string grid;  // name of the grid to show; empty: the first of jacobian, deformation_energy,
                     // harmonic_energy, map, density, surface that is there, else the first grid
  Component component = Component::length;  // ignored for scalar grids
  // A vector grid's values as linear red, green and blue, without a colour bar; by default of `Cd`
  // or `color`. The range is what is black and white, [0, 1] when unset.
  bool colour = false;
  int axis = 2;                    // 0, 1, 2: x, y, z
  double at = 0.5;                 // fraction of the active box along the axis, in [0, 1]
  std::optional<double> position;  // world coordinate along the axis; wins over `at`
  std::optional<std::pair<double, double>> range;  // of the colours; unset: from the values inside
  double outliers = 0.005;  // share of values cut off at each end when the range is unset, [0, 0.5)
  SectionScale scale = SectionScale::automatic;
  Colormap colormap = Colormap::redBlue;
  int pixels = 900;  // longer side of the section itself, in [64, 8192]
};

// Without the grid and the range.
std::vector<Setting> describe(SectionSettings& settings);
Setting scaleSetting(SectionScale* scale);

struct SectionResult {
  std::string grid;
  double position = 0;                        // world coordinate of the cut
  double least = 0, most = 0;                 // values inside the cut, all of them
  double lower = 0, upper = 0;                // the colours' range
  SectionScale scale = SectionScale::linear;  // not automatic
  int width = 0, height = 0;                  // of the picture
};

// Writes a PNG (8 bits, sRGB). The cut is interpolated between voxels, over active ones only. The
// solid is where `surface` is negative, else where `density` is over one half, else where the grid
// is active; outside it the picture is light grey. Inside, voxels that are not active are grey and
// values that are not finite black.
// The file appears whole or not at all. Throws FileError, DataError (no such grid, nothing of the
// solid in the cut), SettingError, MemoryError, Cancelled.
SectionResult writeSectionImage(const std::string& path, const openvdb::GridPtrVec& grids,
                                const SectionSettings& settings = {});

// Need of that in bytes, beside the grids. Throws as writeSectionImage does of its settings.
std::uint64_t sectionImageMemory(const openvdb::GridPtrVec& grids, const SectionSettings& settings);

}  // namespace innermap
