#include "proof/detail/patch_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/bvh.h"
#include "innermap/core/run.h"

namespace innermap::proof {
namespace {

constexpr std::size_t kBlock = 64;
constexpr double kLooseShare = 0.15;  // of an image's diagonal: as much slack is too much
constexpr int kMostCuts = 6;          // of a triangle, each in eight

Box3 everywhere() {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  Box3 box;
  box.add(Vec3{-kInfinite, -kInfinite, -kInfinite});
  box.add(Vec3{kInfinite, kInfinite, kInfinite});
  return box;
}

Box3 boxOf(const std::array<Vec3, 3>& corners) {
  Box3 box;
  for (const Vec3& v : corners) box.add(v);
  return box;
}

struct Image {
  Box3 box = everywhere();
  bool tight = false;  // most of it is the piece's linear image
};

// The linear image of a lane's three corners, and the slack about it.
Image imageOf(const LaneSets& image, std::size_t lane) {
  Box3 box;
  double large = 0;
  for (int i = 0; i < 3; ++i) {
    Vec3 p;
    for (int a = 0; a < 3; ++a) p[a] = image.center[a][lane] + image.vertex[i][a][lane];
    large = std::max(large, largestCoordinate(p));
    box.add(p);
  }
  const double slack = image.slack[lane] + 1e-14 * large;
  const bool tight = slack < kLooseShare * box.diagonal();
  for (int a = 0; a < 3; ++a) {
    box.lower[a] -= slack;
    box.upper[a] += slack;
  }
  return {box, tight};
}

// Images of pieces that stand near one another in this order.
std::vector<Image> imagesOf(const StepTrees& steps, const std::vector<SurfacePiece>& pieces) {
  std::vector<Image> out(pieces.size());
  parallelBlocks(pieces.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    SetGroup group;
    for (std::size_t i = begin; i < end; i += kLanes) {
      const std::size_t count = std::min(kLanes, end - i);
      group.compute(steps, setsOf(pieces.data() + i, count),
                    static_cast<std::uint8_t>((1u << count) - 1), false);
      for (std::size_t lane = 0; lane < count; ++lane)
        if (group.enclosed() >> lane & 1)
          out[i + lane] = imageOf(group.findings(steps.count() - 1).image, lane);
    }
  });
  return out;
}

// Triangles, cut until their images are known, or there would be more than `most`.
void cutLoosePieces(const StepTrees& steps, std::size_t most, std::vector<SurfacePiece>& pieces,
                    std::vector<Image>& images) {
  images = imagesOf(steps, pieces);
  for (int round = 0; round < kMostCuts; ++round) {
    std::vector<SurfacePiece> cutOnes;
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (!images[i].tight) cut(pieces[i], 3, cutOnes);
    if (cutOnes.empty() || pieces.size() + cutOnes.size() > most) return;
    throwIfCancelled();
    const std::vector<Image> theirs = imagesOf(steps, cutOnes);
    std::vector<SurfacePiece> allPieces;
    std::vector<Image> allImages;
    std::size_t next = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const std::size_t parts = images[i].tight ? 0 : kLanes;
      if (parts == 0) {
        allPieces.push_back(pieces[i]);
        allImages.push_back(images[i]);
      }
      for (std::size_t part = 0; part < parts; ++part, ++next) {
        allPieces.push_back(cutOnes[next]);
        allImages.push_back(theirs[next]);
      }
    }
    pieces = std::move(allPieces);
    images = std::move(allImages);
  }
}

}  // namespace

bool apart(const Box3& a, const Box3& b) {
  for (int k = 0; k < 3; ++k)
    if (a.lower[k] > b.upper[k] || b.lower[k] > a.upper[k]) return true;
  return false;
}

PatchTree::PatchTree(const StepTrees& steps, const Mesh& surface, double scale, std::size_t most) {
  std::vector<SurfacePiece> pieces = piecesOf(surface, surface.vertices, scale);
  sortAlongCurve(boxOf(pieces), pieces);
  std::vector<Image> images;
  cutLoosePieces(steps, most, pieces, images);
  const Vec3 middle = scale * boundingBox(surface).center();
  std::vector<Box3> boxes;
  for (const SurfacePiece& piece : pieces) {
    Box3 box;
    for (const Vec3& v : piece.at) box.add(v - middle);
    boxes.push_back(box);
  }
  const Bvh tree = buildBvh(boxes, 1);
  nodes_.resize(tree.nodes.size());
  for (std::size_t n = nodes_.size(); n-- > 0;) {  // children stand behind their parents
    const Bvh::Node& from = tree.nodes[n];
    Node& node = nodes_[n];
    if (from.leaf()) {
      const int i = tree.order[from.first];
      node.piece = pieces[i];
      node.at = boxOf(node.piece.at);
      node.image = images[i].box;
      continue;
    }
    node.first = from.first;
    node.count = 2;
    for (int child = from.first; child < from.first + 2; ++child) {
      node.at.add(nodes_[child].at);
      node.image.add(nodes_[child].image);
    }
  }
}

void PatchTree::cut(const StepTrees& steps, const std::vector<int>& leaves) {
  std::vector<SurfacePiece> pieces;
  for (const int leaf : leaves) {
    nodes_[leaf].first = static_cast<int>(nodes_.size() + pieces.size());
    nodes_[leaf].count = static_cast<int>(kLanes);
    proof::cut(nodes_[leaf].piece, 3, pieces);
  }
  const std::vector<Image> images = imagesOf(steps, pieces);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    Node node;
    node.piece = pieces[i];
    node.at = boxOf(node.piece.at);
    node.image = images[i].box;
    nodes_.push_back(node);
  }
}

}  // namespace innermap::proof
