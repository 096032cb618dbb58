#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/require_number.h"
#include "evaluate/active_region.h"
#include "evaluate/extended_places.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/levelset/level_set.h"
#include "innermap/transfer/inverse_map.h"
#include "transfer/detail/extended_map.h"
#include "transfer/detail/leaf_index.h"
#include "transfer/detail/newton.h"
#include "transfer/detail/source_lattice.h"
#include "transfer/detail/step_by_step.h"

namespace innermap {
namespace {

constexpr std::size_t kTogether = std::size_t{1} << 18;  // points of one pass, for memory
constexpr double kOutside = 1e-6;                        // of the source's diagonal
constexpr double kInverted = 1e-5;                       // of the target's diagonal
constexpr double kSkinVoxels = 3;                        // of the target, where points are pulled
// Of the inverse on the grid, which gives starts, no more: in its voxels; of the target's extent.
constexpr double kStartTolerance = 0.01, kStartAccuracy = 1e-5;

void requireFinite(const Points& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!isFinite(points[i]))
      throw DataError(fmt::format("points: number {} is not finite (counted from 0)", i));
}

// Passes over parts of the points, so that what they need on the way does not grow.
template <class Part>
CarriedPoints inParts(const Points& points, bool jacobians, const Part& part) {
  requireFinite(points);
  CarriedPoints out;
  out.points.resize(points.size());
  out.fates.resize(points.size());
  if (jacobians) out.jacobians.resize(points.size());
  for (std::size_t begin = 0; begin < points.size(); begin += kTogether) {
    reportProgress("carrying points",
                   static_cast<double>(begin) / static_cast<double>(points.size()));
    part(begin, std::min(points.size(), begin + kTogether), out);
  }
  return out;
}

// How far outside a point is, world units, decides what becomes of it.
struct Limits {
  double diagonal, reach;
  bool endless;

  Limits(const Solid& source, const CarryPointsSettings& s)
      : diagonal(source.diagonal()),
        reach(std::max(s.skin, s.outside.distance) * diagonal),
        endless(s.outside.fadeTo.has_value()) {}

  bool cuts(double outside) const { return outside > reach && !endless; }

  void judge(double outside, std::size_t i, CarriedPoints& out) const {
    if (outside > kOutside * diagonal) ++out.outside;
    if (out.fates[i] == PointFate::carried && cuts(outside)) out.fates[i] = PointFate::cut;
    if (out.fates[i] == PointFate::cut)
      ++out.cut;
    else if (outside > kOutside * diagonal)
      out.farthest = std::max(out.farthest, outside / diagonal);
    if (out.fates[i] == PointFate::failed) ++out.failed;
  }
};

openvdb::FloatGrid::Ptr coarseLevelSet(const Solid& solid, int resolution = kUsualResolution) {
  LevelSetSettings levelSet;
  levelSet.resolution = resolution;
  return makeLevelSet(solid, levelSet);
}

// Voxels across the source and the target. Much space around them is worth less: Newton's method
// finds from farther there, as the map is smooth.
int resolutionOf(const CarryPointsSettings& settings) {
  return settings.outside.distance > 0 ? 48 : kUsualResolution;
}

// Through the source and what is around it.
SourceLattice latticeOf(const Solid& source, const CarryPointsSettings& settings) {
  SourceLattice out;
  out.levelSet = coarseLevelSet(source, resolutionOf(settings));
  RegionSettings region;
  out.region = activeRegion(*out.levelSet, region);
  constexpr std::uint64_t kVoxelBytes = 64;
  if (settings.outside.distance > 0)
    addAround(*out.region, source, settings.outside.distance * source.diagonal(), kVoxelBytes);
  return out;
}

void keep(const PointImage& sample, std::size_t i, CarriedPoints& out) {
  out.points[i] = sample.image;
  if (!out.jacobians.empty()) out.jacobians[i] = sample.jacobian;
}

Points slice(const Points& points, std::size_t begin, std::size_t end) {
  return Points(points.begin() + static_cast<std::ptrdiff_t>(begin),
                points.begin() + static_cast<std::ptrdiff_t>(end));
}

PointCarry carryPointwise(const SolidMap& map, bool push, const CarryPointsSettings& settings) {
  const double diagonal = push ? map.pointwise()->sourceDiagonal : map.pointwise()->targetDiagonal;
  const double most = std::max(settings.skin, settings.outside.distance) * diagonal;
  return [=](const Points& points, bool jacobians) {
    CarriedPoints out;
    for (const PointImage& s : push ? map.push(points) : map.pull(points)) {
      const bool cut = s.outside > most;
      out.points.push_back(s.image);
      out.fates.push_back(cut ? PointFate::cut : PointFate::carried);
      if (jacobians) out.jacobians.push_back(s.jacobian);
      out.outside += s.outside > kOutside * diagonal;
      out.cut += cut;
      if (!cut) out.farthest = std::max(out.farthest, s.outside / diagonal);
    }
    return out;
  };
}

// Points that are rows of `out` from `begin` on. Inside, the derivative is not needed for the
// place.
void pushPart(const ExtendedMap& extended, const Limits& limits, const Points& part,
              const ExtendedPlaces& places, std::size_t begin, CarriedPoints& out) {
  Points inside, outside;
  ExtendedPlaces away;
  std::vector<std::size_t> insideAt, outsideAt;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (out.jacobians.empty() && !(squaredNorm(places.beyond[i]) > 0)) {
      inside.push_back(part[i]);
      insideAt.push_back(begin + i);
    } else {
      outside.push_back(part[i]);
      away.at.push_back(places.at[i]);
      away.beyond.push_back(places.beyond[i]);
      outsideAt.push_back(begin + i);
    }
  }
  const Points images = extended.imagesInside(inside);
  for (std::size_t n = 0; n < images.size(); ++n) out.points[insideAt[n]] = images[n];
  const std::vector<PointImage> samples = extended.at(outside, away);
  for (std::size_t n = 0; n < samples.size(); ++n) keep(samples[n], outsideAt[n], out);
  for (std::size_t i = 0; i < part.size(); ++i)
    limits.judge(norm(places.beyond[i]), begin + i, out);
}

}  // namespace

void requireInRange(const CarryPointsSettings& s) {
  requireNumber("outside", s.outside.distance, {0, 1}, "of the diagonal");
  requireNumber("skin", s.skin, {0, 0.1}, "of the diagonal");
  requireNumber("accuracy", s.accuracy, {1e-12, 1e-3}, "of the target's extent");
}

struct PointPusher::Data {
  Solid source;
  CarryPointsSettings settings;
  openvdb::FloatGrid::Ptr levelSet;

  ExtendedMap extended(const ComposedMap& map) const {
    return {map, source, *levelSet, settings.outside,
            settings.accuracy * targetExtent(map, source)};
  }
};

PointPusher::PointPusher(const Solid& source, const CarryPointsSettings& settings) {
  requireInRange(settings);
  data_ = std::make_shared<Data>(Data{source, settings, coarseLevelSet(source)});
}

PointPusher PointPusher::fadingTo(const RigidMotion& motion) const {
  PointPusher out(*this);
  Data data = *data_;
  data.settings.outside.fadeTo = motion;
  out.data_ = std::make_shared<Data>(std::move(data));
  return out;
}

PlacedPoints PointPusher::place(const Points& points) const {
  requireFinite(points);
  const Limits limits(data_->source, data_->settings);
  ExtendedPlaces places = placeExtended(data_->source, *data_->levelSet, points);
  PlacedPoints out{points, std::move(places.at), std::move(places.beyond), {}};
  for (const Vec3& beyond : out.beyond)
    out.fates.push_back(limits.cuts(norm(beyond)) ? PointFate::cut : PointFate::carried);
  return out;
}

CarriedPoints PointPusher::push(const ComposedMap& map, const Points& points,
                                bool jacobians) const {
  const Limits limits(data_->source, data_->settings);
  const ExtendedMap extended = data_->extended(map);
  return inParts(points, jacobians, [&](std::size_t begin, std::size_t end, CarriedPoints& out) {
    const Points part = slice(points, begin, end);
    pushPart(extended, limits, part, placeExtended(data_->source, *data_->levelSet, part), begin,
             out);
  });
}

CarriedPoints PointPusher::push(const ComposedMap& map, const PlacedPoints& placed,
                                bool jacobians) const {
  const Limits limits(data_->source, data_->settings);
  const ExtendedMap extended = data_->extended(map);
  return inParts(
      placed.points, jacobians, [&](std::size_t begin, std::size_t end, CarriedPoints& out) {
        pushPart(extended, limits, slice(placed.points, begin, end),
                 {slice(placed.at, begin, end), slice(placed.beyond, begin, end)}, begin, out);
      });
}

struct PointPuller::Data {
  ComposedMap map;
  Solid source;
  CarryPointsSettings settings;
  SourceLattice lattice;
  double diagonal = 0;  // of the target
  InvertedMap inverted;
  LeafIndex leaves;

  Data(const ComposedMap& theMap, const Solid& theSource, const Solid& target,
       const CarryPointsSettings& theSettings)
      : map(theMap),
        source(theSource),
        settings(theSettings),
        lattice(latticeOf(source, settings)),
        diagonal(target.diagonal()),
        inverted(invert(target)),
        leaves(inverted.region->tree()) {}

  InvertedMap invert(const Solid& target) {
    InverseSettings inverse;
    inverse.outside = settings.outside;
    inverse.skin = kSkinVoxels;
    inverse.tolerance = kStartTolerance;
    inverse.accuracy = std::max(settings.accuracy, kStartAccuracy);
    return invertMap(map, source, lattice, *coarseLevelSet(target, resolutionOf(settings)),
                     inverse);
  }

  // Where the search for a point begins; false when nothing comes there.
  bool startOf(const Vec3& q, Vec3& start) const {
    const openvdb::Coord ijk =
        inverted.region->transform().worldToIndexNodeCentered(openvdb::Vec3d(q.x, q.y, q.z));
    const std::uint32_t leaf = leaves.find(ijk);
    if (leaf != LeafIndex::kNone && leaves[leaf].isValueOn(ijk)) {
      const auto& mask = leaves[leaf].getValueMask();
      const openvdb::Index at = LeafIndex::Leaf::coordToOffset(ijk);
      std::size_t before = 0;
      for (openvdb::Index word = 0; word < at / 64; ++word)
        before += openvdb::util::CountOn(mask.getWord<openvdb::Index64>(word));
      const openvdb::Index64 below = (openvdb::Index64(1) << (at % 64)) - 1;
      before += openvdb::util::CountOn(mask.getWord<openvdb::Index64>(at / 64) & below);
      start = inverted.sources[inverted.first[leaf] + before];
      return true;
    }
    if (!settings.outside.fadeTo) return false;
    const RigidMotion& rigid = *settings.outside.fadeTo;
    start = transposed(rigid.rotation) * (q - rigid.translation);
    return true;
  }
};

PointPuller::PointPuller(const ComposedMap& map, const Solid& source, const Solid& target,
                         const CarryPointsSettings& settings) {
  requireInRange(settings);
  data_ = std::make_shared<Data>(map, source, target, settings);
}

CarriedPoints PointPuller::pull(const Points& points, bool jacobians) const {
  const Data& d = *data_;
  const CarryPointsSettings& s = d.settings;
  const Limits limits(d.source, s);
  const double accuracy = s.accuracy * targetExtent(d.map, d.source);
  const ExtendedMap extended(d.map, d.source, *d.lattice.levelSet, s.outside, accuracy);
  NewtonSettings newton;
  newton.tolerance = std::max(4 * accuracy, 1e-9 * d.diagonal);
  newton.longestStep = 4 * d.lattice.levelSet->voxelSize()[0];
  return inParts(points, jacobians, [&](std::size_t begin, std::size_t end, CarriedPoints& out) {
    Points targets, sources;
    std::vector<std::size_t> at;
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 start;
      if (d.startOf(points[i], start)) {
        targets.push_back(points[i]);
        sources.push_back(start);
        at.push_back(i);
      } else {
        out.points[i] = points[i];
        out.fates[i] = PointFate::cut;
        ++out.cut;
        ++out.outside;
      }
    }
    const Points starts = sources;
    NewtonResult found = solveNewton(extended, targets, sources, newton);
    if (d.map.steps().size() > 1) {
      Points again, from;
      std::vector<std::size_t> which;
      for (std::size_t n = 0; n < at.size(); ++n)
        if (!(found.residuals[n] <= kInverted * d.diagonal)) {
          again.push_back(targets[n]);
          from.push_back(starts[n]);
          which.push_back(n);
        }
      if (!which.empty() && which.size() <= kMostStepByStep) {
        from = invertStepByStep(d.map, again, from, {newton.tolerance});
        const NewtonResult second = solveNewton(extended, again, from, newton);
        for (std::size_t k = 0; k < which.size(); ++k) {
          sources[which[k]] = from[k];
          found.at[which[k]] = second.at[k];
          found.residuals[which[k]] = second.residuals[k];
        }
      }
    }
    for (std::size_t n = 0; n < at.size(); ++n) {
      const std::size_t i = at[n];
      out.points[i] = sources[n];
      if (jacobians) out.jacobians[i] = inverse(found.at[n].jacobian);
      if (!(found.residuals[n] <= kInverted * d.diagonal)) out.fates[i] = PointFate::failed;
      limits.judge(found.at[n].outside, i, out);
    }
  });
}

FramePointPusher::FramePointPusher(const Solid& rest, CarryPointsSettings settings, bool fitted)
    : pusher_(rest, [&] {
        if (fitted) settings.outside.fadeTo = RigidMotion();  // until the frame is known
        return settings;
      }()) {
  if (fitted) from_ = rest.repaired().mesh.vertices;
}

PointPusher FramePointPusher::to(const Points& moved) const {
  return from_.empty() ? pusher_ : pusher_.fadingTo(bestRigidMotion(from_, moved));
}

PointCarry carryByMap(const SolidMap& map, const MappedSolid& mapped, bool push,
                      const CarryPointsSettings& settings) {
  if (map.pointwise()) return carryPointwise(map, push, settings);
  if (push)
    return
        [pusher = PointPusher(mapped.solid(), settings), map = *map.harmonic()](
            const Points& points, bool jacobians) { return pusher.push(map, points, jacobians); };
  return [puller = PointPuller(*map.harmonic(), mapped.solid(), makeTargetSolid(mapped.boundary),
                               settings)](const Points& points, bool jacobians) {
    return puller.pull(points, jacobians);
  };
}

std::uint64_t carryPointsMemory(std::uint64_t points, bool jacobians) {
  const std::uint64_t each = sizeof(Vec3) + 1 + (jacobians ? sizeof(Mat3) : 0);
  // One pass: samples, places, sums in matrices.
  return points * each + std::min<std::uint64_t>(points, kTogether) * 600;
}

Vec3 carriedVector(const Mat3& jacobian, const Vec3& v) { return jacobian * v; }

Vec3 carriedNormal(const Mat3& jacobian, const Vec3& n) {
  const Vec3 a{jacobian[0][0], jacobian[0][1], jacobian[0][2]},
      b{jacobian[1][0], jacobian[1][1], jacobian[1][2]},
      c{jacobian[2][0], jacobian[2][1], jacobian[2][2]};
  // The cofactors are det A times the inverse transpose, without a division. With det A below 0
  // the surface is turned inside out, and its normal with it.
  const Vec3 turned{dot(cross(b, c), n), dot(cross(c, a), n), dot(cross(a, b), n)};
  const double length = norm(turned), before = norm(n);
  if (!(length > 0) || !std::isfinite(length)) return n;
  return (determinant(jacobian) < 0 ? -before : before) / length * turned;
}

}  // namespace innermap
