#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/proof/prove.h"
#include "proof/detail/cell_limit.h"
#include "proof/detail/scale.h"
#include "proof/detail/set_group.h"
#include "proof/detail/surface_pieces.h"

namespace innermap {
namespace {

using namespace proof;

constexpr double kExact = 1e-11;  // of the diagonal: an error that is as good as none
// Pieces that one thread splits in one go; triangles at first, eight times as many.
constexpr std::size_t kBlock = 32;

struct Witness {
  SurfacePiece piece;
  double error = -1;  // about, at the centroid
};

struct BlockPieces {
  std::vector<SurfacePiece> pieces;
  Witness witness;
};

// On a piece map minus target is linear but for the slack, so that it is largest at a corner.
void boundPieces(const StepTrees& steps, SetGroup& group, SurfacePiece* pieces, std::size_t count,
                 Witness& witness) {
  const auto alive = static_cast<std::uint8_t>((1u << count) - 1);
  group.compute(steps, setsOf(pieces, count), alive, false);
  if (group.enclosed() == 0) return;
  const LaneSets& image = group.findings(steps.count() - 1).image;
  for (std::size_t lane = 0; lane < count; ++lane) {
    if (!(group.enclosed() >> lane & 1)) continue;
    SurfacePiece& piece = pieces[lane];
    const Vec3 center{image.center[0][lane], image.center[1][lane], image.center[2][lane]};
    double most = 0, large = 0;
    for (int i = 0; i < 3; ++i) {
      const Vec3 moved{image.vertex[i][0][lane], image.vertex[i][1][lane],
                       image.vertex[i][2][lane]};
      most = std::max(most, norm(center + moved - piece.to[i]));
      large = std::max(large, largestCoordinate(piece.to[i]));
    }
    piece.most = most * (1 + 1e-14) + image.slack[lane] + 1e-14 * large;
    const double there = norm(center - centroid(piece.to));
    if (there > witness.error) witness = {piece, there};
  }
}

void takeBetter(const Witness& other, Witness& best) {
  if (other.error > best.error) best = other;
}

class BoundarySearch {
 public:
  BoundarySearch(const ComposedMap& map, const StepTrees& steps, double scale, double diagonal,
                 double margin)
      : map_(map), steps_(steps), scale_(scale), diagonal_(diagonal), margin_(margin) {}

  // All triangles, or all open pieces cut in eight.
  void round(std::vector<SurfacePiece> pieces, bool whole) {
    std::vector<BlockPieces> blocks((pieces.size() + kBlock - 1) / kBlock);
    parallelBlocks(pieces.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      BlockPieces& out = blocks[begin / kBlock];
      for (std::size_t i = begin; i < end; ++i) cut(pieces[i], whole ? 0 : 3, out.pieces);
      SetGroup group;
      for (std::size_t i = 0; i < out.pieces.size(); i += kLanes)
        boundPieces(steps_, group, out.pieces.data() + i, std::min(kLanes, out.pieces.size() - i),
                    out.witness);
    });
    Witness best;
    for (const BlockPieces& block : blocks) takeBetter(block.witness, best);
    if (best.error >= 0) look(best.piece);
    const double enough = std::max((1 + margin_) * seen_, kExact * diagonal_ * scale_);
    open_.clear();
    for (const BlockPieces& block : blocks)
      for (const SurfacePiece& piece : block.pieces) {
        ++examined_;
        if (piece.most <= enough)
          settled_ = std::max(settled_, piece.most);
        else
          open_.push_back(piece);
      }
  }

  std::vector<SurfacePiece>& open() { return open_; }
  std::uint64_t examined() const { return examined_; }

  BoundaryProof result() const {
    double most = settled_;
    for (const SurfacePiece& piece : open_) most = std::max(most, piece.most);
    BoundaryProof out;
    const double unit = 1 / (scale_ * diagonal_);
    out.error = most * unit * (1 + 1e-14);
    out.seen = seen_ * unit;
    out.seenAt = seenAt_ / scale_;
    out.seenTo = seenTo_ / scale_;
    out.close = out.error <= std::max((1 + margin_) * out.seen * (1 + 1e-13), 1.01 * kExact);
    out.examined = examined_;
    return out;
  }

 private:
  // By plain sums, at the middle and the corners.
  void look(const SurfacePiece& piece) {
    const Vec3 places[4] = {centroid(piece.at), piece.at[0], piece.at[1], piece.at[2]};
    const Vec3 goes[4] = {centroid(piece.to), piece.to[0], piece.to[1], piece.to[2]};
    for (int i = 0; i < 4; ++i) {
      const double error = norm(scale_ * map_(places[i] / scale_) - goes[i]);
      if (error > seen_) {
        seen_ = error;
        seenAt_ = places[i];
        seenTo_ = goes[i];
      }
    }
  }

  const ComposedMap& map_;
  const StepTrees& steps_;
  const double scale_, diagonal_, margin_;
  std::vector<SurfacePiece> open_;
  std::uint64_t examined_ = 0;
  double settled_ = 0, seen_ = 0;
  Vec3 seenAt_, seenTo_;
};

double targetDiagonal(const Mesh& surface, const Points& target) {
  if (surface.triangles.empty())
    throw DataError(surface.name + ": no error can be bounded, as it has no triangles");
  validate(surface);
  if (target.size() != surface.vertices.size())
    throw DataError(fmt::format("{}: has {} vertices, its target {}; both must have the same",
                                surface.name, surface.vertices.size(), target.size()));
  Mesh moved;
  moved.name = surface.name + " (target)";
  moved.vertices = target;
  moved.triangles = surface.triangles;
  validate(moved);
  const double diagonal = boundingBox(moved).diagonal();
  if (!(diagonal > 0)) throw DataError(moved.name + ": lies in one point");
  return diagonal;
}

}  // namespace

BoundaryProof proveBoundaryError(const ExpandedMap& expanded, const Mesh& surface,
                                 const Points& target, const ProofSettings& settings) {
  requireDescribed(settings);
  const ComposedMap& map = expanded.map();
  const double diagonal = targetDiagonal(surface, target);
  const std::uint64_t limit =
      std::max<std::uint64_t>(cellLimit(map, settings), 8 * surface.triangles.size());
  requireMemory("bounding the boundary's error",
                proofMemory(map, surface.triangles.size(), settings),
                "look at fewer cells a charge");
  const double scale = proofScale(boundingBox(surface));
  const auto steps = expanded.expansions(scale);
  BoundarySearch search(map, *steps, scale, diagonal, settings.errorMargin);
  reportProgress("bounding the boundary's error", 0);
  search.round(sortedPieces(surface, target, scale), true);
  while (!search.open().empty() && search.examined() + kLanes * search.open().size() <= limit) {
    reportProgress("bounding the boundary's error",
                   static_cast<double>(search.examined()) / static_cast<double>(limit));
    search.round(std::move(search.open()), false);
  }
  return search.result();
}

}  // namespace innermap
