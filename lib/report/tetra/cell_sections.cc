#include "innermap/tetra/compare_fem.h"
#include "innermap/tetra/hexahedralize.h"
#include "innermap/tetra/remesh_cells.h"
#include "innermap/tetra/tetrahedralize.h"
#include "report/figures.h"
#include "report/report_figures.h"
#include "report/report_sections.h"

namespace innermap {

std::vector<ReportSection> cellSections() {
  const Tetrahedralization tetrahedra;
  const Hexahedralization hexahedra;
  return {{"cells", "Cells", "", cellFigures({}, {}, {}), {}},
          {"boundary", "Boundary", "Of a mesh of cells.", figures(BoundaryFit{}), {}},
          {"topology", "Topology", "Of a mesh of cells.", topologyFigures(tetrahedra), {}},
          {"lattice", "Lattice", "That cells were cut from.", latticeFigures(tetrahedra), {}},
          {"features",
           "Sharp edges",
           "",
           merged({featureFigures(tetrahedra, 1), featureFigures(hexahedra)}),
           {}},
          {"remesh", "Remesh", "Cells carried onto another solid.", figures(Remesh{}, 1), {}},
          {"polycube",
           "Polycube",
           "Cubes that stand in for the solid.",
           merged({figures(Polycube{}), polycubeMeshFigures(0)}),
           {}},
          {"hexahedra", "Hexahedra", "", figures(hexahedra), {}},
          {"boundary_map",
           "Boundary map",
           "Of a surface onto cubes.",
           boundaryMapFigures(MapQuality{}),
           {}},
          {"comparison",
           "Comparison",
           "Harmonic map and finite elements, one value a method in each list.",
           figures(CompareFem{}),
           {}}};
}

}  // namespace innermap
