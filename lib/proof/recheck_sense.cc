#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/bvh.h"
#include "core/random.h"
#include "innermap/core/run.h"
#include "mesh/winding_number.h"
#include "proof/detail/direct_set.h"
#include "proof/recheck.h"

namespace innermap::proof {
namespace {

constexpr const char* kStage = "checking the proof in another way";
// Streams of random numbers.
constexpr std::uint64_t kCells = 0x7665'0001, kPoints = 0x7665'0002;
// Of a cell's edge: where parts as small are not decided, smaller ones will not be.
constexpr double kSmallest = 1.0 / 256;
constexpr double kOnCell = 1e-11;  // of the solid: points that lie on a cell's side

struct Expected {
  bool negative = false;  // det J
  double least = 0;       // of |det J|
};

struct CellOutcome {
  bool decided = true;
  double least = std::numeric_limits<double>::infinity(), greatest = 0;
  std::optional<Disagreement> disagreement;
};

// The product over the steps; nothing is known where one of them may be 0.
Interval determinantOn(const ComposedMap& map, const ProofCell& cube) {
  const Interval nothing(-std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::infinity());
  DirectSet set = directSet(cube);
  Interval product(1);
  for (const HarmonicMap& step : map.steps()) {
    Interval factor;
    if (!throughStep(step.field(), set, &factor)) return nothing;
    if (!factor.positive() && !factor.negative()) return nothing;
    product = product * factor;
  }
  return product;
}

std::array<ProofCell, 8> eighths(const ProofCell& cube) {
  std::array<ProofCell, 8> out;
  const double half = 0.5 * cube.halfEdge;
  for (int i = 0; i < 8; ++i)
    out[static_cast<std::size_t>(i)] = {
        cube.center + half * Vec3{i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0},
        half};
  return out;
}

std::optional<Disagreement> compared(const Interval& found, const Expected& expected,
                                     const Vec3& place) {
  if (expected.negative ? found.positive() : found.negative())
    return Disagreement{
        place, fmt::format("det J is between {:.6g} and {:.6g} in a cell where it was proven to be "
                           "{} 0",
                           found.lower, found.upper, expected.negative ? "<" : ">")};
  if (found.magnitude() < expected.least)
    return Disagreement{place,
                        fmt::format("|det J| is {:.6g} at most in a cell where it was proven to be "
                                    "{:.6g} at least",
                                    found.magnitude(), expected.least)};
  return {};
}

// The cell, cut in eight as often as that takes.
CellOutcome examine(const ComposedMap& map, const ProofCell& cell, const Expected& expected,
                    std::uint64_t terms) {
  CellOutcome out;
  std::vector<ProofCell> open{cell};
  const std::size_t most = mostParts(map, terms);
  for (std::size_t parts = 0; !open.empty() && !out.disagreement; ++parts) {
    throwIfCancelled();
    const ProofCell part = open.back();
    open.pop_back();
    const Interval found = determinantOn(map, part);
    out.disagreement = compared(found, expected, part.center);
    if (found.positive() || found.negative()) {
      out.least = std::min({out.least, std::abs(found.lower), std::abs(found.upper)});
      out.greatest = std::max(out.greatest, found.magnitude());
      continue;
    }
    if (parts + open.size() >= most || part.halfEdge <= kSmallest * cell.halfEdge) {
      out.decided = false;
      break;
    }
    for (const ProofCell& eighth : eighths(part)) open.push_back(eighth);
  }
  return out;
}

void take(const CellOutcome& outcome, Recheck& out) {
  ++out.drawn;
  if (outcome.disagreement && !out.disagreement) out.disagreement = outcome.disagreement;
  if (!outcome.decided || outcome.disagreement) return;
  out.least = out.decided == 0 ? outcome.least : std::min(out.least, outcome.least);
  out.greatest = std::max(out.greatest, outcome.greatest);
  ++out.decided;
}

void drawCells(const ComposedMap& map, const SenseProof& proof, const RecheckSettings& settings,
               Recheck& out) {
  const std::vector<ProofCell>& proven = proof.proven.places;
  // Of steps it is not known here which of them turns such a cell over.
  const std::size_t others = map.steps().size() == 1 ? proof.negative.places.size() : 0;
  const std::size_t all = proven.size() + others;
  if (all == 0) return;
  const CounterRandom random(settings.seed, kCells);
  const std::size_t count = std::min(settings.cells, all);
  std::vector<CellOutcome> outcomes(count);
  parallelBlocks(
      count, 1,
      [&](std::size_t begin, std::size_t) {
        const std::size_t i = std::min(
            all - 1, static_cast<std::size_t>(random.uniform(begin) * static_cast<double>(all)));
        const bool is = i < proven.size();
        const Expected expected{proof.mirrored == is, is ? proof.least : 0};
        outcomes[begin] = examine(map, is ? proven[i] : proof.negative.places[i - proven.size()],
                                  expected, settings.terms);
      },
      kStage);
  for (const CellOutcome& outcome : outcomes) take(outcome, out);
}

// Cells, and which of them a point lies in.
class CellIndex {
 public:
  CellIndex(const SenseProof& proof, const Box3& solid) : frame_(solid) {
    std::vector<Box3> boxes;
    for (const ProofCells* lot : {&proof.proven, &proof.negative, &proof.undecided})
      for (const ProofCell& cell : lot->places) {
        const double reach = frame_.scale * cell.halfEdge + kOnCell;
        const Vec3 center = frame_.toLocal(cell.center), half{reach, reach, reach};
        Box3 box;
        box.add(center - half);
        box.add(center + half);
        boxes.push_back(box);
      }
    tree_ = buildBvh(boxes, 1);
  }

  bool holds(const Vec3& world) const {
    const Vec3 p = frame_.toLocal(world);
    std::vector<int> stack;
    if (!tree_.nodes.empty()) stack.push_back(0);
    while (!stack.empty()) {
      const Bvh::Node& node = tree_.nodes[static_cast<std::size_t>(stack.back())];
      stack.pop_back();
      if (node.squaredDistance(p) > 0) continue;
      if (node.leaf()) return true;
      stack.push_back(node.first);
      stack.push_back(node.first + 1);
    }
    return false;
  }

 private:
  LocalFrame frame_;
  Bvh tree_;
};

// Of the solid: every other one on its surface, the others in its box, which may lie outside.
class SolidPoints {
 public:
  SolidPoints(const Mesh& solid, std::uint64_t seed)
      : solid_(solid),
        box_(boundingBox(solid)),
        winding_(solid.vertices, solid.triangles),
        random_(seed, kPoints) {}

  // Whether the i-th belongs to the solid.
  bool draw(std::size_t i, Vec3& out) const {
    const double u[3] = {random_.uniform(3 * i), random_.uniform(3 * i + 1),
                         random_.uniform(3 * i + 2)};
    if (i % 2 == 0) {
      out = onSurface(u);
      return true;
    }
    for (int a = 0; a < 3; ++a) out[a] = box_.lower[a] + u[a] * box_.extent()[a];
    return std::abs(winding_.exactAt(out)) > 0.5;
  }

 private:
  Vec3 onSurface(const double u[3]) const {
    const std::size_t count = solid_.triangles.size();
    const Triangle& t = solid_.triangles[std::min(
        count - 1, static_cast<std::size_t>(u[0] * static_cast<double>(count)))];
    const double root = std::sqrt(u[1]), b = root * (1 - u[2]), c = root * u[2];
    const auto at = [&](int corner) {
      return solid_.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(corner)])];
    };
    return (1 - root) * at(0) + b * at(1) + c * at(2);
  }

  const Mesh& solid_;
  const Box3 box_;
  const WindingNumber winding_;
  const CounterRandom random_;
};

void drawPoints(const Mesh& solid, const SenseProof& proof, const RecheckSettings& settings,
                Recheck& out) {
  const CellIndex cells(proof, boundingBox(solid));
  const SolidPoints points(solid, settings.seed);
  struct Drawn {
    bool inside = false, held = false;
    Vec3 place;
  };
  std::vector<Drawn> all(2 * settings.points);
  parallelBlocks(
      all.size(), 4,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          all[i].inside = points.draw(i, all[i].place);
          all[i].held = all[i].inside && cells.holds(all[i].place);
        }
      },
      kStage);
  for (const Drawn& drawn : all) {
    if (!drawn.inside) continue;
    ++out.points;
    if (!drawn.held && !out.disagreement)
      out.disagreement = {drawn.place, "a point of the solid lies in none of the proof's cells"};
  }
}

}  // namespace

Recheck recheckSense(const ComposedMap& map, const Mesh& solid, const SenseProof& proof,
                     const RecheckSettings& settings) {
  Recheck out;
  drawCells(map, proof, settings, out);
  drawPoints(solid, proof, settings, out);
  return out;
}

double largestDeterminant(const ComposedMap& map, const Vec3& point) {
  return determinantOn(map, {point, 0}).magnitude();
}

}  // namespace innermap::proof
