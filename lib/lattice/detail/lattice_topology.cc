#include "lattice/detail/lattice_topology.h"

#include <numeric>

#include "core/disjoint_sets.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

// Twelve times a lattice tetrahedron's share of the Euler characteristic, without its corners: a
// long edge belongs to four, a short one to six, a face to two.
std::array<int, 16> sharesOfEuler() {
  std::array<int, 16> shares{};
  for (int inside = 0; inside < 16; ++inside) {
    const auto all = [&](int set) { return (inside & set) == set; };
    int share = -12 * all(15) - 3 * (all(3) + all(12));
    for (const int edge : {5, 9, 6, 10}) share -= 2 * all(edge);
    for (const int face : {7, 11, 13, 14}) share += 6 * all(face);
    shares[inside] = share;
  }
  return shares;
}

long eulerCharacteristic(const LatticeSigns& signs) {
  const BccLattice& lattice = signs.lattice;
  const auto shapes = bccTetrahedra(lattice);
  const auto shares = sharesOfEuler();
  const auto inside = [&](std::size_t node) {
    return signs.side[node] == NodeSide::inside ? 1 : 0;
  };
  const auto& n = lattice.size();
  const std::size_t margin = 1 + n[0] + static_cast<std::size_t>(n[0]) * n[1];
  const std::size_t cells = lattice.cells() - 2 * margin;
  constexpr std::size_t kBlock = 1 << 15;
  std::vector<long> sums((cells + kBlock - 1) / kBlock, 0);
  parallelBlocks(cells, kBlock, [&](std::size_t begin, std::size_t end) {
    long sum = 0;
    for (std::size_t c = begin + margin; c < end + margin; ++c) {
      for (const BccTetrahedron& shape : shapes) {
        int set = inside(c);
        for (int i = 1; i < 4; ++i)
          set |= inside(c + static_cast<std::size_t>(shape.offset[i])) << i;
        sum += shares[set];
      }
    }
    sums[begin / kBlock] = sum;
  });
  const long twelve = std::accumulate(sums.begin(), sums.end(), 0L);
  return std::count(signs.side.begin(), signs.side.end(), NodeSide::inside) + twelve / 12;
}

// Nodes of one row with the same side, next to one another.
struct Run {
  int begin, end;
  bool inside;
};

class Runs {
 public:
  explicit Runs(const LatticeSigns& signs) : size_(signs.lattice.size()) {
    const int rows = 2 * size_[1] * size_[2];
    for (int row = 0; row < rows; ++row) {
      start_.push_back(static_cast<int>(runs_.size()));
      const NodeSide* side = signs.side.data() + static_cast<std::size_t>(row) * size_[0];
      for (int i = 0; i < size_[0]; ++i) {
        const bool inside = side[i] == NodeSide::inside;
        if (i == 0 || runs_.back().inside != inside) runs_.push_back({i, i, inside});
        runs_.back().end = i + 1;
      }
    }
    start_.push_back(static_cast<int>(runs_.size()));
  }

  std::array<int, 2> components() const {  // outside, inside
    DisjointSets sets(runs_.size());
    for (int second = 0; second < 2; ++second)
      for (int k = 0; k < size_[2]; ++k)
        for (int j = 0; j < size_[1]; ++j) {
          join(sets, rowOf(second, j, k), rowOf(second, j + 1, k), 0);
          join(sets, rowOf(second, j, k), rowOf(second, j, k + 1), 0);
          for (int m = 0; second == 0 && m < 4; ++m)
            join(sets, rowOf(0, j, k), rowOf(1, j - (m & 1), k - (m >> 1)), 1);
        }
    std::array<int, 2> count{};
    for (std::size_t r = 0; r < runs_.size(); ++r)
      if (sets.find(static_cast<int>(r)) == static_cast<int>(r)) ++count[runs_[r].inside];
    return count;
  }

 private:
  int rowOf(int second, int j, int k) const {
    if (j < 0 || k < 0 || j >= size_[1] || k >= size_[2]) return -1;
    return (second * size_[2] + k) * size_[1] + j;
  }

  // Node i of row a is beside nodes i - reach to i of row b.
  void join(DisjointSets& sets, int a, int b, int reach) const {
    if (b < 0) return;
    int first = start_[b];
    for (int r = start_[a]; r < start_[a + 1]; ++r) {
      while (first < start_[b + 1] && runs_[first].end <= runs_[r].begin - reach) ++first;
      for (int q = first; q < start_[b + 1] && runs_[q].begin < runs_[r].end; ++q)
        if (runs_[q].inside == runs_[r].inside) sets.unite(r, q);
    }
  }

  std::array<int, 3> size_;
  std::vector<Run> runs_;
  std::vector<int> start_;
};

}  // namespace

SolidTopology latticeTopology(const LatticeSigns& signs) {
  const auto [outside, inside] = Runs(signs).components();
  SolidTopology t;
  t.components = inside;
  t.cavities = outside - 1;
  t.handles = static_cast<int>(t.components + t.cavities - eulerCharacteristic(signs));
  return t;
}

}  // namespace innermap
