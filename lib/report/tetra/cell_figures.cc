#include <cmath>

#include "innermap/tetra/cells.h"
#include "innermap/tetra/compare_fem.h"
#include "innermap/tetra/hexahedralize.h"
#include "innermap/tetra/remesh_cells.h"
#include "innermap/tetra/tetrahedralize.h"
#include "report/figures.h"

namespace innermap {
namespace {

Figures summaryFigures(const QualitySummary& s, FigureUnit unit) {
  const std::vector<double> cells(s.histogram.begin(), s.histogram.end());
  return together({{{"least", s.least, "least", "", unit},
                    {"one_percent", s.onePercent, "99% above", "", unit},
                    {"mean", s.mean, "mean", "", unit},
                    {"greatest", s.greatest, "greatest", "", unit}},
                   under("histogram", "histogram",
                         {{"lower", s.lower, "from", "", unit},
                          {"bin_width", s.binWidth, "width of a bin", "", unit},
                          {"cells", cells, "cells", "a count a bin"}})});
}

Figures figures(const SurfaceDistance& d) {
  return {{"rms", d.rms, "root mean square", "", kDiagonals},
          {"max", d.max, "largest", "", kDiagonals}};
}

std::optional<double> known(double value) {
  return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

Figures rowOf(const ComparedRow& r) {
  return {
      {"method", std::string(r.charges ? "charges" : "elements"), "methods", ""},
      {"size", r.size, "sizes", "charges, or elements across"},
      {"unknowns", r.unknowns, "unknowns", ""},
      {"seconds", r.seconds, "times", "", FigureUnit::seconds},
      {"memory_bytes", r.memory, "memory", "", FigureUnit::bytes},
      {"iterations", r.iterations, "iterations", ""},
      {"value_error", known(r.value), "errors of values", ""},
      {"gradient_error", known(r.gradient), "errors of gradients", ""},
      {"largest_error", known(r.largest), "largest errors", ""},
      {"jump", r.jump, "jumps of the gradient", "between elements"},
      {"harmonic_energy", known(r.harmonicEnergy), "harmonic energies", ""},
      {"deformation_energy", known(r.deformationEnergy), "deformation energies", ""},
      {"folded", known(r.folded), "folded", "of the inside", FigureUnit::share},
      Figure("inverted", r.inverted, "inverted elements", "").when(!r.charges),
      {"boundary_rms", known(r.boundaryRms), "boundary errors", "root mean square", kDiagonals}};
}

}  // namespace

Figures figures(const CellProof& proof) {
  return {
      {"statement", statementOf(proof), "in words", "proof for the cells as written"},
      {"not_right_side_out", proof.inverted, "not right side out", "somewhere inside; proven"},
      {"undecided", proof.undecided, "not decided", "within rounding"},
      {"right_side_out", proof.rightSideOut(), "right side out", "all of them, proven"},
      {"one_to_one", proof.oneToOne(), "one-to-one", "no two overlap: proven globally"},
      {"meetings", proof.meetings, "boundary meets itself",
       "places where it crosses or touches itself, or may"},
      {"exact", proof.exact, "signs by exact arithmetic", "as rounding might have turned them"}};
}

Figures cellFigures(const CellMesh& mesh, const CellQuality& quality, const CellProof& proof) {
  return together(
      {{{"vertices", mesh.vertices.size(), "vertices", ""},
        {"tetrahedra", mesh.tetrahedra.size(), "tetrahedra", ""},
        {"hexahedra", mesh.hexahedra.size(), "hexahedra", ""},
        {"inverted", quality.invertedTetrahedra + quality.invertedHexahedra, "inverted", "cells"}},
       under("proof", "proof", figures(proof)),
       when(!mesh.tetrahedra.empty(),
            together({under("least_dihedral", "least dihedral angle",
                            summaryFigures(quality.dihedral, FigureUnit::degrees)),
                      {{"greatest_dihedral", quality.greatestAngle, "greatest dihedral angle", "",
                        FigureUnit::degrees}}})),
       when(!mesh.hexahedra.empty(), under("scaled_jacobian", "scaled Jacobian",
                                           summaryFigures(quality.jacobian, FigureUnit::none)))});
}

Figures figures(const BoundaryFit& fit) {
  return together(
      {{{"faces", fit.faces, "faces", ""}, {"inward_faces", fit.inward, "facing inwards", ""}},
       under("to_surface", "off the surface", figures(fit.toSurface)),
       under("from_surface", "surface off the cells", figures(fit.fromSurface))});
}

Figures topologyFigures(const Tetrahedralization& made) {
  const SolidTopology& t = made.topology;
  const bool compared = made.solidTopology.has_value();
  return {{"components", t.components, "components", ""},
          {"cavities", t.cavities, "cavities", ""},
          {"handles", t.handles, "handles", ""},
          {"compared", compared, "compared", "with the solid's"},
          {"kept", compared && *made.solidTopology == t, "kept", "the same as the solid's"}};
}

Figures latticeFigures(const Tetrahedralization& made) {
  return {
      {"edge", made.edge, "edge", "of the cells that were cut", FigureUnit::length},
      {"changed_nodes", made.changedNodes, "changed nodes", "so that the topology is the solid's"}};
}

Figures featureFigures(const Tetrahedralization& made, double diagonal) {
  return {{"curves", made.sharpCurves, "sharp curves", "of the mesh"},
          {"kept", made.keptCurves, "kept", "of these"},
          {"rms", made.sharpRms / diagonal, "off them", "root mean square", kDiagonals},
          {"max", made.sharpMax / diagonal, "off them, at most", "", kDiagonals}};
}

Figures featureFigures(const Hexahedralization& made) {
  const SurfaceDistance& d = made.fromFeatures;
  return {{"length", made.featureLength, "sharp edges' length", "", FigureUnit::length},
          {"rms", d.rms, "off them", "root mean square", kDiagonals},
          {"max", d.max, "off them, at most", "", kDiagonals}};
}

Figures figures(const HexahedronCheck& check) {
  return {{"inverted", check.inverted, "inverted", "somewhere inside"},
          {"inverted_corners", check.invertedCorners, "inverted at corners", ""},
          {"undecided", check.undecided, "not decided", "by the bounds"},
          {"exact", check.exact, "corners by exact arithmetic", ""}};
}

Figures figures(const Hexahedralization& made) {
  return together(
      {{{"pieces", made.pieces, "pieces", "of a block's edge"}},
       under("before", "before repair", figures(made.before)),
       under("after", "after repair", figures(made.after)),
       {{"proven", made.after.proven(), "proven", "no cell is inverted anywhere, by bounds"}}});
}

Figures figures(const Polycube& cube) {
  const auto part = [](const MissedPart& p) -> Figures {
    return {{"volume", p.volume, "volumes", "of parts farther than half a block from all blocks",
             FigureUnit::share},
            {"x", p.centre.x, "x", "", FigureUnit::length},
            {"y", p.centre.y, "y", "", FigureUnit::length},
            {"z", p.centre.z, "z", "", FigureUnit::length}};
  };
  return together({{{"across", cube.across, "blocks across", ""},
                    {"blocks", cube.blocks.count(), "blocks", ""},
                    {"edge", cube.blocks.edge, "block's edge", "", FigureUnit::length},
                    {"handles", cube.handles, "handles", ""},
                    {"cavities", cube.cavities, "cavities", ""},
                    {"missed", cube.missed, "missed", "of the solid's volume that is in no block",
                     FigureUnit::share},
                    {"surplus", cube.surplus, "surplus",
                     "volume of the blocks out of the solid, of the solid's"}},
                   under("missed_parts", "missed", columns(cube.missedParts, part))});
}

Figures figures(const Remesh& made, double diagonal) {
  return {{"inverted_at_rest", made.invertedAtRest, "inverted at rest", "cells as given"},
          {"inverted_carried", made.invertedCarried, "inverted as carried", ""},
          {"inverted", made.inverted, "inverted", "after repair"},
          {"from_coarse", made.fromCoarse, "coarse cells first", "as the map alone did not do"},
          {"linear_map", linearMapStatement(made.sourceProof, made.proof), "linear map",
           "proof for the map that is linear on the cells"},
          {"swaps", made.swaps, "swaps", ""},
          {"collapses", made.collapses, "collapses", ""},
          {"moved_rms", made.repair.moved / diagonal, "moved", "root mean square", kDiagonals},
          {"moved_max", made.repair.farthestMoved / diagonal, "moved at most", "", kDiagonals},
          {"off_surface", made.repair.notLanded, "off the surface", "vertices that slid"},
          {"boundary_vertices_rms", made.boundaryRms, "boundary's vertices off the surface",
           "root mean square", kDiagonals},
          {"boundary_vertices_max", made.boundaryMax, "boundary's vertices off the surface",
           "at most", kDiagonals}};
}

Figures rowFigures(const CompareFem& made) { return columns(made.rows, rowOf); }

Figures figures(const CompareFem& made) {
  return together(
      {rowFigures(made),
       {{"value_order", made.valueOrder, "order of values", "of the elements' convergence"},
        {"gradient_order", made.gradientOrder, "order of gradients", ""}},
       when(made.referenceRms > 0,
            under("reference", "reference",
                  {{"boundary_rms", made.referenceRms, "boundary error", "root mean square",
                    kDiagonals},
                   {"seconds", made.referenceSeconds, "time", "", FigureUnit::seconds}}))});
}

}  // namespace innermap
