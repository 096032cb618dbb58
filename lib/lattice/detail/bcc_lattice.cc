#include "lattice/detail/bcc_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace innermap {
namespace {

using Step = std::array<int, 3>;

int directionOf(const Step& step) {
  for (int d = 0; d < kDirections; ++d)
    if (kSteps[d] == step) return d;
  return -1;
}

Step minus(const Step& a, const Step& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

int determinantOf(const Step& a, const Step& b, const Step& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

}  // namespace

BccLattice::BccLattice(const Vec3& origin, double spacing, const std::array<int, 3>& size)
    : origin_(origin), spacing_(spacing), size_(size) {
  cells_ = static_cast<std::size_t>(size[0]) * size[1] * size[2];
  const std::array<std::ptrdiff_t, 3> stride{1, size[0],
                                             static_cast<std::ptrdiff_t>(size[0]) * size[1]};
  const auto other = static_cast<std::ptrdiff_t>(cells_);
  for (int second = 0; second < 2; ++second)
    for (int d = 0; d < kDirections; ++d) {
      std::ptrdiff_t offset = d < kLongDirections ? 0 : second ? -other : other;
      for (int a = 0; a < 3; ++a) {
        const int step = kSteps[d][a];
        offset += stride[a] * (d < kLongDirections ? step / 2 : (step + (second ? 1 : -1)) / 2);
      }
      offsets_[second][d] = offset;
    }
}

Vec3 BccLattice::position(std::size_t node) const {
  const double shift = second(node) ? 0.5 : 0;
  const std::size_t c = second(node) ? node - cells_ : node;
  const std::size_t row = c / size_[0], layer = row / size_[1];
  return origin_ + spacing_ * Vec3{static_cast<double>(c % size_[0]) + shift,
                                   static_cast<double>(row % size_[1]) + shift,
                                   static_cast<double>(layer) + shift};
}

std::size_t BccLattice::nearest(const Vec3& p) const {
  const Vec3 q = (p - origin_) / spacing_;
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int second = 0; second < 2; ++second) {
    std::array<std::size_t, 3> at{};
    for (int a = 0; a < 3; ++a)
      at[a] = static_cast<std::size_t>(
          std::clamp(std::round(q[a] - 0.5 * second), 2.0, static_cast<double>(size_[a] - 3)));
    const std::size_t node = (second ? cells_ : 0) + at[0] + size_[0] * (at[1] + size_[1] * at[2]);
    const double d = squaredNorm(position(node) - p);
    if (d < least) {
      least = d;
      best = node;
    }
  }
  return best;
}

std::array<BccTetrahedron, 12> bccTetrahedra(const BccLattice& lattice) {
  std::array<BccTetrahedron, 12> all{};
  int count = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 4; ++k) {
      static constexpr int kRing[5][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}, {1, 1}};
      BccTetrahedron& t = all[count++];
      t.place[1][axis] = 2;
      for (int m = 0; m < 2; ++m) {
        Step& p = t.place[2 + m];
        p[axis] = 1;
        p[(axis + 1) % 3] = kRing[k + m][0];
        p[(axis + 2) % 3] = kRing[k + m][1];
      }
      if (determinantOf(t.place[1], t.place[2], t.place[3]) < 0) std::swap(t.place[2], t.place[3]);
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) t.direction[i][j] = directionOf(minus(t.place[j], t.place[i]));
        t.offset[i] = i == 0 ? 0 : lattice.offsets(0)[t.direction[0][i]];
      }
    }
  return all;
}

const BccLink& BccLink::get() {
  static const BccLink link = [] {
    BccLink l;
    std::array<int, kDirections> beside{};
    const auto adjacent = [](int d, int e) {
      return directionOf(minus(kSteps[e], kSteps[d])) >= 0;
    };
    for (int d = 0; d < kDirections; ++d)
      for (int e = 0; e < kDirections; ++e) beside[d] |= adjacent(d, e) << e;
    l.connected.assign(1 << kDirections, false);
    for (int set = 1; set < 1 << kDirections; ++set) {
      int reached = set & -set;
      for (int before = 0; before != reached;) {
        before = reached;
        for (int d = 0; d < kDirections; ++d)
          if (before >> d & 1) reached |= beside[d] & set;
      }
      l.connected[set] = reached == set;
    }
    for (int d = 0; d < kDirections; ++d) {
      int left = beside[d], at = 0;
      while (!(left >> at & 1)) ++at;
      while (at >= 0) {
        l.around[d].push_back(at);
        left &= ~(1 << at);
        int next = -1;
        for (int e = 0; e < kDirections && next < 0; ++e)
          if ((left & beside[at]) >> e & 1) next = e;
        at = next;
      }
    }
    return l;
  }();
  return link;
}

}  // namespace innermap
