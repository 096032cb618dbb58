#include "mesh/detail/triangle_meeting.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.h"
#include "mesh/detail/intersect_triangles.h"

namespace innermap {
namespace {

// In all orders of the corners, either way round, and turned so that no axis is special.
void expectMeeting(Meeting wanted, const Points& at, const Triangle& a, const Triangle& b) {
  for (int turns = 0; turns < 3; ++turns) {
    Points p = at;
    for (Vec3& v : p) v = turns == 0 ? v : turns == 1 ? Vec3{v.y, v.z, v.x} : Vec3{v.z, v.x, v.y};
    Triangle first = a;
    std::sort(first.begin(), first.end());
    do {
      Triangle second = b;
      std::sort(second.begin(), second.end());
      do {
        std::uint64_t exact = 0;
        ASSERT_EQ(meetingOf(p, first, second, exact), wanted);
        ASSERT_EQ(meetingOf(p, second, first, exact), wanted);
      } while (std::next_permutation(second.begin(), second.end()));
    } while (std::next_permutation(first.begin(), first.end()));
  }
}

TEST(TriangleMeeting, NothingShared) {
  const Points base{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const auto meets = [&](Meeting wanted, const Vec3& d, const Vec3& e, const Vec3& f) {
    Points at = base;
    at.insert(at.end(), {d, e, f});
    expectMeeting(wanted, at, {0, 1, 2}, {3, 4, 5});
  };
  meets(Meeting::apart, {0, 0, 1}, {4, 0, 1}, {0, 4, 2});
  meets(Meeting::crossing, {1, 1, -1}, {1, 1, 1}, {9, 9, 0});
  meets(Meeting::crossing, {1, 1, -1}, {1, 1, 1}, {1, 1.5, 3});
  meets(Meeting::apart, {3, 3, -1}, {3, 3, 1}, {9, 9, 0});       // beside it
  meets(Meeting::undecided, {1, 1, 0}, {1, 2, 3}, {2, 2, 3});    // a corner on it
  meets(Meeting::apart, {3, 3, 0}, {1, 2, 3}, {2, 2, 3});        // in its plane, beside it
  meets(Meeting::undecided, {1, 1, 0}, {2, 1, 0}, {2, 2, 3});    // a side on it
  meets(Meeting::apart, {5, 0, 0}, {9, 0, 0}, {7, 2, 3});        // on its side's line
  meets(Meeting::undecided, {0, 4, 1}, {0, 4, -1}, {-3, 5, 0});  // through a corner
  meets(Meeting::undecided, {1, 1, 0}, {9, 1, 0}, {9, 9, 0});    // coplanar
  meets(Meeting::apart, {3, 3, 0}, {9, 1, 0}, {9, 9, 0});
  meets(Meeting::undecided, {2, 2, 0}, {9, 1, 0}, {9, 9, 0});  // touching
  meets(Meeting::undecided, {1, 1, 0}, {1, 1, 1}, {1, 1, 3});  // without area
}

TEST(TriangleMeeting, ACornerShared) {
  const Points base{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const auto meets = [&](Meeting wanted, const Vec3& d, const Vec3& e) {
    Points at = base;
    at.insert(at.end(), {d, e});
    expectMeeting(wanted, at, {0, 1, 2}, {0, 3, 4});
  };
  meets(Meeting::apart, {1, 1, 1}, {2, 1, 1});
  meets(Meeting::crossing, {1, 1, 1}, {1, 2, -1});
  meets(Meeting::apart, {-1, -1, 1}, {-1, -2, -1});  // on the other side of the corner
  meets(Meeting::apart, {-1, 1, 1}, {-1, 2, -1});
  meets(Meeting::undecided, {2, 0, 1}, {2, 0, -1});  // along a side
  meets(Meeting::undecided, {1, 1, 0}, {2, 1, 1});   // a side on it
  meets(Meeting::apart, {-1, -1, 0}, {2, 1, 1});
  meets(Meeting::undecided, {9, 0, 0}, {2, 1, 1});  // on its side
  meets(Meeting::apart, {-9, 0, 0}, {2, 1, 1});     // on that side's line
  meets(Meeting::apart, {-4, 0, 0}, {0, -4, 0});    // coplanar
  meets(Meeting::apart, {-4, 0, 0}, {-1, -4, 0});
  meets(Meeting::undecided, {1, 1, 0}, {9, 8, 0});
  meets(Meeting::undecided, {4, -1, 0}, {-1, 4, 0});
  meets(Meeting::undecided, {2, 0, 0}, {4, -4, 0});
}

TEST(TriangleMeeting, AnEdgeShared) {
  const Points base{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const auto meets = [&](Meeting wanted, const Vec3& d) {
    Points at = base;
    at.push_back(d);
    expectMeeting(wanted, at, {0, 1, 2}, {0, 1, 3});
  };
  meets(Meeting::apart, {1, 1, 1e-60});
  meets(Meeting::apart, {1, -1, 0});
  meets(Meeting::undecided, {1, 1, 0});
  meets(Meeting::undecided, {9, 0, 0});  // without area
  expectMeeting(Meeting::undecided, base, {0, 1, 2}, {0, 1, 2});
}

// Against the test that allows for rounding, where nothing is near to touching.
TEST(TriangleMeetingRelease, AgreesOnRandomTriangles) {
  int crossings = 0;
  for (std::uint64_t seed = 0; seed < 20000; ++seed) {
    const CounterRandom random(seed, 2);
    Points at(6);
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t k = 0; k < 3; ++k) at[i][static_cast<int>(k)] = random.uniform(3 * i + k);
    const int shared = static_cast<int>(seed % 3);
    const Triangle a{0, 1, 2}, b{shared > 0 ? 0 : 3, shared > 1 ? 1 : 4, 5};
    const auto corners = [&](const Triangle& t) {
      return TriangleCorners{at[t[0]], at[t[1]], at[t[2]]};
    };
    Vec3 place;
    std::uint64_t exact = 0;
    const bool through = passThrough(corners(a), corners(b), place);
    ASSERT_EQ(meetingOf(at, a, b, exact), through ? Meeting::crossing : Meeting::apart)
        << "seed " << seed;
    crossings += through;
  }
  EXPECT_GT(crossings, 1000);
  EXPECT_LT(crossings, 15000);
}

}  // namespace
}  // namespace innermap
