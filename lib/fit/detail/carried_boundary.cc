#include "fit/detail/carried_boundary.h"

#include <algorithm>

#include "core/point_grid.h"
#include "fit/detail/bent_mesh.h"
#include "fit/detail/problem_samples.h"
#include "fit/detail/streams.h"
#include "innermap/core/run.h"
#include "innermap/fit/boundary_pair.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

// Where an intermediate shape crosses itself its exposed surface need not be known finely.
constexpr double kPieces = 1.0 / 256;
// A mesh about an intermediate shape has at most so many triangles more than the source, or so
// many times as many.
constexpr std::size_t kMoreTriangles = 100000, kTimesTriangles = 4;
// Of a charge's distance: that the mesh may be off at its foot; that no exact image is nearer.
constexpr double kExact = 0.4, kTouching = 0.4;

// At places on solid.surface(), from values at the vertices that the solid was made of.
Points interpolated(const Points& vertices, const Solid& solid,
                    const std::vector<SurfacePoint>& places) {
  TargetBoundary values;
  values.moved = vertices.size() == solid.repaired().mesh.vertices.size()
                     ? vertices
                     : repairedPositions(solid.repaired(), vertices);
  return pointsOf(values.targetsOf(solid, places));
}

BoundarySamples samplesFrom(const Points& now, const Points& ways) {
  Matrix to(now.size(), 3);
  for (std::size_t i = 0; i < now.size(); ++i)
    for (int k = 0; k < 3; ++k) to(i, static_cast<std::size_t>(k)) = now[i][k] + ways[i][k];
  return {now, std::move(to)};
}

Points mended(Points ways, const Points& now, const Points& from, const Mending& mending) {
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const Vec3 off = from[i] - now[i];
    const double size = norm(off);
    const double part = std::min({size - mending.kept, mending.most, mending.far - size});
    if (part > 0) ways[i] = ways[i] + (part / size) * off;
  }
  return ways;
}

// Three columns for each.
Matrix beside(const std::vector<Points>& parts) {
  Matrix out(parts.front().size(), 3 * parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (std::size_t i = 0; i < out.rows(); ++i)
      for (int k = 0; k < 3; ++k) out(i, 3 * p + static_cast<std::size_t>(k)) = parts[p][i][k];
  return out;
}

}  // namespace

CarriedBoundary::CarriedBoundary(const Solid& source, const CarriedSettings& settings)
    : source_(source),
      settings_(settings),
      surface_(source.repaired().mesh),
      vertices_(source.repaired().mesh.vertices),
      solid_(source) {}

Points CarriedBoundary::carried(Points points, std::size_t firstStep) const {
  EvaluateFieldSettings sums;
  sums.accuracy = settings_.accuracy;
  for (std::size_t s = firstStep; s < steps_.size(); ++s)
    points = pointsOf(steps_[s].field().evaluate(points, sums).values);
  return points;
}

Points CarriedBoundary::onSource(const Points& vertices,
                                 const std::vector<SurfacePoint>& places) const {
  return interpolate(vertices, source_.repaired().mesh.triangles, places);
}

std::vector<SurfacePoint> CarriedBoundary::placesOf(std::size_t count, std::uint64_t draw) const {
  SampleSettings sample;
  sample.seed = seedOf(settings_.seed, Stream::fresh, draw);
  std::vector<SurfacePoint> places = randomSamples(source_.surface(), count, sample);
  for (SurfacePoint& p : places) p = source_.address(p);
  return places;
}

const CarriedBoundary::Draw& CarriedBoundary::drawn(std::size_t count, std::uint64_t draw) {
  Draw& d = draws_[{count, draw}];
  if (d.places.empty()) {
    d.places = placesOf(count, draw);
    d.now = onSource(source_.repaired().mesh.vertices, d.places);
  }
  d.now = carried(d.now, d.steps);
  d.steps = steps_.size();
  return d;
}

void CarriedBoundary::carrySurface() {
  Points points = vertices_;
  for (const auto& edge : edges_)
    points.insert(points.end(), edge.second.begin(), edge.second.end());
  points = carried(std::move(points), steps_.size() - 1);
  auto next = points.begin() + static_cast<std::ptrdiff_t>(vertices_.size());
  vertices_.assign(points.begin(), next);
  for (auto& edge : edges_)
    for (Vec3& on : edge.second) on = *next++;
}

void CarriedBoundary::advance(const HarmonicMap& step, bool last) {
  steps_.push_back(step);
  if (last) return;
  carrySurface();
  const Mesh& mesh = source_.repaired().mesh;
  refine(
      surface_, vertices_, edges_,
      [&](const std::vector<SurfacePoint>& places) {
        return carried(onSource(mesh.vertices, places), 0);
      },
      settings_.chord,
      std::max(kTimesTriangles * mesh.triangles.size(), mesh.triangles.size() + kMoreTriangles));
  Mesh now;
  now.name = "an intermediate shape";
  now.vertices = vertices_;
  now.triangles = surface_.triangles;
  SolidSettings solid;
  solid.pieceSize = kPieces;
  solid_ = Solid(now, solid);
}

double CarriedBoundary::pieces() const {
  return static_cast<double>(solid_.surface().triangles.size()) /
         static_cast<double>(mesh().triangles.size());
}

Points CarriedBoundary::imagesOf(const std::vector<SurfacePoint>& places, bool exact) const {
  if (steps_.empty()) return positionsOf(solid_, places);
  const auto throughSteps = [&](const std::vector<SurfacePoint>& some) {
    return carried(interpolated(surface_.positions, solid_, some), 0);
  };
  if (exact) return throughSteps(places);
  const BentMesh mesh(solid_, edges_);
  Points out(places.size());
  std::vector<char> known(places.size());
  parallelBlocks(places.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const BentMesh::Place p = mesh.at(places[i]);
      out[i] = p.position;
      known[i] = p.bent <= settings_.chord;
    }
  });
  std::vector<SurfacePoint> others;
  for (std::size_t i = 0; i < known.size(); ++i)
    if (!known[i]) others.push_back(places[i]);
  const Points on = throughSteps(others);
  auto next = on.begin();
  for (std::size_t i = 0; i < known.size(); ++i)
    if (!known[i]) out[i] = *next++;
  return out;
}

// Those that stand where the mesh about the present solid is as good as exact at their distance
// from it: elsewhere a charge could touch the images, or stand inside of them. The exact images
// that errors were measured at tell of bumps between the edges that the mesh knows: one that a step
// had left came to within 0.28 of the distance of a charge of the next, and points of it ended
// three diagonals off (cheburashka-bend onto spot-spikes).
Points CarriedBoundary::known(const Points& charges, double distance) const {
  std::vector<char> good(charges.size());
  std::vector<SurfacePoint> feet(charges.size());
  parallelBlocks(charges.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      feet[i] = solid_.closest(charges[i], solid_.diagonal()).onSurface;
  });
  const Points on = positionsOf(solid_, feet), images = imagesOf(feet, false);
  for (std::size_t i = 0; i < charges.size(); ++i)
    good[i] = norm(images[i] - on[i]) <= kExact * distance;
  for (const std::size_t i : nearImages(charges, kTouching * distance)) good[i] = false;
  Points out;
  for (std::size_t i = 0; i < charges.size(); ++i)
    if (good[i]) out.push_back(charges[i]);
  return out;
}

// Indices of the charges that an exact image of this step's draws is nearer to.
std::vector<std::size_t> CarriedBoundary::nearImages(const Points& charges, double than) const {
  const PointGrid grid(charges, 4 * than);
  std::vector<std::size_t> out;
  for (const auto& [key, draw] : draws_) {
    if (draw.steps != steps_.size()) continue;
    const Points& images = draw.now;
    std::vector<char> near(images.size());
    parallelBlocks(images.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) near[i] = grid.anyNearer(images[i], than);
    });
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (!near[i]) continue;
      Box3 place;
      place.add(images[i]);
      for (const std::size_t c : grid.within(place, than))
        if (norm(charges[c] - images[i]) < than) out.push_back(c);
    }
  }
  return out;
}

AdaptiveProblem CarriedBoundary::problem(const Points& ways, double unit,
                                         const std::optional<Mending>& mending, bool exact) {
  AdaptiveProblemSettings s;
  s.seed = settings_.seed;
  std::vector<Points> columns{onSource(ways, surface_.vertices)};
  if (mending) columns.push_back(onSource(mending->from, surface_.vertices));
  // Columns: where it is, its way, and where it should be.
  const auto values = [this, columns, exact](const std::vector<SurfacePoint>& places) {
    std::vector<Points> parts{imagesOf(places, exact)};
    for (const Points& column : columns) parts.push_back(interpolated(column, solid_, places));
    return beside(parts);
  };
  AdaptiveProblem out = adaptiveProblem(solid_, values, unit, s);
  const auto carry = [mending](const BoundarySamples& samples) {
    const Points now = pointsOf(samples.values);
    Points way = pointsOf(samples.values, 3);
    if (mending) way = mended(std::move(way), now, pointsOf(samples.values, 6), *mending);
    return samplesFrom(now, way);
  };
  if (!steps_.empty())
    out.placeSources = [this, diagonal = out.diagonal, place = out.placeSources](
                           const PlacementRequest& request, double distance) {
      return known(place(request, distance), distance * diagonal);
    };
  out.placeCollocation = [carry, place = out.placeCollocation](const PlacementRequest& request) {
    return carry(place(request));
  };
  // Uniform by the source's area, as the certificate is.
  out.draw = [this, ways, mending](std::size_t count, std::uint64_t index) {
    const Draw& d = drawn(count, index);
    Points way = onSource(ways, d.places);
    if (mending) way = mended(std::move(way), d.now, onSource(mending->from, d.places), *mending);
    return samplesFrom(d.now, way);
  };
  return out;
}

BoundaryError CarriedBoundary::errorFrom(const Points& shape, double unit) {
  const Draw& fresh = drawn(kFreshSamples, 0);
  const Points wanted = interpolate(shape, source_.repaired().mesh.triangles, fresh.places);
  std::vector<double> lengths;
  for (std::size_t i = 0; i < wanted.size(); ++i)
    lengths.push_back(norm(fresh.now[i] - wanted[i]) / unit);
  return summarizeErrors(std::move(lengths));
}

}  // namespace innermap
