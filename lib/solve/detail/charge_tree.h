// Charges in a tree of balls.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "solve/detail/ball_tree.h"

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

}  // namespace innermap
