// Charges on a sphere in place of what the nodes of a tree hold.
//
// Proxies match all moments up to the basis's order. Those of a parent up to the order need no more
// of its children than that: passing proxies up a tree loses nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "innermap/core/progress.h"
#include "innermap/solve/detail/charge_tree.h"
#include "innermap/solve/detail/expansion_basis.h"

namespace innermap {

class Proxies {
 public:
  // For the nodes with more charges than the basis has points.
  Proxies(const ChargeTree& charges, std::shared_ptr<const ExpansionBasis> basis,
          Progress* progress);

  // For all nodes of a tree of anything with a harmonic far field, in one channel: `content` adds
  // the moments of a leaf, sums of weight times N_nm((position - centre) / radius). Called from
  // many threads.
  using Content = std::function<void(const BallTree::Node& leaf, double* moments)>;
  Proxies(const BallTree& balls, std::shared_ptr<const ExpansionBasis> basis,
          const Content& content, Progress* progress);

  const BallTree& balls() const { return balls_; }
  const std::shared_ptr<const ExpansionBasis>& basis() const { return basis_; }
  std::size_t groups() const { return packed_.size(); }
  std::size_t width(std::size_t group) const { return charges_ ? charges_->width(group) : 1; }
  const ChargeTree* charges() const { return charges_; }  // null when there are none

  bool has(std::size_t node) const { return slot_[node] != kNone; }
  // The node's proxies, or its charges when it has none.
  ChargeSpan standIn(std::size_t node, std::size_t group) const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  void build(const Content& content, Progress* progress);
  void buildNode(std::size_t node, std::size_t group, const Content& content);
  void addMoments(const ChargeSpan& part, const Ball& ball, std::size_t width,
                  double* moments) const;
  ChargeSpan of(std::size_t node, std::size_t group) const;

  const BallTree& balls_;
  const ChargeTree* charges_;
  std::shared_ptr<const ExpansionBasis> basis_;
  std::vector<std::uint32_t> slot_;
  std::uint32_t slots_ = 0;
  std::vector<std::vector<double>> packed_;
};

}  // namespace innermap
