#include "fit/detail/value_jumps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "innermap/core/run.h"
#include "levelset/crossing_lines.h"

namespace innermap {
namespace {

constexpr double kApart = 1.0 / 500;  // of the diagonal

}  // namespace

CrossingLines::CrossingLines(const Solid& solid) {
  for (const CrossingPoint& p : exposedCrossings(solid, kApart * solid.diagonal())) {
    places_.push_back(p.place);
    for (int side = 0; side < 2; ++side) sides_[side].push_back(p.sides[side]);
  }
}

std::vector<ValueJump> CrossingLines::jumps(const Values& values, double least) const {
  std::vector<ValueJump> out;
  if (places_.empty()) return out;
  const Matrix first = values(sides_[0]), second = values(sides_[1]);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    double squared = 0;
    for (std::size_t k = 0; k < first.columns(); ++k)
      squared += (first(i, k) - second(i, k)) * (first(i, k) - second(i, k));
    if (std::sqrt(squared) > least) out.push_back({places_[i], std::sqrt(squared)});
  }
  return out;
}

std::vector<ValueJump> CrossingLines::jumps(const Solid& solid, const Points& values,
                                            double least) const {
  const Mesh& mesh = solid.repaired().mesh;
  return jumps(
      [&](const std::vector<SurfacePoint>& addresses) {
        Matrix out(addresses.size(), 3);
        for (std::size_t i = 0; i < addresses.size(); ++i) {
          Vec3 sum;
          for (int k = 0; k < 3; ++k)
            sum += addresses[i].barycentric[k] * values[mesh.triangles[addresses[i].triangle][k]];
          for (int k = 0; k < 3; ++k) out(i, k) = sum[k];
        }
        return out;
      },
      least);
}

std::string jumpsText(const std::vector<ValueJump>& jumps, double unit,
                      const std::string& unitName) {
  if (jumps.empty()) return "";
  const ValueJump& worst =
      *std::max_element(jumps.begin(), jumps.end(),
                        [](const ValueJump& a, const ValueJump& b) { return a.size < b.size; });
  return fmt::format(
      "where exposed parts cross, their values differ by up to {:.2g} of {}, most near ({:.4g}, "
      "{:.4g}, {:.4g}); the fit blends there, and its error is large along those lines",
      worst.size / unit, unitName, worst.place.x, worst.place.y, worst.place.z);
}

}  // namespace innermap
