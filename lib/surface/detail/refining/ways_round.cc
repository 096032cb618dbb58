#include "surface/detail/refining/ways_round.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/pi.h"
#include "innermap/core/error.h"
#include "surface/detail/sphere/rotation_search.h"

namespace innermap {
namespace {

constexpr double kSamePlaces = 0.1;  // mean distance, of the images' diagonal
// Of the lesser score; and what scores of coarse maps of a body onto itself differ by.
constexpr double kAsGood = 0.1, kNoise = 5e-3;
constexpr double kLessTurned = 45, kMirrored = 120;  // degrees

Points centred(const Points& points) {
  Vec3 middle;
  for (const Vec3& p : points) middle += p / static_cast<double>(points.size());
  Points out;
  for (const Vec3& p : points) out.push_back(p - middle);
  return out;
}

}  // namespace

JudgedMap judgedMap(const MapJudge& judge, const Points& points, Points images) {
  JudgedMap out;
  out.score = judge.score(images);
  out.turn = bestRotation(centred(points), centred(images));
  out.images = std::move(images);
  return out;
}

double degreesOf(const Mat3& rotation) {
  const double trace = rotation[0][0] + rotation[1][1] + rotation[2][2];
  return 180 / kPi * std::acos(std::clamp(0.5 * (trace - 1), -1.0, 1.0));
}

// Whether the one has left where the other has right: they are about half a turn apart.
static bool mirrored(const JudgedMap& a, const JudgedMap& b) {
  return degreesOf(product(transposed(a.turn), b.turn)) > kMirrored;
}

bool sameWay(const JudgedMap& a, const JudgedMap& b) {
  Box3 box;
  double sum = 0;
  for (std::size_t i = 0; i < a.images.size(); ++i) {
    box.add(a.images[i]);
    box.add(b.images[i]);
    sum += norm(a.images[i] - b.images[i]);
  }
  return sum < kSamePlaces * box.diagonal() * static_cast<double>(a.images.size());
}

bool asGood(const JudgedMap& a, const JudgedMap& b) {
  return std::max(a.score, b.score) <= (1 + kAsGood) * std::min(a.score, b.score) + kNoise;
}

std::vector<std::size_t> byPreference(const std::vector<JudgedMap>& maps) {
  std::vector<std::size_t> order(maps.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t x, std::size_t y) { return maps[x].score < maps[y].score; });
  std::size_t first = 0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const JudgedMap &map = maps[order[k]], &now = maps[order[first]];
    if (asGood(map, maps[order.front()]) && !sameWay(map, now) &&
        degreesOf(map.turn) < degreesOf(now.turn) - kLessTurned)
      first = k;
  }
  const auto best = order.begin() + static_cast<std::ptrdiff_t>(first);
  std::rotate(order.begin(), best, order.empty() ? best : best + 1);
  return order;
}

std::vector<std::size_t> waysOf(const std::vector<JudgedMap>& maps) {
  std::vector<std::size_t> first, out;
  for (const JudgedMap& map : maps) {
    const auto known = std::find_if(first.begin(), first.end(),
                                    [&](std::size_t f) { return sameWay(maps[f], map); });
    out.push_back(static_cast<std::size_t>(known - first.begin()));
    if (known == first.end()) first.push_back(out.size() - 1);
  }
  return out;
}

void requireOnlyWay(const WantedWay& wanted, const std::string& which) {
  if (wanted.choose != 1 || wanted.mirror)
    throw SettingError(wanted.mirror ? "mirror" : "choose",
                       which + " laid on one another in one way only; give landmarks instead");
}

std::size_t wantedWay(const std::vector<JudgedMap>& maps, const std::vector<std::size_t>& ways,
                      const WantedWay& wanted, const std::string& name) {
  if (wanted.mirror) {
    for (std::size_t m = 1; m < maps.size(); ++m)
      if (mirrored(maps[m], maps[0])) return ways[m];
    throw SettingError(
        "mirror",
        name + " has no way onto the target that swaps left and right; give landmarks instead");
  }
  const std::size_t count = ways.empty() ? 0 : 1 + *std::max_element(ways.begin(), ways.end());
  if (wanted.choose >= 1 && static_cast<std::size_t>(wanted.choose) <= count)
    return static_cast<std::size_t>(wanted.choose) - 1;
  throw SettingError("choose", fmt::format("{} was laid on the target in {} way{} that differ; "
                                           "there is no number {}",
                                           name, count, count == 1 ? "" : "s", wanted.choose));
}

}  // namespace innermap
