#include "surface/detail/sphere/sphere_starts.h"

#include <fmt/format.h>

#include <algorithm>

namespace innermap {
namespace {

constexpr std::size_t kMatchings = 300, kPromising = 8, kBestRotations = 3;
constexpr double kFar = 0.9;      // between tips that are still drawn together
constexpr double kMisfit = 0.75;  // of tips and landmarks after the best rotation

int nearest(const Vec3& p, const Points& to) {
  int best = 0;
  for (int i = 1; i < static_cast<int>(to.size()); ++i)
    if (squaredNorm(to[i] - p) < squaredNorm(to[best] - p)) best = i;
  return best;
}

// Whether two matchings differ in one pair at most.
bool alike(const TipPairs& p, const TipPairs& q) {
  std::size_t shared = 0;
  for (const auto& pair : p)
    if (std::find(q.begin(), q.end(), pair) != q.end()) ++shared;
  return shared + 1 >= std::min(p.size(), q.size());
}

}  // namespace

TipPairs nearestTips(const Points& places, const LimbTips& b) {
  TipPairs out;
  if (b.place.empty()) return out;
  for (int i = 0; i < static_cast<int>(places.size()); ++i) {
    const int j = nearest(places[i], b.place);
    if (nearest(b.place[j], places) == i && norm(places[i] - b.place[j]) < kFar)
      out.push_back({i, j});
  }
  return out;
}

std::vector<Anchor> anchorsOf(const TipPairs& pairs, const LimbTips& a, const LimbTips& b) {
  std::vector<Anchor> out;
  for (const auto& [i, j] : pairs) out.push_back({a.vertices[i], b.place[j]});
  return out;
}

std::vector<MapStart> sphereStarts(const std::vector<RotationCandidate>& rotations,
                                   const LimbTips& tipsA, const LimbTips& tipsB,
                                   const Points& landmarksA, const Points& landmarksB) {
  std::vector<MapStart> out;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const Mat3& rotation = rotations[i].rotation;
    out.push_back({rotation, {}, fmt::format("rotation {}", i + 1), i < kBestRotations});
    Points turned;
    for (const Vec3& p : tipsA.place) turned.push_back(rotation * p);
    const TipPairs pairs = nearestTips(turned, tipsB);
    if (pairs.size() >= 2)
      out.push_back({rotation, anchorsOf(pairs, tipsA, tipsB),
                     fmt::format("rotation {} with {} limbs drawn together", i + 1, pairs.size()),
                     false});
  }
  std::vector<TipPairs> promising;
  for (const TipPairs& pairs : matchTips(tipsA, tipsB, kMatchings)) {
    Points from = landmarksA, to = landmarksB;
    for (const auto& [i, j] : pairs) {
      from.push_back(tipsA.place[i]);
      to.push_back(tipsB.place[j]);
    }
    const Mat3 rotation = bestRotation(from, to);
    if (rotationMisfit(rotation, from, to) > kMisfit) continue;
    const bool fresh = promising.size() < kPromising &&
                       std::none_of(promising.begin(), promising.end(),
                                    [&](const TipPairs& known) { return alike(known, pairs); });
    if (fresh) promising.push_back(pairs);
    out.push_back({rotation, anchorsOf(pairs, tipsA, tipsB),
                   fmt::format("{} matched limbs", pairs.size()), fresh});
  }
  return out;
}

}  // namespace innermap
