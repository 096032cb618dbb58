#include "sample/patch_points.h"

#include <tbb/concurrent_unordered_map.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/pi.h"
#include "core/point_grid.h"
#include "core/random.h"
#include "core/require_number.h"
#include "innermap/core/run.h"
#include "levelset/offset_surface.h"

namespace innermap {
namespace {

constexpr double kClearance = 0.97;   // of the distance
constexpr double kAlongNormal = 0.6;  // share of candidates; the others reach over convex edges
constexpr double kFewTaken = 0.02;    // of a round's candidates: it is full
constexpr int kMostRounds = 24;
constexpr double kCandidates = 4;                     // a round, for each point that has room
constexpr std::size_t kParts = 16, kLeastPart = 128;  // of a round

struct Candidate {
  SurfacePoint address;
  Vec3 position;
  bool good = false;
};

// The triangles that come within reach of a mark, for random samples by area.
class Patch {
 public:
  Patch(const Solid& solid, const Points& marks, double reach)
      : surface_(solid.surface()), marks_(marks, 2 * reach), reach_(reach), all_(marks.empty()) {
    std::vector<char> near(surface_.triangles.size(), 1);
    if (!all_) findNear(near);
    double sum = 0;
    for (std::size_t t = 0; t < near.size(); ++t) {
      const double area = near[t] ? norm(areaVector(surface_, static_cast<int>(t))) : 0;
      if (!(area > 0)) continue;
      triangles_.push_back(static_cast<int>(t));
      cumulative_.push_back(sum += area);
    }
  }

  double area() const { return cumulative_.empty() ? 0 : cumulative_.back(); }

  SurfacePoint sample(double u, double v, double w) const {
    const auto at = std::upper_bound(cumulative_.begin(), cumulative_.end(), u * area());
    const std::size_t i =
        std::min(static_cast<std::size_t>(at - cumulative_.begin()), triangles_.size() - 1);
    const double r = std::sqrt(v);
    return {triangles_[i], {1 - r, r * (1 - w), r * w}};
  }

  bool holds(const Vec3& p) const { return all_ || marks_.anyNearer(p, reach_); }

 private:
  void findNear(std::vector<char>& near) const {
    parallelBlocks(near.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        Box3 box;
        for (const int v : surface_.triangles[t]) box.add(surface_.vertices[v]);
        near[t] = marks_.anyNearer(box.center(), reach_ + 0.5 * box.diagonal());
      }
    });
  }

  const Mesh& surface_;
  PointGrid marks_;
  double reach_;
  bool all_;
  std::vector<int> triangles_;
  std::vector<double> cumulative_;
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

// Throws darts: `propose(i)` gives candidate i (on any thread), of which those stay that are good
// and have room.
std::vector<Candidate> throwDarts(
    double area, double spacing, const Points& existing,
    const std::function<Candidate(std::size_t, const PointGrid&)>& propose,
    const PatchSettings& settings) {
  PointGrid taken(existing, 2 * spacing);
  std::vector<Candidate> kept;
  const double room = area / (spacing * spacing);
  const std::size_t round = static_cast<std::size_t>(std::clamp(kCandidates * room, 64.0, 4e6));
  // By parts: what is near points that are taken already need not be looked at any closer.
  const std::size_t part = std::max(kLeastPart, round / kParts);
  std::vector<Candidate> candidates;
  std::size_t drawn = 0;
  const auto wanted = [&] { return kept.size() < settings.most; };
  for (int r = 0; r < kMostRounds && area > 0 && wanted(); ++r, drawn += round) {
    std::size_t fresh = 0;
    for (std::size_t first = 0; first < round && wanted(); first += part) {
      candidates.resize(std::min(part, round - first));
      parallelBlocks(
          candidates.size(), 16,
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
              candidates[i] = propose(drawn + first + i, taken);
          },
          "placing points");
      for (const Candidate& c : candidates) {
        if (!c.good || taken.anyNearer(c.position, spacing)) continue;
        taken.add(c.position);
        kept.push_back(c);
        ++fresh;
      }
    }
    if (static_cast<double>(fresh) < kFewTaken * static_cast<double>(round)) break;
  }
  // In the order of the draw: the first ones are a random choice.
  if (kept.size() > settings.most) kept.resize(settings.most);
  return kept;
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
  const double diagonal = solid.diagonal(), away = distance * diagonal,
               spacing = settings.spacing * diagonal;
  const Patch patch(solid, marks, settings.reach * diagonal);
  const CounterRandom random(settings.seed, 21);
  SideCells sides(solid, kClearance * away);
  const auto propose = [&](std::size_t i, const PointGrid& taken) {
    const auto uniform = [&](std::size_t k) { return random.uniform(6 * i + k); };
    Candidate c{patch.sample(uniform(0), uniform(1), uniform(2)), {}, false};
    const Vec3 foot = positionOf(surface, c.address);
    if (!patch.holds(foot)) return c;
    const Vec3 area = areaVector(surface, c.address.triangle), normal = area / norm(area);
    const bool along = uniform(3) < kAlongNormal;
    Vec3 direction = normal;
    if (!along) {
      direction = randomDirection(uniform(4), uniform(5));
      if (dot(direction, normal) < 0) direction = -direction;
    }
    c.position = foot + away * direction;
    if (!along && !(moveToDistance(solid, away, c.position) <= (1 - kClearance) * away)) return c;
    // What was moved to the distance has been looked at there.
    c.good = !taken.anyNearer(c.position, spacing) &&
             (!along || solid.closest(c.position, kClearance * away).onSurface.triangle < 0) &&
             !sides.inside(c.position);
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
  const double diagonal = solid.diagonal(), spacing = settings.spacing * diagonal;
  const Patch patch(solid, marks, settings.reach * diagonal);
  const CounterRandom random(settings.seed, 22);
  const auto propose = [&](std::size_t i, const PointGrid& taken) {
    const auto uniform = [&](std::size_t k) { return random.uniform(3 * i + k); };
    Candidate c{patch.sample(uniform(0), uniform(1), uniform(2)), {}, false};
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
