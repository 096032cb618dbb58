#include "innermap/correspond/mesh_correspondence.h"
#include "innermap/lattice/outer_surface.h"
#include "innermap/surface/correspond.h"
#include "report/figures.h"

namespace innermap {
namespace {

Figures placeFigures(const Vec3& place, double size) {
  return {{"x", place.x, "x", "", FigureUnit::length},
          {"y", place.y, "y", "", FigureUnit::length},
          {"z", place.z, "z", "", FigureUnit::length},
          {"size", size, "size", "across", FigureUnit::length}};
}

Figures energyFigures(const MapQuality& q) {
  return {
      {"energy_forward", q.energyForward, "energy forward",
       "how much lengths change from source to target, symmetric Dirichlet's first half"},
      {"energy_backward", q.energyBackward, "energy backward", "the same from target to source"}};
}

// First maps of the first shell, which the inside chose between, best first; and the way taken.
Figures wayFigures(const ShellCorrespondence& shell) {
  const OtherWay none, &other = shell.other ? *shell.other : none;
  const auto considered = [](const ConsideredMap& m) -> Figures {
    return {{"origin", m.origin, "origin", "of the ways that were considered, best first"},
            {"energy", m.energy, "energy", ""},
            {"score", m.score, "score", ""},
            {"turn", m.turn, "turn", "", FigureUnit::degrees},
            {"way", m.way, "way", "ways that differ little share a number, as in --choose"}};
  };
  const auto both = [](const std::array<double, 2>& a) { return std::vector<double>{a[0], a[1]}; };
  return together(
      {{{"way", shell.way, "way round", "that was taken, by preference"}},
       when(shell.other.has_value(),
            under("other_way", "other way",
                  {{"way", other.way, "number", "that --choose takes it by"},
                   {"score", both(other.score), "scores", "of the one taken and of this one"},
                   {"turn", both(other.turn), "turns", "likewise", FigureUnit::degrees}})),
       when(!shell.considered.empty(),
            under("considered", "considered", columns(shell.considered, considered)))});
}

}  // namespace

Figures placeFigures(const std::vector<Box3>& boxes) {
  return columns(boxes, [](const Box3& b) { return placeFigures(b.center(), b.diagonal()); });
}

Figures outerSurfaceFigures(const std::optional<OuterSurface>& taken) {
  const OuterSurface none, &outer = taken ? *taken : none;
  const auto change = [](const TopologyChange& c) { return placeFigures(c.place, c.size); };
  return together(
      {{{"taken", taken.has_value(), "outer surface",
         "innermap maps it in place of a mesh that crosses itself"}},
       when(taken.has_value(),
            together(
                {{{"edge", outer.edge, "lattice's cells", "their edge", FigureUnit::length},
                  {"vertices", outer.mesh.vertices.size(), "vertices", ""},
                  {"handles", outer.topology.handles, "handles", "0 for a ball, 1 for a ring"},
                  {"inside_out", outer.insideOut, "inside out",
                   "share of the mesh's surface that bounds winding number -1", FigureUnit::share},
                  {"left_out", outer.leftOut, "left out", "parts of the solid"},
                  {"left_out_share", outer.leftOutShare, "left out", "their share of the volume",
                   FigureUnit::share},
                  {"apart_p99", outer.apartP99, "mesh from its outer surface",
                   "99% of what shows is as near", kDiagonals},
                  {"apart_max", outer.apartMax, "mesh from its outer surface", "at most",
                   kDiagonals}},
                 when(!outer.caps.empty(), under("cap_places", "caps", placeFigures(outer.caps))),
                 under("cuts", "cuts", columns(outer.cuts, change)),
                 under("plugs", "closed tunnels", columns(outer.plugs, change))}))});
}

Figures figures(const Quantiles& q) {
  return {{"median", q.median, "median", ""},
          {"p99", q.p99, "99% within", ""},
          {"max", q.max, "largest", ""}};
}

Figures figures(const LayoutQuality& q) {
  return {
      {"flips", q.flips, "flips", "triangles of the layout that are turned over"},
      {"degree", q.degree, "degree", "how often the one surface covers the other; it should be 1"},
      {"area_ratio_log10", q.areaRatioLog10, "area ratios",
       "decades between the smallest and the largest on the layout"}};
}

Figures correspondenceFigures(const MeshCorrespondence* map) {
  const MapQuality noQuality, &q = map ? map->quality : noQuality;
  const std::optional<OuterSurface> noOuter;
  const bool shells = map && !map->map.shells.empty();
  const ShellCorrespondence noShell, &first = shells ? map->map.shells.front() : noShell;
  const std::size_t landmarks = map ? map->landmarks : 0;
  return together(
      {{Figure("farthest_from_outer_surface", map ? map->farthestFromOuter.value_or(0) : 0,
               "from the outer surface", "farthest distance of a vertex of the source", kDiagonals)
            .when(map && map->farthestFromOuter)},
       figures(LayoutQuality{q.flips, q.degree, q.areaRatioLog10}),
       energyFigures(q),
       {{"energy_sum", q.energyForward + q.energyBackward, "energy",
         "both together; the least of the ways that were tried"}},
       under("stretch", "stretch", figures(q.stretch)),
       under("triangle_stretch", "triangles' stretch", figures(q.triangleStretch)),
       {{"unmeasured", q.unmeasured, "not measured", "samples that fell on slivers",
         FigureUnit::share},
        {"inverted_triangles", q.invertedTriangles, "turned over",
         "triangles of the source that lie on the target upside down"},
        {"inverted_share", q.invertedShare, "turned over", "their share of the area",
         FigureUnit::share}},
       under("deviation", "off the target", figures(q.deviation)),
       under("deviation_of_target", "target off the image", figures(q.backDeviation)),
       {{"image_self_intersections", q.imageSelfIntersections, "self-intersections",
         "of the source as laid on the target"},
        {"target_self_intersections", q.targetSelfIntersections, "of the target",
         "self-intersections that it had"},
        {"landmarks", landmarks, "landmarks", "pairs of points that were given"},
        Figure("landmark_error", map ? map->landmarkError : 0, "landmark error",
               "largest distance between the two", kDiagonals)
            .when(landmarks > 0),
        {"vertices", map ? map->source.vertices.size() : 0, "vertices",
         "of the source as it was laid"},
        {"target_vertices", map ? map->b.mesh.vertices.size() : 0, "target's vertices", ""},
        {"subdivided", map && map->changed, "subdivided", "whether triangles were split"}},
       under("source_outer_surface", "source", outerSurfaceFigures(map ? map->a.outer : noOuter)),
       under("target_outer_surface", "target", outerSurfaceFigures(map ? map->b.outer : noOuter)),
       wayFigures(first)});
}

Figures boundaryMapFigures(const MapQuality& q) {
  return together(
      {energyFigures(q), prefixed("stretch_", only(figures(q.stretch), {"p99", "max"}))});
}

}  // namespace innermap
