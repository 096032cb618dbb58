#include "tetra/cell_report.h"

#include <fmt/format.h>

#include "innermap/io/cell_file.h"
#include "innermap/io/solid_pictures.h"
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

void reportBoundary(const CellMesh& mesh, const Solid& solid, const CellProof& proof,
                    Context& context) {
  BoundaryFitSettings known;
  known.boundary = &proof.boundary;
  reportBoundaryFit(context.timed("boundary", [&] { return boundaryFit(mesh, solid, known); }),
                    context);
}

void drawCells(const std::string& path, const CellMesh& mesh, const CellQuality& quality,
               const SectionOptions& cut, const std::string& label, Context& context) {
  if (path.empty()) return;
  CellPictureSettings settings = cut.cellPicture(label);
  std::vector<double> values(quality.leastDihedral.begin(), quality.leastDihedral.end());
  for (const float jacobian : quality.scaledJacobian) values.push_back(settings.blue * jacobian);
  settings.caption = fmt::format("{} of each of {} cells",
                                 mesh.hexahedra.empty()
                                     ? "least dihedral angle (red 0, yellow 30, blue 60 degrees)"
                                     : "scaled Jacobian (red 0, yellow 0.5, blue 1)",
                                 values.size());
  context.timed("picture", [&] { writeCellPicture(path, mesh, values, settings); });
}

void writeCellFile(const std::string& path, const CellMesh& mesh, Context& context) {
  for (const std::string& field : context.timed("write", [&] { return writeCells(path, mesh); }))
    context.warning(path + ": its format cannot hold the field '" + field + "'; it is left out");
}

}  // namespace innermap::tool
