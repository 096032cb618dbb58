// Down a tree of targets: expansions from parent to child, to the leaves.
#pragma once

#include <functional>
#include <string_view>

#include "solve/detail/far_field.h"
#include "solve/detail/leaf_sums.h"

namespace innermap {

// Memory of one subtree's work, kept from leaf to leaf.
struct DescentWorkspace {
  NearCharges near;  // of the leaf that is visited
  FarFieldWorkspace farField;
  LeafSums sums;
};

using LeafVisitor = std::function<void(const BallTree::Node& leaf, const Expansion& expansion,
                                       DescentWorkspace& work)>;

// Visits each leaf of `targets` once, from many threads. What a leaf gets never depends on those.
void descend(const FarField& field, const BallTree& targets, const LeafVisitor& visit,
             std::string_view stage);

}  // namespace innermap
