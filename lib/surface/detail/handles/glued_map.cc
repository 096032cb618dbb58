#include "surface/detail/handles/glued_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "innermap/core/error.h"
#include "surface/detail/refining/coarse_map.h"
#include "surface/detail/refining/coarse_to_fine.h"
#include "surface/detail/refining/decimate.h"
#include "surface/detail/refining/pullback_energy.h"
#include "surface/detail/refining/target_metric.h"
#include "surface/detail/sphere/star_kernel.h"
#include "surface/detail/topology/half_edges.h"

namespace innermap {
namespace {

constexpr std::size_t kCoarse = 150;  // vertices, next to those that are fixed
constexpr std::size_t kOnRim = 6;     // vertices of a rim in the coarsest mesh
constexpr double kBeside = 2.5;       // vertices beside rims for each of those on them
// Most of the energy of a star around a vertex that is being brought to its place, in that of mean
// stars; raised from the first to the last where nothing moves any more. In a coarse mesh there may
// be no room for some.
constexpr double kBound = 5, kMostBound = 1e6, kCoarseBound = 1e4;
constexpr int kPatience = 5, kRounds = 300;
constexpr int kCycles = 3;         // of coarsening and refining, at most
constexpr double kSound = 100;     // energy of maps without crushed triangles; 8 for isometries
constexpr double kSamples = 4000;  // of the energy, while rims are brought to their places
constexpr double kFineSamples = 30000;  // and at last

// Collapses every other vertex of a closed path along it, where the mesh and the layout allow;
// vertices that must stay do. The path is updated.
void thinOut(ProgressiveMesh& mesh, const Layout& layout, std::vector<int>& path,
             const std::vector<char>& keep) {
  Ring ring;
  RingPlaces places;
  std::vector<int> left;
  bool last = false;  // whether the vertex before has gone
  for (std::size_t i = 0; i < path.size(); ++i) {
    const int v = path[i];
    const bool closes = i + 1 == path.size() && !left.empty() && left[0] != path[0];
    if (last || i == 0 || closes || keep[v]) {
      left.push_back(v);
      last = false;
      continue;
    }
    mesh.ring(v, ring);
    ringPlaces(layout, ring, places);
    std::size_t w = 0;
    while (w < ring.size() && ring[w].vertex != left.back()) ++w;
    bool possible = w < ring.size() && mesh.collapsible(ring, w);
    for (std::size_t k = w + 1; possible && k + 1 < w + ring.size(); ++k)
      possible =
          tripleProduct(places[w], places[k % ring.size()], places[(k + 1) % ring.size()]) > 1e-12;
    if (possible)
      mesh.collapse(v, ring[w]);
    else
      left.push_back(v);
    last = possible;
  }
  path = left;
}

class GluedMapper {
 public:
  GluedMapper(const CutPair& pair, const GluedMapSettings& settings)
      : pair_(pair), settings_(settings), target_(pair.b.surface, pair.layoutOfB) {}

  GluedMap run() {
    bringCentres();
    seam_ = seamed(pair_.a, start_, pair_.b, pair_.layoutOfB, inPlace());
    for (const auto& [v, p] : seam_.fixed) anchors_.push_back({v, onSphere(p)});
    anchors_.insert(anchors_.end(), landmarks_.begin(), landmarks_.end());
    splitChords();
    bringRims();
    GluedMap out;
    out.energy = energy_;
    std::vector<SurfacePoint> images;
    for (std::size_t v = 0; v < pair_.a.vertexOf.size(); ++v) {
      const Vec3& p = seam_.layout.place[v];
      const Located where = target_.locator().find(p);
      images.push_back({where.triangle, target_.locator().barycentric(p, where)});
    }
    out.exact = seam_.fixed;
    out.exact.insert(out.exact.end(), exactLandmarks_.begin(), exactLandmarks_.end());
    for (const auto& [v, p] : out.exact)
      if (static_cast<std::size_t>(v) < images.size()) images[v] = p;
    std::vector<SurfacePoint> uncut = onUncut(pair_.b, images);
    int vertices = 0;  // before the cut; copies come after them
    for (const int v : pair_.a.vertexOf) vertices = std::max(vertices, v + 1);
    uncut.resize(static_cast<std::size_t>(vertices));
    for (const auto& [v, p] : settings_.landmarks) uncut[v] = p;
    out.onTarget = std::move(uncut);
    out.cut = std::move(seam_.cut);
    out.image = std::move(seam_.layout);
    return out;
  }

 private:
  Vec3 onSphere(const SurfacePoint& p) const {
    return placeOnSphere(pair_.b.surface, pair_.layoutOfB, p);
  }

  // The match once A's layout lies on B's.
  HandleMatch inPlace() const {
    HandleMatch match = pair_.match;
    match.rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    return match;
  }

  // A map with the caps' centres and the landmarks in place; rims lie where they may.
  void bringCentres() {
    const ClosedSurface& surface = pair_.a.surface;
    std::vector<Anchor> fixed;
    for (std::size_t i = 0; i < pair_.a.handles.size(); ++i) {
      const CutHandle &ha = pair_.a.handles[i],
                      &hb = pair_.b.handles[static_cast<std::size_t>(pair_.match.target[i])];
      for (std::size_t side = 0; side < 2; ++side)
        fixed.push_back(
            {ha.centre[side],
             pair_.layoutOfB.place[hb.centre[pair_.match.swapped[i] ? 1 - side : side]]});
    }
    placeLandmarks();
    fixed.insert(fixed.end(), landmarks_.begin(), landmarks_.end());
    Layout turned = pair_.layoutOfA;
    for (Vec3& p : turned.place) {
      p = pair_.match.rotation * p;
      p = p / norm(p);
    }
    ProgressiveMesh mesh(surface.vertices.size(), surface.triangles);
    DecimateSettings decimation;
    decimation.vertices = kCoarse + 6 * fixed.size();
    decimation.layout = &turned;
    decimation.keep.assign(surface.vertices.size(), 0);
    for (const Anchor& a : fixed) decimation.keep[a.vertex] = 1;
    decimate(mesh, surface.vertices, decimation);
    const CoarseSurface coarse = coarseSurface(surface, mesh);
    Layout start;
    for (const int v : coarse.vertex) start.place.push_back(turned.place[v]);
    CoarseMapSettings relax;
    for (const Anchor& a : fixed) relax.fixed.push_back({coarse.index[a.vertex], a.target});
    std::optional<CoarseMap> map = relaxCoarse(coarse, start, target_, relax);
    if (!map) {
      map.emplace();
      map->image = start;
      ProgressiveMesh all(coarse.vertex.size(), coarse.surface.triangles);
      const std::vector<char> placed =
          draw(coarse.surface, all, map->image, relax.fixed, kMostBound);
      for (const Anchor& a : relax.fixed)
        if (!placed[a.vertex]) fail();
    }
    start_ = turned;
    for (std::size_t i = 0; i < coarse.vertex.size(); ++i)
      start_.place[coarse.vertex[i]] = map->image.place[i];
    // All others where their rings let them.
    PullbackEnergy energy(surface, mesh, start_, target_, kSamples);
    RelaxSettings unrelaxed;
    unrelaxed.sweeps = unrelaxed.lastSweeps = 0;
    CoarseToFine fine(mesh, start_, energy, decimation.keep, unrelaxed);
    fine.relaxAll(0);
    if (fine.refine(surface.vertices.size()) >= 0) fail();
  }

  void placeLandmarks() {
    std::vector<SurfacePoint> points;
    for (const auto& [v, p] : settings_.landmarks) points.push_back(p);
    points = onCut(pair_.b, points);
    std::vector<char> onRim(pair_.a.surface.vertices.size(), 0);
    for (const CutHandle& handle : pair_.a.handles)
      for (const std::vector<int>& rim : handle.loop)
        for (const int v : rim) onRim[v] = 1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const int v = settings_.landmarks[i].first;
      if (onRim[v])
        throw DataError(fmt::format(
            "landmarks: number {} lies on the line that handles of {} are cut along; move it to a "
            "vertex beside it",
            i + 1, pair_.a.surface.name));
      landmarks_.push_back({v, onSphere(points[i])});
      exactLandmarks_.push_back({v, points[i]});
    }
  }

  // Coarsens the rims round by round with what lies beside them; then brings those of each round
  // to their places before the next return.
  void bringRims() {
    const ClosedSurface& surface = seam_.cut.surface;
    ProgressiveMesh mesh(surface.vertices.size(), surface.triangles);
    const std::vector<std::size_t> stops = coarsen(mesh);
    for (std::size_t stop = stops.size(); stop-- > 0;) {
      if (stop + 1 < stops.size()) grow(mesh, stops[stop]);
      pull(mesh);
    }
    refineWith(mesh, 0);
    if (!arePlaced(anchors_) && !pull(mesh)) fail();
    for (int cycle = 0; cycle < kCycles; ++cycle) {
      // Triangles that were crushed on the way keep one another from growing; coarsened away, they
      // return where there is room.
      ProgressiveMesh again(surface.vertices.size(), surface.triangles);
      DecimateSettings decimation;
      decimation.keep = placed_;
      decimation.vertices =
          kCoarse + static_cast<std::size_t>(1.3 * static_cast<double>(anchors_.size()));
      decimation.layout = &seam_.layout;
      decimate(again, surface.vertices, decimation);
      const double before = energy_;
      refineWith(again, settings_.refine || cycle > 0 ? 12 : 2);
      if (energy_ < kSound || (cycle > 0 && energy_ > 0.9 * before)) break;
    }
  }

  // All vertices return, relaxed in sweeps at most so many.
  void refineWith(ProgressiveMesh& mesh, int sweeps) {
    PullbackEnergy energy(seam_.cut.surface, mesh, seam_.layout, target_, kFineSamples);
    RelaxSettings relax;
    relax.stage = "refining the map";
    relax.sweeps = std::min(sweeps, 4);
    relax.lastSweeps = std::min(sweeps, 8);
    relax.parallel = true;
    CoarseToFine fine(mesh, seam_.layout, energy, placed_, relax);
    fine.relaxAll(sweeps);
    if (fine.refine(seam_.cut.surface.vertices.size()) >= 0) fail();
    energy_ = energy.total();
  }

  // Triangles outside the caps whose corners are all fixed could not give way: edges between fixed
  // vertices get a free one.
  void splitChords() {
    std::vector<char> fixed(seam_.cut.surface.vertices.size(), 0);
    for (const Anchor& a : anchors_) fixed[a.vertex] = 1;
    const HalfEdges edges(seam_.cut.surface.triangles);
    const std::vector<int>& of = seam_.cut.triangleOf;
    const auto inCap = [&of](int h) { return of[static_cast<std::size_t>(h / 3)] < 0; };
    std::vector<EdgeSplit> chords;
    for (int h = 0; h < edges.size(); ++h)
      if (edges.edge(h) == h && fixed[edges.tail(h)] && fixed[edges.head(h)] && !inCap(h) &&
          !inCap(edges.opposite(h)))
        chords.push_back({edges.tail(h), edges.head(h), 0.5});
    splitEdges(seam_.cut, seam_.layout, chords);
  }

  // The numbers of vertices at which rims are complete, half complete and so on.
  std::vector<std::size_t> coarsen(ProgressiveMesh& mesh) {
    const ClosedSurface& surface = seam_.cut.surface;
    std::vector<std::vector<int>> rims;
    std::vector<char> always(surface.vertices.size(), 0);
    for (const CutHandle& handle : seam_.cut.handles)
      for (std::size_t side = 0; side < 2; ++side) {
        rims.push_back(handle.loop[side]);
        always[handle.centre[side]] = 1;
      }
    for (const Anchor& a : landmarks_) always[a.vertex] = 1;
    std::vector<std::size_t> stops;
    for (bool thinner = true; thinner;) {
      DecimateSettings decimation;
      decimation.keep = always;
      std::size_t onRims = 0;
      for (const std::vector<int>& rim : rims) {
        for (const int v : rim) decimation.keep[v] = 1;
        onRims += rim.size();
      }
      decimation.vertices = kCoarse + landmarks_.size() +
                            static_cast<std::size_t>((1 + kBeside) * static_cast<double>(onRims));
      decimation.layout = &seam_.layout;
      decimate(mesh, surface.vertices, decimation);
      stops.push_back(mesh.vertexCount());
      thinner = false;
      for (std::vector<int>& rim : rims) {
        const std::size_t before = rim.size();
        if (before >= 2 * kOnRim) thinOut(mesh, seam_.layout, rim, always);
        thinner = thinner || rim.size() < before;
      }
    }
    return stops;
  }

  void grow(ProgressiveMesh& mesh, std::size_t vertices) {
    PullbackEnergy energy(seam_.cut.surface, mesh, seam_.layout, target_, kSamples);
    RelaxSettings relax;
    relax.lastSweeps = 2;
    relax.parallel = true;
    if (CoarseToFine(mesh, seam_.layout, energy, placed_, relax).refine(vertices) >= 0) fail();
  }

  // Brings all anchors that are present to their places; false when some stay free, as between
  // vertices that are fixed a coarse mesh may have no room.
  bool pull(ProgressiveMesh& mesh) {
    std::vector<Anchor> present;
    for (const Anchor& a : anchors_)
      if (mesh.present(a.vertex)) present.push_back(a);
    placed_ = draw(seam_.cut.surface, mesh, seam_.layout, present,
                   mesh.collapses() > 0 ? kCoarseBound : kMostBound);
    return arePlaced(present);
  }

  bool arePlaced(const std::vector<Anchor>& anchors) const {
    return std::all_of(anchors.begin(), anchors.end(),
                       [this](const Anchor& a) { return placed_[a.vertex] != 0; });
  }

  // Moves anchors on one by one, the others giving way. #V: those that have arrived, exactly.
  std::vector<char> draw(const ClosedSurface& surface, ProgressiveMesh& mesh, Layout& layout,
                         const std::vector<Anchor>& anchors, double mostBound) {
    PullbackEnergy energy(surface, mesh, layout, target_, kSamples);
    RelaxSettings relax;
    relax.lastSweeps = 4;
    std::vector<char> placed(surface.vertices.size(), 0);
    for (const Anchor& a : anchors) placed[a.vertex] = 1;
    CoarseToFine holding(mesh, layout, energy, placed, relax);
    holding.relaxAll(1);
    const double mean = 30 / static_cast<double>(mesh.vertexCount());
    double bound = kBound * mean, nearest = std::numeric_limits<double>::infinity();
    int idle = 0;
    for (int round = 0; round < kRounds && bound < mostBound * mean; ++round) {
      const double left = advance(layout, anchors, energy, bound);
      if (left <= 0) break;
      holding.relaxAll(2);
      idle = left < 0.97 * nearest ? 0 : idle + 1;
      nearest = std::min(nearest, left);
      if (idle < kPatience) continue;
      idle = 0;
      bound *= 2;
      unlock(surface, mesh, layout, placed, holding);
    }
    for (const Anchor& a : anchors)
      if (norm(layout.place[a.vertex] - a.target) > 0) placed[a.vertex] = 0;
    return placed;
  }

  // Crushed triangles keep one another from growing; coarsened away, they return where there is
  // room.
  void unlock(const ClosedSurface& surface, ProgressiveMesh& mesh, const Layout& layout,
              const std::vector<char>& held, CoarseToFine& relaxer) const {
    const std::size_t before = mesh.vertexCount();
    DecimateSettings decimation;
    decimation.vertices = before / 2;
    decimation.keep = held;
    decimation.layout = &layout;
    decimate(mesh, surface.vertices, decimation);
    relaxer.relaxAll(4);
    if (relaxer.refine(before) >= 0) fail();
  }

  // Each anchor towards its place as far as its triangles bear; the sum of what is left.
  static double advance(Layout& layout, const std::vector<Anchor>& anchors,
                        const PullbackEnergy& energy, double bound) {
    const std::unique_ptr<Star> star = energy.star();
    double left = 0;
    for (const Anchor& a : anchors) {
      Vec3& place = layout.place[a.vertex];
      if (!(norm(place - a.target) > 0)) continue;
      const Vec3 way = wayTo(layout, place, a.target);
      star->gather(a.vertex);
      const double most = std::max(bound, star->at(place));
      double share = 1;
      for (int halving = 0; halving < 8; ++halving, share *= 0.5) {
        const Vec3 to = halving == 0 ? a.target : moveAlong(ModelSpace::sphere, place, share * way);
        if (!(star->at(to) < most)) continue;
        place = to;
        break;
      }
      left += norm(wayTo(layout, place, a.target));
    }
    return left;
  }

  [[noreturn]] void fail() const {
    throw DataError(fmt::format(
        "no map without flips was found between {} and {} that sends handle to handle; landmarks "
        "beside the handles may help",
        pair_.a.surface.name, pair_.b.surface.name));
  }

  const CutPair& pair_;
  const GluedMapSettings& settings_;
  TargetMetric target_;
  std::vector<Anchor> landmarks_, anchors_;
  std::vector<std::pair<int, SurfacePoint>> exactLandmarks_;
  std::vector<char> placed_;  // #vertices: anchors that are present
  Layout start_;
  SeamedSurface seam_;
  double energy_ = 0;
};

}  // namespace

GluedMap gluedMap(const CutPair& pair, const GluedMapSettings& settings) {
  return GluedMapper(pair, settings).run();
}

}  // namespace innermap
