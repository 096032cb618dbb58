// One step of a hierarchical sum: from a ball of targets and the charges that
// its parent could not expand, to the expansion in the ball and the charges left for its children.
//
// Charges are expanded in a ball of targets when its radius is at most `separation` of their
// distance, and stand together as proxies when theirs is. Potentials of either are summed at the
// check points of the ball: the kernel's loop is the only translation there is. (After Barnes and
// Hut, "A Hierarchical O(N log N) Force-Calculation Algorithm", Nature 1986, on the side of the
// charges, and Greengard and Rokhlin, "A Fast Algorithm for Particle Simulations", J. Comput. Phys.
// 1987, on that of the targets.)
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "solve/detail/ball_tree.h"
#include "solve/detail/expansion_basis.h"
#include "solve/detail/kernel_simd.h"
#include "solve/detail/proxies.h"
#include "solve/detail/row.h"

namespace innermap {

// The harmonic polynomial of the far charges in a ball: basis.paddedCount() x 3 coefficients a
// group, empty when there are no far charges. In units of the ball.
struct Expansion {
  Ball ball;
  std::vector<double> coefficients;
};

// Charges relative to the ball's centre, one array a group.
using NearCharges = std::vector<std::vector<double>>;

// Memory of one thread's steps, kept from one to the next.
struct FarFieldWorkspace {
  NearCharges far;
  std::vector<std::uint32_t> stack;
  simd::Row values, harmonics, x, y, z;
};

struct FarFieldPlan {
  int order = 8;            // of the polynomials, in [0, ExpansionBasis::kMostOrder]
  double separation = 0.5;  // largest ratio of a ball's radius to the distance it is seen from
  simd::Rounding rounding = simd::Rounding::full;
};

class FarField {
 public:
  // The basis must be that of plan.order.
  FarField(const Proxies& proxies, const FarFieldPlan& plan);

  const Proxies& sources() const { return proxies_; }
  const ExpansionBasis& basis() const { return *basis_; }
  simd::Rounding rounding() const { return plan_.rounding; }

  // The expansion in `ball` of its parent's and of those of `nodes` that are far from it. Adds the
  // others to `left`; none of them is larger than the ball unless it is a leaf.
  Expansion expand(const Ball& ball, const Expansion& parent,
                   const std::vector<std::uint32_t>& nodes, std::vector<std::uint32_t>& left,
                   FarFieldWorkspace& work) const;

  // The same for a ball without children: each charge is expanded or put into `near`, whose old
  // content goes.
  Expansion expandLast(const Ball& ball, const Expansion& parent,
                       const std::vector<std::uint32_t>& nodes, NearCharges& near,
                       FarFieldWorkspace& work) const;

 private:
  void gather(const Ball& ball, const std::vector<std::uint32_t>& nodes,
              std::vector<std::uint32_t>* left, NearCharges* near, FarFieldWorkspace& work) const;
  void split(const BallTree::Node& leaf, const Ball& ball, NearCharges& near,
             NearCharges& far) const;
  Expansion expansionOf(const Ball& ball, const Expansion& parent, FarFieldWorkspace& work) const;
  void addParent(const Ball& ball, const Expansion& parent, FarFieldWorkspace& work) const;

  const Proxies& proxies_;
  FarFieldPlan plan_;
  std::shared_ptr<const ExpansionBasis> basis_;
  simd::Row x_, y_, z_;  // check points, padded
};

}  // namespace innermap
