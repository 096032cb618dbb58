#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/random.h"
#include "innermap/core/run.h"
#include "proof/detail/direct_set.h"
#include "proof/recheck.h"

namespace innermap::proof {
namespace {

constexpr std::uint64_t kTriangles = 0x7665'0003;  // stream of random numbers
constexpr double kUnit = 0x1p-52;
// Of a triangle's size: where parts as small are not decided, smaller ones will not be.
constexpr double kSmallestPiece = 1.0 / 4096;

using Corners = std::array<Vec3, 3>;

// A part of a triangle; its corners stand for sums with weights that are exact, so that they are
// off by a few units of rounding of the triangle's own.
struct Piece {
  Corners at, to;
};

struct PieceError {
  double most = 0;  // none on the piece is larger
  double sure = 0;  // one at its middle is as large
};

struct Rounding {
  double at = 0, to = 0;
};

Vec3 middle(const Corners& c) { return (c[0] + c[1] + c[2]) / 3; }

double largest(const Corners& corners) {
  double out = 0;
  for (const Vec3& c : corners) out = std::max({out, std::abs(c.x), std::abs(c.y), std::abs(c.z)});
  return out;
}

bool through(const ComposedMap& map, DirectSet& set) {
  return std::all_of(map.steps().begin(), map.steps().end(), [&](const HarmonicMap& step) {
    return throughStep(step.field(), set, nullptr);
  });
}

Interval distance(const Vec3& a, const Vec3& b, const Vec3& c) {
  Interval sum;
  for (int i = 0; i < 3; ++i) sum += square(Interval(a[i]) + b[i] - Interval(c[i]));
  return squareRoot(sum);
}

// Map minus target is linear on the piece but for the slack: largest at a corner.
PieceError errorOn(const ComposedMap& map, const Piece& piece, const Rounding& rounding) {
  PieceError out;
  DirectSet set, point;
  set.center = point.center = middle(piece.at);
  set.slack = point.slack = rounding.at;
  for (std::size_t i = 0; i < 4; ++i) set.vertex[i] = piece.at[i % 3] - set.center;
  if (through(map, point))
    out.sure = (distance(point.center, {}, middle(piece.to)) - point.slack - rounding.to).lower;
  if (!through(map, set)) {
    out.most = std::numeric_limits<double>::infinity();
    return out;
  }
  for (std::size_t i = 0; i < 3; ++i)
    out.most = std::max(
        out.most,
        (distance(set.center, set.vertex[i], piece.to[i]) + set.slack + rounding.to).upper);
  return out;
}

std::array<Piece, 2> halves(const Piece& piece) {
  std::size_t longest = 0;
  double length = -1;
  for (std::size_t i = 0; i < 3; ++i) {
    const double l = squaredNorm(piece.at[(i + 1) % 3] - piece.at[i]);
    if (l <= length) continue;
    length = l;
    longest = i;
  }
  const std::size_t a = longest, b = (longest + 1) % 3;
  std::array<Piece, 2> out{piece, piece};
  out[0].at[a] = out[1].at[b] = 0.5 * (piece.at[a] + piece.at[b]);
  out[0].to[a] = out[1].to[b] = 0.5 * (piece.to[a] + piece.to[b]);
  return out;
}

double extent(const Piece& piece) {
  return std::sqrt(
      std::max({squaredNorm(piece.at[1] - piece.at[0]), squaredNorm(piece.at[2] - piece.at[1]),
                squaredNorm(piece.at[0] - piece.at[2])}));
}

struct TriangleOutcome {
  bool decided = true;
  double most = 0, sure = 0;
  Vec3 sureAt;
};

// bound: world units.
TriangleOutcome examine(const ComposedMap& map, const Piece& triangle, double bound,
                        std::uint64_t terms) {
  const Rounding rounding{64 * kUnit * largest(triangle.at), 64 * kUnit * largest(triangle.to)};
  TriangleOutcome out;
  std::vector<Piece> open{triangle};
  const std::size_t most = mostParts(map, terms / 2);
  for (std::size_t pieces = 0; !open.empty(); ++pieces) {
    throwIfCancelled();
    const Piece piece = open.back();
    open.pop_back();
    const PieceError error = errorOn(map, piece, rounding);
    if (error.sure > out.sure) {
      out.sure = error.sure;
      out.sureAt = middle(piece.at);
    }
    if (error.most <= bound) {
      out.most = std::max(out.most, error.most);
      continue;
    }
    if (out.sure > bound || pieces + open.size() >= most ||
        extent(piece) <= kSmallestPiece * extent(triangle)) {
      out.decided = false;
      break;
    }
    for (const Piece& half : halves(piece)) open.push_back(half);
  }
  return out;
}

Piece triangleOf(const Mesh& surface, const Points& target, std::size_t t) {
  Piece out;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto v = static_cast<std::size_t>(surface.triangles[t][i]);
    out.at[i] = surface.vertices[v];
    out.to[i] = target[v];
  }
  return out;
}

double diagonalOf(const Mesh& surface, const Points& target) {
  Box3 box;
  for (const Triangle& t : surface.triangles)
    for (const int v : t) box.add(target[static_cast<std::size_t>(v)]);
  return box.diagonal();
}

}  // namespace

Recheck recheckBoundary(const ComposedMap& map, const Mesh& surface, const Points& target,
                        double bound, const RecheckSettings& settings) {
  Recheck out;
  const std::size_t all = surface.triangles.size();
  const double diagonal = diagonalOf(surface, target);
  const CounterRandom random(settings.seed, kTriangles);
  out.drawn = std::min(settings.cells, all);
  std::vector<TriangleOutcome> outcomes(out.drawn);
  parallelBlocks(
      out.drawn, 1,
      [&](std::size_t begin, std::size_t) {
        const std::size_t t = std::min(
            all - 1, static_cast<std::size_t>(random.uniform(begin) * static_cast<double>(all)));
        // What divides and multiplies with the diagonal is off by less.
        outcomes[begin] = examine(map, triangleOf(surface, target, t),
                                  bound * diagonal * (1 + 1e-12), settings.terms);
      },
      "checking the error again");
  for (const TriangleOutcome& outcome : outcomes) {
    out.least = std::max(out.least, outcome.sure / diagonal);
    if (outcome.decided) {
      ++out.decided;
      out.greatest = std::max(out.greatest, outcome.most / diagonal);
    } else if (outcome.sure > bound * diagonal * (1 + 1e-12) && !out.disagreement) {
      out.disagreement = {outcome.sureAt,
                          fmt::format("the boundary is {:.6g} of the target's diagonal off, where "
                                      "{:.6g} at most was proven",
                                      outcome.sure / diagonal, bound)};
    }
  }
  return out;
}

double sureDistance(const ComposedMap& map, const Vec3& point, const Vec3& other) {
  DirectSet set;
  set.center = point;
  if (!through(map, set)) return 0;
  return std::max(0.0, (distance(set.center, {}, other) - set.slack).lower);
}

}  // namespace innermap::proof
