#include "mesh/detail/triangle_meeting.h"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include "core/orientation.h"

namespace innermap {
namespace {

using Corners = std::array<Vec3, 3>;

bool strict(Sign s) { return s == Sign::negative || s == Sign::positive; }
bool equalAndStrict(Sign a, Sign b) { return a == b && strict(a); }

class Signs {
 public:
  explicit Signs(std::uint64_t& exact) : exact_(exact) {}

  Sign side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) const {
    return orientation(a, b, c, d, exact_);
  }
  Sign side(const Corners& t, const Vec3& p) const { return side(t[0], t[1], t[2], p); }
  Sign turned(const Vec3& a, const Vec3& b, const Vec3& c, int axis) const {
    return turn(a, b, c, axis, exact_);
  }

  // An axis along which the triangle's plane can be looked at; -1: none, it is degenerate.
  int axisOf(const Corners& t) const {
    for (int axis = 0; axis < 3; ++axis)
      if (strict(turned(t[0], t[1], t[2], axis))) return axis;
    return -1;
  }

 private:
  std::uint64_t& exact_;
};

// In the plane of the corner a and the triangle's other two, where d lies: whether the ray from a
// to d leaves the triangle at once.
bool leaves(const Signs& signs, const Corners& t, const Vec3& d) {
  const int axis = signs.axisOf(t);
  if (axis < 0) return false;
  const Sign turned = signs.turned(t[0], t[1], t[2], axis);
  return signs.turned(t[0], t[1], d, axis) == opposite(turned) ||
         signs.turned(t[0], d, t[2], axis) == opposite(turned);
}

// Both triangles in one plane, with the corner 0 in common.
Meeting flatFans(const Signs& signs, const Corners& a, const Corners& b) {
  // Two cones at one point are apart where neither has a side in the other.
  for (const auto& [cone, other] : {std::pair(&a, &b), std::pair(&b, &a)})
    for (int k = 1; k < 3; ++k)
      if (!leaves(signs, *cone, (*other)[k])) return Meeting::undecided;
  return Meeting::apart;
}

// Whether all points lie strictly on the side of the line that the corner does not.
template <class Range>
bool beyond(const Signs& signs, const Vec3& from, const Vec3& to, Sign cornerSide, const Range& p,
            int axis) {
  return std::all_of(std::begin(p), std::end(p), [&](const Vec3& q) {
    return signs.turned(from, to, q, axis) == opposite(cornerSide);
  });
}

// Whether a side of the triangle has all points, which lie in its plane, beyond it.
template <class Range>
bool separates(const Signs& signs, const Corners& t, const Range& p) {
  const int axis = signs.axisOf(t);
  if (axis < 0) return false;
  const Sign turned = signs.turned(t[0], t[1], t[2], axis);
  for (int k = 0; k < 3; ++k)
    if (beyond(signs, t[k], t[(k + 1) % 3], turned, p, axis)) return true;
  return false;
}

// The segment and the triangle in one plane.
bool flatSegmentApart(const Signs& signs, const Vec3& p, const Vec3& q, const Corners& t) {
  if (separates(signs, t, std::array<Vec3, 2>{p, q})) return true;
  const int axis = signs.axisOf(t);
  if (axis < 0) return false;
  return beyond(signs, p, q, Sign::positive, t, axis) ||
         beyond(signs, p, q, Sign::negative, t, axis);
}

// sideP, sideQ: of the triangle's plane.
Meeting segmentMeeting(const Signs& signs, const Vec3& p, const Vec3& q, Sign sideP, Sign sideQ,
                       const Corners& t) {
  if (equalAndStrict(sideP, sideQ)) return Meeting::apart;
  if (sideP == Sign::undecided || sideQ == Sign::undecided) return Meeting::undecided;
  if (sideP == Sign::zero && sideQ == Sign::zero)
    return flatSegmentApart(signs, p, q, t) ? Meeting::apart : Meeting::undecided;
  // How the line winds about the sides: about all alike where it passes through the triangle.
  int positive = 0, negative = 0;
  for (int k = 0; k < 3; ++k) {
    const Sign s = signs.side(p, q, t[k], t[(k + 1) % 3]);
    positive += s == Sign::positive;
    negative += s == Sign::negative;
  }
  if (positive > 0 && negative > 0) return Meeting::apart;
  const bool through = positive == 3 || negative == 3;
  return through && strict(sideP) && strict(sideQ) ? Meeting::crossing : Meeting::undecided;
}

std::array<Sign, 3> sidesOf(const Signs& signs, const Corners& plane, const Corners& t) {
  return {signs.side(plane, t[0]), signs.side(plane, t[1]), signs.side(plane, t[2])};
}

bool onOneSide(const std::array<Sign, 3>& s) { return equalAndStrict(s[0], s[1]) && s[1] == s[2]; }

Meeting nothingShared(const Signs& signs, const Corners& a, const Corners& b) {
  const std::array<Sign, 3> ofB = sidesOf(signs, a, b);
  if (onOneSide(ofB)) return Meeting::apart;
  const std::array<Sign, 3> ofA = sidesOf(signs, b, a);
  if (onOneSide(ofA)) return Meeting::apart;
  const auto flat = [](const std::array<Sign, 3>& s) {
    return s[0] == Sign::zero && s[1] == Sign::zero && s[2] == Sign::zero;
  };
  if (flat(ofA) && flat(ofB))
    return separates(signs, a, b) || separates(signs, b, a) ? Meeting::apart : Meeting::undecided;
  // Where they meet, a side of one meets the other.
  Meeting found = Meeting::apart;
  for (const auto& [edges, sides, t] : {std::tuple(&b, &ofB, &a), std::tuple(&a, &ofA, &b)})
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const Meeting edge =
          segmentMeeting(signs, (*edges)[k], (*edges)[next], (*sides)[k], (*sides)[next], *t);
      if (edge == Meeting::crossing) return edge;
      if (edge == Meeting::undecided) found = edge;
    }
  return found;
}

// The corner 0 of both: where they meet elsewhere, they do so along a ray from it.
Meeting cornerShared(const Signs& signs, const Corners& a, const Corners& b) {
  const Sign b1 = signs.side(a, b[1]), b2 = signs.side(a, b[2]);
  if (equalAndStrict(b1, b2)) return Meeting::apart;
  const Sign a1 = signs.side(b, a[1]), a2 = signs.side(b, a[2]);
  if (equalAndStrict(a1, a2)) return Meeting::apart;
  for (const Sign s : {a1, a2, b1, b2})
    if (s == Sign::undecided) return Meeting::undecided;
  if (b1 == Sign::zero && b2 == Sign::zero) return flatFans(signs, a, b);
  // A side in the other's plane is all that triangle has there.
  for (int k = 1; k < 3; ++k) {
    if ((k == 1 ? b1 : b2) == Sign::zero)
      return leaves(signs, a, b[k]) ? Meeting::apart : Meeting::undecided;
    if ((k == 1 ? a1 : a2) == Sign::zero)
      return leaves(signs, b, a[k]) ? Meeting::apart : Meeting::undecided;
  }
  // Where b's far side passes a's plane: between a's sides where it winds about both as about
  // those of a triangle that it goes down through.
  const Sign first = signs.side(b[1], b[2], a[0], a[1]);
  const Sign last = signs.side(b[1], b[2], a[2], a[0]);
  if (first == b1 || last == b1) return Meeting::apart;
  return strict(first) && strict(last) ? Meeting::crossing : Meeting::undecided;
}

// a[0], a[1] are b's too, and the third ones are not.
Meeting edgeShared(const Signs& signs, const Corners& a, const Vec3& third) {
  const Sign s = signs.side(a, third);
  if (strict(s)) return Meeting::apart;
  const int axis = signs.axisOf(a);
  if (s == Sign::undecided || axis < 0) return Meeting::undecided;
  const Sign turned = signs.turned(a[0], a[1], a[2], axis);
  return signs.turned(a[0], a[1], third, axis) == opposite(turned) ? Meeting::apart
                                                                   : Meeting::undecided;
}

}  // namespace

Meeting meetingOf(const Points& vertices, const Triangle& a, const Triangle& b,
                  std::uint64_t& exact) {
  // Shared corners first, in the same order.
  Triangle own = a, other = b;
  int shared = 0;
  for (int i = 0; i < 3; ++i) {
    const auto found = std::find(other.begin() + shared, other.end(), own[i]);
    if (found == other.end()) continue;
    std::iter_swap(own.begin() + shared, own.begin() + i);
    std::iter_swap(other.begin() + shared, found);
    ++shared;
  }
  const auto corners = [&](const Triangle& t) {
    return Corners{vertices[t[0]], vertices[t[1]], vertices[t[2]]};
  };
  const Signs signs(exact);
  const Corners p = corners(own), q = corners(other);
  if (shared == 0) return nothingShared(signs, p, q);
  if (shared == 1) return cornerShared(signs, p, q);
  return shared == 2 ? edgeShared(signs, p, q[2]) : Meeting::undecided;
}

Meeting meetingOf(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t,
                  std::uint64_t& exact) {
  const Signs signs(exact);
  return segmentMeeting(signs, p, q, signs.side(t, p), signs.side(t, q), t);
}

}  // namespace innermap
