#include "mesh/cover_once.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/disjoint_sets.h"
#include "core/orientation.h"
#include "innermap/core/run.h"
#include "mesh/detail/triangle_meeting.h"
#include "mesh/triangle_tree.h"

namespace innermap {
namespace {

constexpr char kStage[] = "checking overlaps";
// Ways from a triangle to the points beside it, of its size.
constexpr std::array<double, 3> kBeside{1e-2, 1e-4, 1e-7};
// Triangles of a part that are tried.
constexpr std::size_t kTried = 8;

class Cover {
 public:
  Cover(const Points& vertices, const std::vector<Triangle>& triangles)
      : vertices_(vertices), triangles_(triangles) {}

  CoverCheck run() {
    findMeetings();
    const std::vector<std::vector<int>> parts = partsTried();
    std::vector<CoverCheck> found(parts.size());
    parallelBlocks(
        parts.size(), 1,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t p = begin; p < end; ++p) checkPart(parts[p], found[p]);
        },
        kStage);
    for (const CoverCheck& part : found) add(part);
    return out_;
  }

 private:
  std::array<Vec3, 3> corners(int t) const {
    const Triangle& c = triangles_[t];
    return {vertices_[c[0]], vertices_[c[1]], vertices_[c[2]]};
  }

  void add(const CoverCheck& part) {
    out_.crossings += part.crossings;
    out_.meetings += part.meetings;
    out_.doubled += part.doubled;
    out_.unknown += part.unknown;
    out_.exact += part.exact;
  }

  void findMeetings() {
    std::vector<CoverCheck> found(TriangleTree::kParts);
    const auto look = [&](std::size_t part, int i, int j) {
      CoverCheck& counts = found[part];
      const Meeting m = meetingOf(vertices_, triangles_[i], triangles_[j], counts.exact);
      counts.crossings += m == Meeting::crossing;
      counts.meetings += m == Meeting::undecided;
    };
    TriangleTree(vertices_, triangles_).overlappingPairs(look, [&] {
      for (CoverCheck& part : found) add(std::exchange(part, {}));
    });
  }

  // A few triangles of each part.
  std::vector<std::vector<int>> partsTried() const {
    struct Side {
      std::array<int, 2> ends;
      int triangle;
    };
    std::vector<Side> sides;
    sides.reserve(3 * triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(triangles_[t][k], triangles_[t][(k + 1) % 3]);
        sides.push_back({{a, b}, static_cast<int>(t)});
      }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return a.ends != b.ends ? a.ends < b.ends : a.triangle < b.triangle;
    });
    DisjointSets sets(triangles_.size());
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
      for (end = i + 1; end < sides.size() && sides[end].ends == sides[i].ends;) ++end;
      if (end == i + 2) sets.unite(sides[i].triangle, sides[i + 1].triangle);
    }
    const std::vector<int> representative = sets.representatives();
    std::vector<int> number(triangles_.size(), -1);
    std::vector<std::vector<int>> parts;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      int& part = number[representative[t]];
      if (part < 0) {
        part = static_cast<int>(parts.size());
        parts.emplace_back();
      }
      if (parts[part].size() < kTried) parts[part].push_back(static_cast<int>(t));
    }
    return parts;
  }

  void checkPart(const std::vector<int>& part, CoverCheck& found) const {
    for (const int t : part)
      for (const double beside : kBeside) {
        const std::optional<int> winding = windingInside(t, beside, found.exact);
        if (!winding) continue;
        found.doubled += *winding != 1;
        return;
      }
    ++found.unknown;
  }

  // How often the surface winds about the points just inside of the triangle. From a point inside
  // to one outside a way passes through this triangle and no other: so the first is one of those.
  std::optional<int> windingInside(int t, double beside, std::uint64_t& exact) const {
    const std::array<Vec3, 3> at = corners(t);
    const Vec3 normal = cross(at[1] - at[0], at[2] - at[0]);
    const double size = norm(normal);
    if (!(size > 0)) return {};
    const Vec3 middle = (at[0] + at[1] + at[2]) / 3,
               way = (beside / std::sqrt(size)) * normal;  // about as long as `beside` of its sides
    const Vec3 inside = middle - way, outside = middle + way;
    if (orientation(at[0], at[1], at[2], outside, exact) != Sign::positive ||
        meetingOf(inside, outside, at, exact) != Meeting::crossing)
      return {};
    Box3 box;
    box.add(inside);
    box.add(outside);
    for (std::size_t other = 0; other < triangles_.size(); ++other) {
      if (other == static_cast<std::size_t>(t)) continue;
      const std::array<Vec3, 3> c = corners(static_cast<int>(other));
      if (reaches(c, box) && meetingOf(inside, outside, c, exact) != Meeting::apart) return {};
    }
    return windingAt(inside, exact);
  }

  static bool reaches(const std::array<Vec3, 3>& c, const Box3& box) {
    for (int a = 0; a < 3; ++a)
      if (std::max({c[0][a], c[1][a], c[2][a]}) < box.lower[a] ||
          std::min({c[0][a], c[1][a], c[2][a]}) > box.upper[a])
        return false;
    return true;
  }

  // By a ray along z, which must pass through no edge.
  std::optional<int> windingAt(const Vec3& p, std::uint64_t& exact) const {
    Box3 ray;
    ray.lower = p;
    ray.upper = {p.x, p.y, std::numeric_limits<double>::infinity()};
    int winding = 0;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const std::array<Vec3, 3> c = corners(static_cast<int>(t));
      if (!reaches(c, ray)) continue;
      int left = 0, right = 0;
      for (int k = 0; k < 3; ++k) {
        const Sign s = turn(c[k], c[(k + 1) % 3], p, 2, exact);
        left += s == Sign::positive;
        right += s == Sign::negative;
      }
      if (left > 0 && right > 0) continue;
      if (left < 3 && right < 3) return {};
      const Sign side = orientation(c[0], c[1], c[2], p, exact);
      if (side != Sign::positive && side != Sign::negative) return {};
      // Seen from above counter-clockwise the triangle faces up: the ray leaves by it.
      if (left == 3 && side == Sign::negative) ++winding;
      if (right == 3 && side == Sign::positive) --winding;
    }
    return winding;
  }

  const Points& vertices_;
  const std::vector<Triangle>& triangles_;
  CoverCheck out_;
};

}  // namespace

CoverCheck checkCover(const Points& vertices, const std::vector<Triangle>& triangles) {
  return Cover(vertices, triangles).run();
}

}  // namespace innermap
