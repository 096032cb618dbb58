#include "cell_report.h"

#include <fmt/format.h>

#include "report/figures.h"

namespace innermap::tool {

void reportCells(const CellMesh& mesh, const CellQuality& quality, const CellProof& proof,
                 Context& context) {
  context.report().add("cells", cellFigures(mesh, quality, proof));
  if (!mesh.tetrahedra.empty()) {
    context.print(fmt::format(
        "tetrahedra: {}, inverted {}, dihedral angles {:.2f} to {:.2f} degrees, the least one over "
        "{:.1f} in 99%, {:.1f} on average\n",
        mesh.tetrahedra.size(), quality.invertedTetrahedra, quality.dihedral.least,
        quality.greatestAngle, quality.dihedral.onePercent, quality.dihedral.mean));
  }
  if (!mesh.hexahedra.empty()) {
    context.print(fmt::format(
        "hexahedra: {}, inverted {}, scaled Jacobian at least {:.3f}, over {:.3f} in 99%, {:.3f} "
        "on average\n",
        mesh.hexahedra.size(), quality.invertedHexahedra, quality.jacobian.least,
        quality.jacobian.onePercent, quality.jacobian.mean));
  }
  context.print(statementOf(proof) + "\n");
}

void reportBoundaryFit(const BoundaryFit& fit, Context& context) {
  context.report().add("boundary", figures(fit));
  context.print(fmt::format(
      "boundary: {} faces, {} facing inwards; off the surface rms {:.2e}, max {:.2e}; the surface "
      "off it rms {:.2e}, max {:.2e} (of the diagonal)\n",
      fit.faces, fit.inward, fit.toSurface.rms, fit.toSurface.max, fit.fromSurface.rms,
      fit.fromSurface.max));
}

}  // namespace innermap::tool
