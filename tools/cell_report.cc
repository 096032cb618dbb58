#include "cell_report.h"

#include <fmt/format.h>

namespace innermap::tool {
namespace {

void reportSummary(const std::string& section, const QualitySummary& s, Report& report) {
  report.set(section + ".least", s.least);
  report.set(section + ".one_percent", s.onePercent);
  report.set(section + ".mean", s.mean);
  report.set(section + ".greatest", s.greatest);
  report.set(section + ".histogram.lower", s.lower);
  report.set(section + ".histogram.bin_width", s.binWidth);
  report.setColumn(section + ".histogram.cells", s.histogram, [](std::uint64_t n) { return n; });
}

}  // namespace

void reportCells(const CellMesh& mesh, const CellQuality& quality, Context& context) {
  Report& report = context.report();
  report.set("cells.vertices", mesh.vertices.size());
  report.set("cells.tetrahedra", mesh.tetrahedra.size());
  report.set("cells.hexahedra", mesh.hexahedra.size());
  report.set("cells.inverted", quality.invertedTetrahedra + quality.invertedHexahedra);
  if (!mesh.tetrahedra.empty()) {
    reportSummary("cells.least_dihedral", quality.dihedral, report);
    report.set("cells.greatest_dihedral", quality.greatestAngle);
    context.print(fmt::format(
        "tetrahedra: {}, inverted {}, dihedral angles {:.2f} to {:.2f} degrees, the least one over "
        "{:.1f} in 99%, {:.1f} on average\n",
        mesh.tetrahedra.size(), quality.invertedTetrahedra, quality.dihedral.least,
        quality.greatestAngle, quality.dihedral.onePercent, quality.dihedral.mean));
  }
  if (!mesh.hexahedra.empty()) {
    reportSummary("cells.scaled_jacobian", quality.jacobian, report);
    context.print(fmt::format(
        "hexahedra: {}, inverted {}, scaled Jacobian at least {:.3f}, over {:.3f} in 99%, {:.3f} "
        "on average\n",
        mesh.hexahedra.size(), quality.invertedHexahedra, quality.jacobian.least,
        quality.jacobian.onePercent, quality.jacobian.mean));
  }
}

void reportBoundaryFit(const BoundaryFit& fit, Context& context) {
  Report& report = context.report();
  report.set("boundary.faces", fit.faces);
  report.set("boundary.inward_faces", fit.inward);
  report.set("boundary.to_surface.rms", fit.toSurface.rms);
  report.set("boundary.to_surface.max", fit.toSurface.max);
  report.set("boundary.from_surface.rms", fit.fromSurface.rms);
  report.set("boundary.from_surface.max", fit.fromSurface.max);
  context.print(fmt::format(
      "boundary: {} faces, {} facing inwards; off the surface rms {:.2e}, max {:.2e}; the surface "
      "off it rms {:.2e}, max {:.2e} (of the diagonal)\n",
      fit.faces, fit.inward, fit.toSurface.rms, fit.toSurface.max, fit.fromSurface.rms,
      fit.fromSurface.max));
}

}  // namespace innermap::tool
