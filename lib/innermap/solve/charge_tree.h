// Internal to solve/. Charges in a tree of balls, and proxies for its larger nodes.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/progress.h"
#include "innermap/core/vec3.h"
#include "innermap/solve/ball_tree.h"
#include "innermap/solve/expansion_basis.h"

namespace innermap {

// Channels are summed in groups of up to three; a charge is 3 + width numbers (x, y, z, weights).
struct ChargeSpan {
  const double* first = nullptr;
  std::size_t count = 0;
};

class ChargeTree {
 public:
  // In units of the sources' box about its centre. Throws DataError as Charges does.
  ChargeTree(const Points& sources, const Matrix& weights);

  const BallTree& balls() const { return balls_; }
  std::size_t count() const { return balls_.order().size(); }
  std::size_t channels() const { return channels_; }
  std::size_t groups() const { return packed_.size(); }
  std::size_t width(std::size_t group) const {
    return std::min<std::size_t>(3, channels_ - 3 * group);
  }

  ChargeSpan charges(const BallTree::Node& node, std::size_t group) const {
    return {packed_[group].data() + node.begin * (3 + width(group)), node.count()};
  }

  Vec3 toLocal(const Vec3& p) const { return inverseScale_ * (p - center_); }
  double inverseScale() const { return inverseScale_; }

 private:
  Vec3 center_;
  double inverseScale_ = 1;
  std::size_t channels_ = 0;
  BallTree balls_;
  std::vector<std::vector<double>> packed_;  // one a group, in the order of the tree
};

// Charges on a sphere in place of those of a node, for every node with more than those.
class Proxies {
 public:
  Proxies(const ChargeTree& charges, std::shared_ptr<const ExpansionBasis> basis,
          Progress* progress);

  bool has(std::size_t node) const { return slot_[node] != kNone; }
  ChargeSpan of(std::size_t node, std::size_t group) const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  void build(std::size_t node, std::size_t group);
  ChargeSpan standIn(std::size_t node, std::size_t group) const;

  const ChargeTree& charges_;
  std::shared_ptr<const ExpansionBasis> basis_;
  std::vector<std::uint32_t> slot_;
  std::vector<std::vector<double>> packed_;
};

}  // namespace innermap
