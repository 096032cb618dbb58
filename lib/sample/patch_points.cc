#include "sample/patch_points.h"

#include <tbb/concurrent_unordered_map.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "core/pi.h"
#include "core/point_grid.h"
#include "core/random.h"
#include "core/require_number.h"
#include "innermap/core/run.h"
#include "levelset/offset_surface.h"
#include "sample/detail/surface_patch.h"

namespace innermap {
namespace {

constexpr double kClearance = 0.97;  // of the distance
// Share of candidates; the others go over edges, or in creases.
constexpr double kAlongNormal = 0.7;
// Candidates are thrown in parts, so many for each point that has room in an empty patch, until
// hardly any of so many parts is taken: of what there is, or of the candidates.
constexpr int kParts = 4, kMostParts = 400;
constexpr double kFewMore = 0.05, kFewTaken = 0.005;
// Candidates in a row that are not taken, before their place counts as full: where there never was
// room, as in creases; elsewhere. Nearly half of all candidates were thrown there, for a twentieth
// of the points (spot-bend onto cheburashka-spikes).
constexpr int kMissesAtFirst = 8, kMisses = 16;
constexpr std::size_t kLeastPart = 128;
constexpr double kLargestPart = 1e6;
// Of the reach: narrower parts of triangles are not told apart.
constexpr double kFinest = 1.0 / 32;

struct Candidate {
  SurfacePoint address;
  Vec3 position;
  bool good = false;
};

// Whether points at least `clearance` (world units) from a solid's surface are inside, asked once a
// cell: a cell is smaller than what is free about each of its points, so all are on the same side.
// Where there is no room left most candidates are inside, and their winding numbers took a third of
// such fits.
class SideCells {
 public:
  SideCells(const Solid& solid, double clearance)
      : solid_(solid), cell_((clearance - solid.gap()) * kAcross), origin_(solid.box().lower) {}

  bool inside(const Vec3& p) {
    if (!(cell_ > 0)) return solid_.inside(p);
    const Vec3 at = (p - origin_) / cell_;
    const Cell cell{std::floor(at.x), std::floor(at.y), std::floor(at.z)};
    const auto found = known_.find(cell);
    if (found != known_.end()) return found->second;
    return known_.emplace(cell, solid_.inside(p)).first->second;
  }

 private:
  using Cell = std::array<double, 3>;  // whole numbers
  struct Hash {
    std::size_t operator()(const Cell& c) const {
      std::size_t h = 0;
      for (const double x : c) h = 1000003 * h ^ std::hash<double>()(x);
      return h;
    }
  };
  static constexpr double kAcross = 0.577;  // edge of a cube over its diagonal, or less

  const Solid& solid_;
  const double cell_;
  const Vec3 origin_;
  tbb::concurrent_unordered_map<Cell, bool, Hash> known_;
};

void check(const PatchSettings& settings) {
  requireNumber("spacing", settings.spacing, above(0));
  requireNumber("reach", settings.reach, above(0));
}

SurfacePatch patchOf(const Solid& solid, const Points& marks, const PatchSettings& settings) {
  const double reach = settings.reach * solid.diagonal(),
               spacing = settings.spacing * solid.diagonal();
  return {solid.surface(), marks, reach, std::max(2 * spacing, kFinest * reach)};
}

// Candidate i, at a share of the patch's area; on any thread.
using Propose = std::function<Candidate(std::size_t i, double share, const PointGrid& taken)>;

// The places that darts are thrown at, equal shares of the area, until they are full.
class Places {
 public:
  explicit Places(std::size_t count)
      : open_(count), misses_(count), limits_(count, kMissesAtFirst) {
    std::iota(open_.begin(), open_.end(), std::size_t{0});
  }

  const std::vector<std::size_t>& open() const { return open_; }

  void taken(std::size_t place) {
    misses_[place] = 0;
    limits_[place] = kMisses;
  }

  void missed(std::size_t place) { ++misses_[place]; }

  void dropFull() {
    const auto full = [this](std::size_t place) { return misses_[place] >= limits_[place]; };
    open_.erase(std::remove_if(open_.begin(), open_.end(), full), open_.end());
  }

 private:
  std::vector<std::size_t> open_;
  std::vector<int> misses_, limits_;
};

// Throws darts, of which those stay that are good and have room.
std::vector<Candidate> throwDarts(double area, double spacing, const Points& existing,
                                  const Propose& propose, const PatchSettings& settings) {
  PointGrid taken(existing, 2 * spacing);
  std::vector<Candidate> kept;
  // By parts: what is near points that are taken already need not be looked at any closer. Each
  // goes once over the area, in order: what is near a candidate has just been read for others.
  const double share = area / (spacing * spacing) / kParts;
  const std::size_t part =
      std::max(kLeastPart, static_cast<std::size_t>(std::min(share, kLargestPart)));
  const CounterRandom random(settings.seed, 23);
  Places places(part);
  std::vector<Candidate> candidates(part);
  std::size_t before = 0, thrown = 0;
  for (std::size_t p = 0; p < kMostParts && area > 0 && kept.size() < settings.most; ++p) {
    const std::vector<std::size_t>& open = places.open();
    parallelBlocks(
        open.size(), 16,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) {
            const std::size_t i = p * part + open[k];
            candidates[k] = propose(
                i,
                (static_cast<double>(open[k]) + random.uniform(2 * i)) / static_cast<double>(part),
                taken);
          }
        },
        "placing points");
    for (std::size_t k = 0; k < open.size(); ++k) {
      const Candidate& c = candidates[k];
      if (!c.good || taken.anyNearer(c.position, spacing)) {
        places.missed(open[k]);
        continue;
      }
      places.taken(open[k]);
      taken.add(c.position);
      kept.push_back(c);
    }
    thrown += open.size();
    places.dropFull();
    if ((p + 1) % kParts > 0) continue;
    const double few = std::max(kFewMore * static_cast<double>(kept.size()),
                                kFewTaken * static_cast<double>(thrown));
    if (static_cast<double>(kept.size() - before) <= few) break;
    before = kept.size();
    thrown = 0;
  }
  // A random choice.
  for (std::size_t i = 0; i < settings.most && kept.size() > settings.most; ++i)
    std::swap(kept[i], kept[i + random.bits(2 * i + 1) % (kept.size() - i)]);
  kept.resize(std::min(kept.size(), settings.most));
  return kept;
}

bool isWithinTriangle(const SurfacePoint& p) {
  constexpr double kRounding = 1e-6;
  return *std::min_element(p.barycentric.begin(), p.barycentric.end()) > kRounding;
}

// Moves p to the distance over an edge, or in a crease; false where it comes to stand over one
// triangle (along its normal there are candidates enough), inside, or where it is not free. What is
// inside after the first move is left there, as it seldom comes out again: of the candidates in
// creases four of five ended inside (cheburashka-spikes onto homer-bend). Without those in creases
// the largest error of a horse in another pose was half as large again.
bool moveOverEdge(const Solid& solid, double away, const std::function<bool(const Vec3&)>& free,
                  Vec3& p) {
  constexpr double kEnough = 1 - kClearance;
  int moves = 0;
  bool overTriangle = false;
  const auto worthwhile = [&](const Vec3& moved, const Solid::Closest& closest) {
    overTriangle = ++moves == 1 && isWithinTriangle(closest.onSurface);
    return free(moved) && (moves > 1 || !solid.inside(moved));
  };
  return moveToDistance(solid, away, p, kEnough, worthwhile) <= kEnough * away && !overTriangle;
}

Vec3 randomDirection(double u, double v) {
  const double z = 2 * u - 1, r = std::sqrt(1 - z * z), angle = 2 * kPi * v;
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace

Points patchSources(const Solid& solid, const Points& marks, double distance,
                    const Points& existing, const PatchSettings& settings) {
  check(settings);
  requireNumber("distance", distance, {1e-6, 2}, "fraction of the diagonal");
  const Mesh& surface = solid.surface();
  const double away = distance * solid.diagonal(), spacing = settings.spacing * solid.diagonal();
  const SurfacePatch patch = patchOf(solid, marks, settings);
  const CounterRandom random(settings.seed, 21);
  SideCells sides(solid, kClearance * away);
  const auto propose = [&](std::size_t i, double share, const PointGrid& taken) {
    const auto uniform = [&](std::size_t k) { return random.uniform(5 * i + k); };
    const auto free = [&](const Vec3& p) { return !taken.anyNearer(p, spacing); };
    Candidate c{patch.sample(share, uniform(0), uniform(1)), {}, false};
    const Vec3 foot = positionOf(surface, c.address);
    if (!patch.holds(foot)) return c;
    const Vec3 area = areaVector(surface, c.address.triangle), normal = area / norm(area);
    if (uniform(2) < kAlongNormal) {
      c.position = foot + away * normal;
      c.good = free(c.position) && !isNearer(solid, c.position, kClearance * away);
    } else {
      const Vec3 direction = randomDirection(uniform(3), uniform(4));
      c.position = foot + (dot(direction, normal) < 0 ? -away : away) * direction;
      c.good = moveOverEdge(solid, away, free, c.position);
    }
    c.good = c.good && !sides.inside(c.position);
    return c;
  };
  Points out;
  for (const Candidate& c : throwDarts(patch.area(), spacing, existing, propose, settings))
    out.push_back(c.position);
  return out;
}

std::vector<SurfacePoint> patchSamples(const Solid& solid, const Points& marks,
                                       const Points& existing, const PatchSettings& settings) {
  check(settings);
  const double spacing = settings.spacing * solid.diagonal();
  const SurfacePatch patch = patchOf(solid, marks, settings);
  const CounterRandom random(settings.seed, 22);
  const auto propose = [&](std::size_t i, double share, const PointGrid& taken) {
    const auto uniform = [&](std::size_t k) { return random.uniform(2 * i + k); };
    Candidate c{patch.sample(share, uniform(0), uniform(1)), {}, false};
    c.position = positionOf(solid.surface(), c.address);
    c.good = !taken.anyNearer(c.position, spacing) && patch.holds(c.position);
    return c;
  };
  std::vector<SurfacePoint> out;
  for (const Candidate& c : throwDarts(patch.area(), spacing, existing, propose, settings))
    out.push_back(c.address);
  return out;
}

}  // namespace innermap
