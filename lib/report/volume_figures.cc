#include "innermap/fit/fit_map.h"
#include "innermap/io/exr_slices.h"
#include "innermap/io/pictures.h"
#include "innermap/io/volume_texture.h"
#include "innermap/levelset/level_set.h"
#include "innermap/texture/solid_texture.h"
#include "innermap/transfer/carry.h"
#include "innermap/transfer/distance_transfer.h"
#include "innermap/transfer/geometry.h"
#include "innermap/transfer/inverse_map.h"
#include "report/figures.h"

namespace innermap {
namespace {

Figures errorFigures(const std::string& key, const std::string& name, const BoundaryError& e) {
  return when(e.samples > 0, {{key + "_rms", e.rms, name, "root mean square"},
                              {key + "_p99", e.p99, name, "99% within"},
                              {key + "_max", e.max, name, "largest"}});
}

double voxelSizeOf(const openvdb::FloatGrid::Ptr& grid) {
  return grid ? grid->voxelSize()[0] : 0.0;
}

}  // namespace

Figures figures(const LevelSetCheck& c) {
  return {{"mesh_volume", c.meshVolume, "mesh's volume", "", FigureUnit::volume},
          {"grid_volume", c.gridVolume, "grid's volume", "", FigureUnit::volume},
          {"volume_error", c.volumeError, "volume's error", "of the mesh's volume"},
          {"lost_surface", c.lostSurface, "lost surface",
           "points with no sign change within two voxels", kShare}};
}

Figures figures(const InverseStatistics& s) {
  return together(
      {{{"voxels", s.voxels, "voxels", "of the target that were asked where they come from"},
        {"inside", s.inside, "inside", "of these with their centre inside the target"},
        {"uncovered", s.uncovered, "not reached",
         "in no cell's image: folds, and gaps along the boundary"},
        {"not_inverted", s.failed, "not found", "voxels whose origin was not found"},
        {"not_inverted_inside", s.failedInside, "not found inside", ""},
        // The map itself ends at the surface: its inverse is judged inside.
        {"inverted_fraction", s.invertedInside(), "found",
         "share of the voxels inside whose origin was found", kShare},
        {"inverted_fraction_outside", s.invertedOutside(), "found outside", "likewise", kShare},
        {"largest_residual_voxels", s.largestResidual, "largest residual", "in voxels"}},
       when(s.failedInside > 0, {{"not_inverted_lower", s.failedBox.lower, "not found, box from",
                                  "x, y, z", FigureUnit::length},
                                 {"not_inverted_upper", s.failedBox.upper, "not found, box to",
                                  "x, y, z", FigureUnit::length},
                                 {"not_inverted_at", s.failedAt, "not found at",
                                  "x, y, z of the first", FigureUnit::length}})});
}

Figures massFigures(const CarriedMass& m) {
  return {{m.name + "_before", m.before, m.name + ", mass before", ""},
          {m.name + "_after", m.after, m.name + ", mass after", ""},
          {m.name + "_left", m.left, m.name + ", mass left", "of all other voxels of the source"},
          {m.name + "_cut", m.cut, m.name + ", mass left out", "by --density-limit"}};
}

Figures densityFigures(const CarriedMass& m) {
  return {{m.name + "_largest_ratio", m.largestRatio, m.name + ", growth", "at most"},
          {m.name + "_largest_compression", m.largestCompression, m.name + ", compression",
           "of cells, at most"},
          {m.name + "_cells", m.cells, m.name + ", cells", "that were carried"},
          {m.name + "_folded_cells", m.foldedCells, m.name + ", folded cells", ""}};
}

Figures figures(const ResamplingFigures& r) {
  return {{"input_voxel", r.inputVoxel, "input's voxels", "their edge", FigureUnit::length},
          {"output_voxel", r.outputVoxel, "output's voxels", "their edge", FigureUnit::length},
          {"coarser_share", r.coarserShare, "coarser",
           "share of the inside where the output's are over 1.5 times as coarse as the input's, "
           "moved by the map",
           kShare}};
}

Figures figures(const DistanceTransfer& made) {
  return {{"largest_in_target", made.target.figures.largest, "largest in the target", "",
           FigureUnit::length},
          {"largest_through_map", made.throughFigures.largest, "largest through the map", "",
           FigureUnit::length},
          {"largest_in_source", made.source.figures.largest, "largest in the source", "",
           FigureUnit::length},
          {"outside_fraction", made.outsideFraction, "outside",
           "of the source's voxels that land outside the target", kShare}};
}

Figures targetGridFigures(const DistanceTransfer& made) {
  return {{"target_voxel_size", voxelSizeOf(made.target.surface), "target's voxel size", "",
           FigureUnit::length},
          {"target_interior_voxels", made.target.figures.voxels, "target's voxels inside",
           "with their centre inside"}};
}

Figures solveFigures(const SolidTexture& made) {
  MapSolve solve;
  solve.method = SolveMethod::iterative;
  solve.placement = MapPlacement::shell;
  solve.sources = solve.rank = made.fit.sources;
  solve.collocation = made.fit.collocation;
  solve.iterations = static_cast<int>(made.fit.residuals.size()) - 1;
  solve.distance = made.fit.distance;
  solve.residuals = made.fit.residuals;
  return together({only(figures(solve), {"method", "sources", "collocation", "rank",
                                         "regularization", "iterations", "distance", "residuals"}),
                   {{"channels", made.fit.channels, "channels", "of the texture"}}});
}

Figures figures(const SeamFigures& s) {
  return together({{{"charts", s.charts, "charts", ""},
                    {"edges", s.edges, "edges", "along seams"},
                    {"length", s.length, "length", "of seams", FigureUnit::length},
                    {"length_share", s.lengthShare, "length", "of all edges' length", kShare},
                    {"voxel_share", s.voxelShare, "voxels", "of the inside, along seams", kShare},
                    {"area_share", s.areaShare, "area", "of the surface, along seams", kShare}},
                   errorFigures("colour_difference", "texture's jump", s.colourDifference)});
}

Figures surfaceFigures(const SolidTexture& made) {
  return together(
      {errorFigures("fit_error", "fit's error", made.fit.error),
       errorFigures("colour_error", "colours' error", made.colourError),
       errorFigures("colour_error_at_seams", "colours' error at seams", made.colourErrorAtSeams)});
}

Figures figures(const VolumeTextureResult& r) {
  const auto& size = r.resolution;
  const bool pictures = r.slices > 0, dense = size != openvdb::Coord(0);
  // The schema lists them all, by a result of nothing.
  const bool all = r.format.empty();
  return together(
      {{{"format", r.format, "format", ""}, {"files", r.files.size(), "files", ""}},
       when(all || pictures,
            {{"width", r.width, "width", "pixels"},
             {"height", r.height, "height", "pixels"},
             {"tiles", std::vector<double>{double(r.tileColumns), double(r.tileRows)}, "tiles",
              "columns and rows"},
             {"slices", r.slices, "slices", ""}}),
       when(all || dense,
            {{"resolution",
              std::vector<double>{double(size.x()), double(size.y()), double(size.z())},
              "resolution", "voxels along x, y and z"}}),
       {{"channels", r.channels, "channels", ""},
        {"clamped", r.clamped, "clamped", "values beyond the pixels' largest number"},
        {"rounded", r.inexact, "rounded", "whole numbers that the pixels do not have"}}});
}

Figures figures(const CarriedGeometry& carried) {
  const CarriedPoints& points = carried.points;
  std::uint64_t directions = 0;
  for (const Points& values : carried.directions) directions += values.size();
  return {{"points", carried.ownPoints, "points", ""},
          {"directions", directions, "directions", "vectors and normals"},
          {"points_added", carried.added, "points added", "on split edges"},
          {"points_outside", points.outside, "points outside", "the solid"},
          {"farthest_outside", points.farthest, "farthest outside", "", FigureUnit::diagonals},
          {"points_cut", points.cut, "points cut", "that lie too far outside"},
          {"elements_cut", carried.cutElements, "elements cut", "that use such points"},
          {"points_not_inverted", points.failed, "points without an inverse",
           "which have the nearest place that was found"},
          {"points_folded", carried.folded, "points folded", "where directions mean little"},
          {"splats", carried.splats.degree < 0 ? 0 : carried.ownPoints, "Gaussian splats",
           "of the points"},
          {"opacities_capped", carried.splats.capped, "opacities capped",
           "of splats that shrink more than --splats mass can make up for"},
          {"cells", carried.inverted.cells, "cells", ""},
          {"cells_inverted_before", carried.inverted.before, "cells inverted before", ""},
          {"cells_inverted_after", carried.inverted.after, "cells inverted after", ""}};
}

Figures figures(const ExrSliceResult& r) {
  return {{"count", r.slices, "slices", "parts of slices.exr"},
          {"width", r.columns, "width", "pixels"},
          {"height", r.rows, "height", "pixels"}};
}

Figures figures(const SectionResult& r) {
  return {{"grid", r.grid, "grid", ""},
          {"position", r.position, "plane's position", "", FigureUnit::length},
          {"least", r.least, "least value", "on the plane"},
          {"most", r.most, "largest value", "on the plane"},
          {"range", std::vector<double>{r.lower, r.upper}, "range", "of the colours"}};
}

}  // namespace innermap
