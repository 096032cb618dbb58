// Pictures of meshes of tetrahedra and hexahedra, cut open.
#pragma once

#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/io/picture/colormap.h"
#include "innermap/lattice/cell_mesh.h"

namespace innermap {

struct CellPictureSettings {
  // Cells whose middle is farther this way than the cut are left out, so that the others show.
  Vec3 direction{0, 0, 1};    // any length above 0; the viewer stands there, a little to the side
  double at = 0.5;            // where the cut is, from 0 to 1 through the mesh's box
  double blue = 60, red = 0;  // the values of the ends of the colours; different
  Colormap colormap = Colormap::redBlue;
  std::string label;    // above it
  std::string caption;  // below it
  int pixels = 900;     // height of the view, in [64, 4096]
};

// Draws the cells, whole, each in the colour of its value, with their edges, to a PNG. values: #T +
// #H. The file appears whole or not at all. Throws DataError when sizes disagree or nothing is left
// to show, SettingError, FileError, Cancelled.
void writeCellPicture(const std::string& path, const CellMesh& mesh,
                      const std::vector<double>& values, const CellPictureSettings& settings = {});

}  // namespace innermap
