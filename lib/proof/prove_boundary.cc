#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/proof/prove.h"
#include "proof/detail/cell_limit.h"
#include "proof/detail/scale.h"
#include "proof/detail/set_group.h"

namespace innermap {
namespace {

using namespace proof;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kExact = 1e-11;  // of the diagonal: an error that is as good as none
constexpr std::uint64_t kBytesPerPiece = 400;
// Pieces that one thread splits in one go; triangles at first, eight times as many.
constexpr std::size_t kBlock = 32;

// A triangle or a part of one, and where its corners go; scaled.
struct Piece {
  std::array<Vec3, 3> at, to;
  double most = kInfinite;  // no error on it is larger
};

struct Witness {
  Piece piece;
  double error = -1;  // about, at the centroid
};

struct BlockPieces {
  std::vector<Piece> pieces;
  Witness witness;
};

Vec3 centroid(const std::array<Vec3, 3>& corners) {
  return (corners[0] + corners[1] + corners[2]) / 3;
}

// Halves across the longest edge, thrice.
void cut(const Piece& piece, int times, std::vector<Piece>& out) {
  if (times == 0) {
    out.push_back(piece);
    return;
  }
  int longest = 0;
  double length = -1;
  for (int i = 0; i < 3; ++i) {
    const double l = squaredNorm(piece.at[(i + 1) % 3] - piece.at[i]);
    if (l > length) {
      length = l;
      longest = i;
    }
  }
  const int a = longest, b = (longest + 1) % 3;
  const Vec3 middle = 0.5 * (piece.at[a] + piece.at[b]), goes = 0.5 * (piece.to[a] + piece.to[b]);
  for (const int replaced : {a, b}) {
    Piece half = piece;
    half.at[replaced] = middle;
    half.to[replaced] = goes;
    cut(half, times - 1, out);
  }
}

double largestCoordinate(const Vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

LaneSets setsOf(const Piece* pieces, std::size_t count) {
  LaneSets out{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::array<Vec3, 3>& at = pieces[std::min(lane, count - 1)].at;
    const Vec3 center = centroid(at);
    double radius = 0;
    for (int i = 0; i < 4; ++i) {
      const Vec3 v = at[i % 3] - center;
      radius = std::max(radius, norm(v));
      for (int a = 0; a < 3; ++a) out.vertex[i][a][lane] = v[a];
    }
    for (int a = 0; a < 3; ++a) out.center[a][lane] = center[a];
    out.slack[lane] = 4e-15 * (largestCoordinate(center) + radius);
    out.radius[lane] = (radius + out.slack[lane]) * (1 + 1e-14);
  }
  return out;
}

// On a piece map minus target is linear but for the slack, so that it is largest at a corner.
void boundPieces(const StepTrees& steps, SetGroup& group, Piece* pieces, std::size_t count,
                 Witness& witness) {
  const auto alive = static_cast<std::uint8_t>((1u << count) - 1);
  group.compute(steps, setsOf(pieces, count), alive, false);
  if (group.enclosed() == 0) return;
  const LaneSets& image = group.findings(steps.count() - 1).image;
  for (std::size_t lane = 0; lane < count; ++lane) {
    if (!(group.enclosed() >> lane & 1)) continue;
    Piece& piece = pieces[lane];
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

// Neighbours stand near one another: along a curve of Morton.
std::vector<Piece> sortedPieces(const Mesh& surface, const Points& target, double scale) {
  const Box3 box = boundingBox(surface);
  const double cells = 1023 / std::max({box.extent().x, box.extent().y, box.extent().z, 1e-300});
  std::vector<std::pair<std::uint32_t, Piece>> keyed;
  for (const Triangle& t : surface.triangles) {
    Piece piece;
    for (int i = 0; i < 3; ++i) {
      piece.at[i] = scale * surface.vertices[t[i]];
      piece.to[i] = scale * target[t[i]];
    }
    const Vec3 place = cells * (centroid(piece.at) / scale - box.lower);
    std::uint32_t key = 0;
    for (int bit = 9; bit >= 0; --bit)
      for (int a = 0; a < 3; ++a) {
        const auto whole = static_cast<std::uint32_t>(std::clamp(place[a], 0.0, 1023.0));
        key = key << 1 | (whole >> bit & 1);
      }
    keyed.emplace_back(key, piece);
  }
  std::stable_sort(keyed.begin(), keyed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Piece> out;
  for (auto& [key, piece] : keyed) out.push_back(piece);
  return out;
}

class BoundarySearch {
 public:
  BoundarySearch(const ComposedMap& map, const StepTrees& steps, double scale, double diagonal,
                 double margin)
      : map_(map), steps_(steps), scale_(scale), diagonal_(diagonal), margin_(margin) {}

  // All triangles, or all open pieces cut in eight.
  void round(std::vector<Piece> pieces, bool whole) {
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
      for (const Piece& piece : block.pieces) {
        ++examined_;
        if (piece.most <= enough)
          settled_ = std::max(settled_, piece.most);
        else
          open_.push_back(piece);
      }
  }

  std::vector<Piece>& open() { return open_; }
  std::uint64_t examined() const { return examined_; }

  BoundaryProof result() const {
    double most = settled_;
    for (const Piece& piece : open_) most = std::max(most, piece.most);
    BoundaryProof out;
    const double unit = 1 / (scale_ * diagonal_);
    out.error = most * unit * (1 + 1e-14);
    out.seen = seen_ * unit;
    out.seenAt = seenAt_ / scale_;
    out.close = out.error <= std::max((1 + margin_) * out.seen * (1 + 1e-13), 1.01 * kExact);
    out.examined = examined_;
    return out;
  }

 private:
  // By plain sums, at the middle and the corners.
  void look(const Piece& piece) {
    const Vec3 places[4] = {centroid(piece.at), piece.at[0], piece.at[1], piece.at[2]};
    const Vec3 goes[4] = {centroid(piece.to), piece.to[0], piece.to[1], piece.to[2]};
    for (int i = 0; i < 4; ++i) {
      const double error = norm(scale_ * map_(places[i] / scale_) - goes[i]);
      if (error > seen_) {
        seen_ = error;
        seenAt_ = places[i];
      }
    }
  }

  const ComposedMap& map_;
  const StepTrees& steps_;
  const double scale_, diagonal_, margin_;
  std::vector<Piece> open_;
  std::uint64_t examined_ = 0;
  double settled_ = 0, seen_ = 0;
  Vec3 seenAt_;
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

BoundaryProof proveBoundaryError(const ComposedMap& map, const Mesh& surface, const Points& target,
                                 const ProofSettings& settings) {
  requireDescribed(settings);
  const double diagonal = targetDiagonal(surface, target);
  const std::uint64_t limit =
      std::max<std::uint64_t>(cellLimit(map, settings), 8 * surface.triangles.size());
  requireMemory("bounding the boundary's error",
                FieldTree::memory(map.sources()) + kBytesPerPiece * limit,
                "look at fewer cells a charge");
  const double scale = proofScale(boundingBox(surface));
  const StepTrees steps(map, scale);
  BoundarySearch search(map, steps, scale, diagonal, settings.errorMargin);
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
