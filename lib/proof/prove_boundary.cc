#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

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
// Pieces that one thread cuts in one go. It looks at their parts, or, at first, at the triangles.
constexpr std::size_t kTriangleBlock = 64;
// Halvings of a piece before its parts are looked at. Fewer leave fewer parts smaller than they
// need be, more leave the eight that are looked at together nearer to one another.
constexpr int kHalvings = 2;
constexpr std::uint64_t kParts = 1 << kHalvings;
// Of the longest edge among pieces: the diagonal of a box about those that are looked at together.
// What is far from all of them is expanded once.
constexpr double kMostBoundaryApart = 4;

// Of the surface's area over the number of pieces that may be looked at: where a piece whose
// longest edge has so small a square has no bound, the image of the boundary runs into charges of a
// later step, and none is to be had.
constexpr double kLeastSquare = 1e-4;
// Parts of a triangle after so many halvings are looked at with finer expansions: what others cut
// off does not shrink with them.
constexpr int kFineHalvings = 6;
// Pieces without a bound that are cut in one go: the more, the later it is known that a map in
// steps has none.
constexpr std::uint64_t kDive = 1024;

double areaOf(const SurfacePiece& piece) {
  return 0.5 * norm(cross(piece.at[1] - piece.at[0], piece.at[2] - piece.at[0]));
}

// Of the longest edge: a needle has no area, but reaches as far as other pieces.
double squaredLength(const SurfacePiece& piece) {
  double out = 0;
  for (int i = 0; i < 3; ++i) out = std::max(out, squaredNorm(piece.at[(i + 1) % 3] - piece.at[i]));
  return out;
}

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
                 double margin, std::uint64_t limit)
      : map_(map),
        steps_(steps),
        fine_(map, scale, kFineFarRatio),
        scale_(scale),
        diagonal_(diagonal),
        margin_(margin),
        limit_(limit) {}

  // All triangles as they are.
  void begin(const std::vector<SurfacePiece>& triangles) {
    double area = 0;
    for (const SurfacePiece& piece : triangles) area += areaOf(piece);
    box_ = boxOf(triangles);
    leastSquare_ = kLeastSquare * area / static_cast<double>(limit_);
    round(triangles, 0);
  }

  // Cuts open pieces in four: first those that have no bound, the smallest of them, so that it is
  // soon known where there is none; then all of them, where `room` for more pieces allows that,
  // else those of the largest bounds, and so few that there is room to cut what comes of them.
  void goOn(std::uint64_t room) {
    std::uint64_t most = room / kParts;
    if (open_.size() > most) most = std::max<std::uint64_t>(most / 2, 1);
    if (unbounded_) most = std::min(most, kDive);
    round(takeLargest(most), kHalvings);
  }

  bool mayGoOn() const { return !open_.empty() && examined_ + kParts <= limit_ && !hopeless_; }

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
  bool isFine(const SurfacePiece& piece) const {
    return passesCharges(map_) && piece.halvings >= kFineHalvings;
  }

  // Where the first of these pieces end that are looked at together.
  std::size_t groupEnd(const std::vector<SurfacePiece>& pieces, std::size_t begin) const {
    Box3 box;
    double square = 0;
    std::size_t end = begin;
    for (; end < std::min(begin + kLanes, pieces.size()); ++end) {
      for (const Vec3& v : pieces[end].at) box.add(v);
      square = std::max(square, squaredLength(pieces[end]));
      const bool apart =
          squaredNorm(box.extent()) > kMostBoundaryApart * kMostBoundaryApart * square;
      if (end > begin && (apart || isFine(pieces[end]) != isFine(pieces[begin]))) break;
    }
    return end;
  }

  // Each piece halved so many times.
  void round(std::vector<SurfacePiece> pieces, int times) {
    sortAlongCurve(box_, pieces);
    std::vector<BlockPieces> blocks((pieces.size() + kTriangleBlock - 1) / kTriangleBlock);
    parallelBlocks(pieces.size(), kTriangleBlock, [&](std::size_t begin, std::size_t end) {
      BlockPieces& out = blocks[begin / kTriangleBlock];
      for (std::size_t i = begin; i < end; ++i) cut(pieces[i], times, out.pieces);
      SetGroup group;
      for (std::size_t i = 0, next = 0; i < out.pieces.size(); i = next) {
        next = groupEnd(out.pieces, i);
        boundPieces(isFine(out.pieces[i]) ? fine_ : steps_, group, out.pieces.data() + i, next - i,
                    out.witness);
      }
    });
    Witness best;
    for (const BlockPieces& block : blocks) takeBetter(block.witness, best);
    if (best.error >= 0) look(best.piece);
    for (const BlockPieces& block : blocks) {
      examined_ += block.pieces.size();
      open_.insert(open_.end(), block.pieces.begin(), block.pieces.end());
    }
    settle();
  }

  // Pieces whose bound is near enough to what was seen are open no more.
  void settle() {
    const double enough = std::max((1 + margin_) * seen_, kExact * diagonal_ * scale_);
    const auto end = std::remove_if(open_.begin(), open_.end(), [&](const SurfacePiece& piece) {
      if (!(piece.most <= enough)) return false;
      settled_ = std::max(settled_, piece.most);
      return true;
    });
    open_.erase(end, open_.end());
    unbounded_ = false;
    for (const SurfacePiece& piece : open_) {
      if (!std::isinf(piece.most)) continue;
      unbounded_ = true;
      hopeless_ = hopeless_ || squaredLength(piece) < leastSquare_;
    }
  }

  // At most so many, in the order in which they stand; they are open no more.
  std::vector<SurfacePiece> takeLargest(std::uint64_t most) {
    std::vector<SurfacePiece> taken;
    if (open_.size() <= most) {
      taken.swap(open_);
      return taken;
    }
    using Rank = std::tuple<double, double, std::size_t>;
    std::vector<Rank> order;
    for (std::size_t i = 0; i < open_.size(); ++i)
      order.emplace_back(-open_[i].most, squaredLength(open_[i]), i);
    const auto last = order.begin() + static_cast<std::ptrdiff_t>(most);
    std::nth_element(order.begin(), last, order.end());
    std::vector<char> takes(open_.size(), 0);
    for (auto i = order.begin(); i != last; ++i) takes[std::get<2>(*i)] = 1;
    std::vector<SurfacePiece> left;
    for (std::size_t i = 0; i < open_.size(); ++i) (takes[i] ? taken : left).push_back(open_[i]);
    open_.swap(left);
    return taken;
  }

  // By plain sums, at the middle and the corners: four points take as long as one.
  void look(const SurfacePiece& piece) {
    const Vec3 places[4] = {centroid(piece.at), piece.at[0], piece.at[1], piece.at[2]};
    const Vec3 goes[4] = {centroid(piece.to), piece.to[0], piece.to[1], piece.to[2]};
    Vec3 world[4], moved[4];
    for (int i = 0; i < 4; ++i) world[i] = places[i] / scale_;
    map_.evaluate(world, 4, moved, nullptr);
    for (int i = 0; i < 4; ++i) {
      const double error = norm(scale_ * moved[i] - goes[i]);
      if (error > seen_) {
        seen_ = error;
        seenAt_ = places[i];
        seenTo_ = goes[i];
      }
    }
  }

  const ComposedMap& map_;
  const StepTrees& steps_;
  const StepTrees fine_;
  const double scale_, diagonal_, margin_;
  const std::uint64_t limit_;
  Box3 box_;  // of all pieces
  double leastSquare_ = 0;
  bool unbounded_ = false, hopeless_ = false;  // of the open pieces: some have no bound; none will
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
  const std::uint64_t limit = pieceLimit(map, surface.triangles.size(), settings);
  requireMemory("bounding the boundary's error",
                proofMemory(map, surface.triangles.size(), settings),
                "look at fewer cells a charge");
  const double scale = proofScale(boundingBox(surface));
  const auto steps = expanded.expansions(scale);
  BoundarySearch search(map, *steps, scale, diagonal, settings.errorMargin, limit);
  reportProgress("bounding the error", 0);
  search.begin(piecesOf(surface, target, scale));
  while (search.mayGoOn()) {
    reportProgress("bounding the error",
                   static_cast<double>(search.examined()) / static_cast<double>(limit));
    search.goOn(limit - search.examined());
  }
  return search.result();
}

}  // namespace innermap
