// Charges on a sphere in place of what the nodes of a tree hold.
//
// Proxies match all moments up to the basis's order. Those of a parent up to the order need no more
// of its children than that: passing proxies up a tree loses nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "solve/detail/charge_tree.h"
#include "solve/detail/expansion_basis.h"

namespace innermap {

class Proxies {
 public:
  // For the nodes with more charges than the basis has points.
  Proxies(const ChargeTree& charges, std::shared_ptr<const ExpansionBasis> basis);

  const BallTree& balls() const { return charges_.balls(); }
  const std::shared_ptr<const ExpansionBasis>& basis() const { return basis_; }
  std::size_t groups() const { return packed_.size(); }
  std::size_t width(std::size_t group) const { return charges_.width(group); }
  const ChargeTree& charges() const { return charges_; }

  bool has(std::size_t node) const { return slot_[node] != kNone; }
  // The node's proxies, or its charges when it has none.
  ChargeSpan standIn(std::size_t node, std::size_t group) const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  void build();
  void buildNode(std::size_t node, std::size_t group);
  void addMoments(const ChargeSpan& part, const Ball& ball, std::size_t width,
                  double* moments) const;
  ChargeSpan of(std::size_t node, std::size_t group) const;

  const ChargeTree& charges_;
  std::shared_ptr<const ExpansionBasis> basis_;
  std::vector<std::uint32_t> slot_;
  std::uint32_t slots_ = 0;
  std::vector<std::vector<double>> packed_;
};

}  // namespace innermap
