// Patches of a surface in a tree, and what encloses their images.
#pragma once

#include <vector>

#include "innermap/mesh/mesh.h"
#include "proof/detail/set_group.h"
#include "proof/detail/surface_pieces.h"

namespace innermap::proof {

class PatchTree {
 public:
  struct Node {
    Box3 at, image;            // scaled; the image's box is infinite where it is not known
    int first = 0, count = 0;  // children; none of a leaf
    SurfacePiece piece;        // of a leaf
    bool folds = false;        // the map was not found to be one-to-one on a box about it
  };

  // Leaves are triangles, cut until their images are known well, or there would be more than
  // `most`. Boxes of images are built from those of the leaves.
  PatchTree(const StepTrees& steps, const Mesh& surface, double scale, std::size_t most);

  std::size_t size() const { return nodes_.size(); }
  const Node& operator[](int node) const { return nodes_[node]; }

  void setFolds(int node) { nodes_[node].folds = true; }

  // Cuts these leaves in eight.
  void cut(const StepTrees& steps, const std::vector<int>& leaves);

 private:
  std::vector<Node> nodes_;  // the root first
};

// Boxes that have no point in common, surely.
bool apart(const Box3& a, const Box3& b);

}  // namespace innermap::proof
