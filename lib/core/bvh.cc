#include "core/bvh.h"

#include <tbb/parallel_invoke.h>

#include <numeric>

namespace innermap {
namespace {

constexpr int kBins = 16;
constexpr int kMedianDepth = 48;         // below it, splits are at the median: depth stays bounded
constexpr int kParallelItems = 1 << 13;  // subtrees at least this large are tasks of their own

double halfArea(const Box3& box) {
  if (box.empty()) return 0;
  const Vec3 e = box.extent();
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

float roundDown(double v) {
  const float f = static_cast<float>(v);
  return f > v ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}

float roundUp(double v) {
  const float f = static_cast<float>(v);
  return f < v ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

struct Split {
  int axis = -1;  // -1: centroids coincide or no split pays
  int bin = 0;    // items of bins <= bin go left
};

class Builder {
 public:
  Builder(const std::vector<Box3>& boxes, int leafSize, Bvh& bvh)
      : boxes_(boxes), leafSize_(leafSize), bvh_(bvh) {
    const std::size_t n = boxes.size();
    centers_.reserve(n);
    for (const Box3& box : boxes) centers_.push_back(box.center());
    bvh_.order.resize(n);
    std::iota(bvh_.order.begin(), bvh_.order.end(), 0);
    // A subtree of k items has at most k - 1 inner nodes, each with one pair of children: every
    // subtree owns a fixed range of pairs, so tasks write without asking one another.
    bvh_.nodes.resize(1 + 2 * (n - 1));
    build(0, 0, static_cast<int>(n), 0, 0);
    compact();
  }

 private:
  void build(int node, int begin, int end, int firstPair, int depth) {
    Box3 box, centers;
    for (int i = begin; i < end; ++i) {
      box.add(boxes_[bvh_.order[i]]);
      centers.add(centers_[bvh_.order[i]]);
    }
    Bvh::Node& n = bvh_.nodes[node];
    for (int a = 0; a < 3; ++a) {
      n.lower[a] = roundDown(box.lower[a]);
      n.upper[a] = roundUp(box.upper[a]);
    }
    if (end - begin <= leafSize_) {
      n.first = begin;
      n.count = end - begin;
      return;
    }
    const int middle = partition(begin, end, centers, depth);
    const int left = 1 + 2 * firstPair;
    n.first = left;
    n.count = 0;
    const auto goLeft = [=] { build(left, begin, middle, firstPair + 1, depth + 1); };
    const auto goRight = [=] {
      build(left + 1, middle, end, firstPair + (middle - begin), depth + 1);
    };
    if (end - begin >= kParallelItems) {
      tbb::parallel_invoke(goLeft, goRight);
    } else {
      goLeft();
      goRight();
    }
  }

  static int binOf(double value, double lower, double factor) {
    return std::min(kBins - 1, static_cast<int>((value - lower) * factor));
  }

  Split bestSplit(int begin, int end, const Box3& centers) const {
    Split best;
    double bestCost = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double lower = centers.lower[axis], extent = centers.upper[axis] - lower;
      const double factor = kBins / extent;
      if (!(extent > 0) || !std::isfinite(factor)) continue;
      std::array<Box3, kBins> boxes;
      std::array<int, kBins> counts{};
      for (int i = begin; i < end; ++i) {
        const int item = bvh_.order[i];
        const int bin = binOf(centers_[item][axis], lower, factor);
        boxes[bin].add(boxes_[item]);
        ++counts[bin];
      }
      std::array<double, kBins> rightCost{};
      Box3 box;
      int count = 0;
      for (int b = kBins - 1; b > 0; --b) {
        box.add(boxes[b]);
        count += counts[b];
        rightCost[b] = halfArea(box) * count;
      }
      box = Box3();
      count = 0;
      for (int b = 0; b + 1 < kBins; ++b) {
        box.add(boxes[b]);
        count += counts[b];
        const double cost = halfArea(box) * count + rightCost[b + 1];
        if (count > 0 && count < end - begin && cost < bestCost) {
          bestCost = cost;
          best = {axis, b};
        }
      }
    }
    return best;
  }

  int partition(int begin, int end, const Box3& centers, int depth) {
    const auto first = bvh_.order.begin();
    const Split split = depth < kMedianDepth ? bestSplit(begin, end, centers) : Split{};
    if (split.axis >= 0) {
      const int axis = split.axis;
      const double lower = centers.lower[axis];
      const double factor = kBins / (centers.upper[axis] - lower);
      // Stable, so that the order of equal items does not hang on the standard library.
      const auto middle = std::stable_partition(first + begin, first + end, [&](int item) {
        return binOf(centers_[item][axis], lower, factor) <= split.bin;
      });
      return static_cast<int>(middle - first);
    }
    const Vec3 e = centers.extent();
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
    const int middle = begin + (end - begin) / 2;
    std::nth_element(first + begin, first + middle, first + end, [&](int i, int j) {
      const double x = centers_[i][axis], y = centers_[j][axis];
      return x < y || (x == y && i < j);
    });
    return middle;
  }

  // Takes out the pairs that no inner node uses; the order of those that stay is kept.
  void compact() {
    std::vector<Bvh::Node>& nodes = bvh_.nodes;
    std::vector<int> moved(nodes.size(), -1);
    moved[0] = 0;
    int count = 1;
    // Pairs stand behind their parents, so one pass finds all that are in use.
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (moved[i] >= 0 && !nodes[i].leaf()) {
        moved[nodes[i].first] = 0;
        moved[nodes[i].first + 1] = 0;
      }
      if (i > 0 && moved[i] == 0) moved[i] = count++;
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (moved[i] < 0) continue;
      Bvh::Node node = nodes[i];
      if (!node.leaf()) node.first = moved[node.first];
      nodes[moved[i]] = node;
    }
    nodes.resize(count);
    nodes.shrink_to_fit();
  }

  const std::vector<Box3>& boxes_;
  int leafSize_;
  Bvh& bvh_;
  Points centers_;
};

}  // namespace

LocalFrame::LocalFrame(const Box3& box) {
  if (box.empty()) return;
  // Half each, so that boxes near the largest double do not overflow.
  center = 0.5 * box.lower + 0.5 * box.upper;
  const Vec3 half = 0.5 * box.upper - 0.5 * box.lower;
  const double size = std::max({half.x, half.y, half.z});
  if (!(size > 0)) return;
  const int exponent = std::clamp(std::ilogb(size), -1000, 1000);
  scale = std::ldexp(1.0, -exponent);
  inverse = std::ldexp(1.0, exponent);
}

Bvh buildBvh(const std::vector<Box3>& boxes, int leafSize) {
  Bvh bvh;
  if (!boxes.empty()) Builder(boxes, leafSize, bvh);
  return bvh;
}

}  // namespace innermap
