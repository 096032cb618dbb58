#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/proof/prove.h"
#include "mesh/connectivity.h"
#include "proof/detail/cell_limit.h"
#include "proof/detail/set_group.h"
#include "proof/detail/solid_cells.h"

namespace innermap {
namespace {

using namespace proof;

constexpr std::size_t kMostSteps = 64;
constexpr std::uint64_t kBytesPerCell = 120;

struct DecidedCell {
  CellKey key = 1;
  std::uint64_t signs = 0;  // bit k: the determinant of step k is negative
};

// Cells whose children one thread looks at in one go.
constexpr std::size_t kBlock = 32;

// All cells that were decided, and those that were not.
struct Outcome {
  std::vector<DecidedCell> decided;
  std::map<std::uint64_t, double> least;  // of |det J|, by signs
  std::vector<OpenCell> open;
  std::uint64_t examined = 0;

  void noteLeast(std::uint64_t signs, double value) {
    const auto [place, fresh] = least.emplace(signs, value);
    if (!fresh) place->second = std::min(place->second, value);
  }
  // Decided cells are added; the open ones are replaced by the caller.
  void add(const Outcome& block) {
    decided.insert(decided.end(), block.decided.begin(), block.decided.end());
    for (const auto& [signs, value] : block.least) noteLeast(signs, value);
    examined += block.examined;
  }
};

void addProven(CellKey key, const SetGroup& group, std::size_t steps, int lane, Outcome& out) {
  DecidedCell cell{key, 0};
  double bound = 1;
  for (std::size_t k = 0; k < steps; ++k) {
    const LaneFindings& found = group.findings(k);
    bound *= found.least[lane];
    if (found.determinant[lane] < 0) cell.signs |= std::uint64_t{1} << k;
  }
  out.decided.push_back(cell);
  out.noteLeast(cell.signs, bound);
}

void splitCell(const StepTrees& steps, const SolidCells& cells, const OpenCell& parent,
               SetGroup& group, Outcome& out) {
  const ChildLanes lanes = cells.children(parent);
  if (lanes.alive == 0) return;
  LaneSets sets;
  cells.sets(parent.key, sets);
  group.compute(steps, sets, lanes.alive, true);
  for (int lane = 0; lane < static_cast<int>(kLanes); ++lane) {
    if (!(lanes.alive >> lane & 1)) continue;
    ++out.examined;
    const CellKey key = childOf(parent.key, lane);
    if (group.proven() >> lane & 1)
      addProven(key, group, steps.count(), lane, out);
    else
      out.open.push_back({key, (lanes.inside >> lane & 1) != 0, group.excess(lane)});
  }
}

void requireClosed(const Mesh& mesh) {
  const std::vector<EdgeUse> edges = sortedEdges(mesh.triangles);
  std::size_t open = 0;
  forEachEdge(edges, [&](const EdgeUse* begin, const EdgeUse* end) {
    int forward = 0;
    for (const EdgeUse* e = begin; e != end; ++e) forward += e->forward ? 1 : -1;
    if (forward != 0) ++open;
  });
  if (open > 0)
    throw DataError(fmt::format(
        "{}: nothing can be proven inside, as its surface is not closed ({} edges are open); "
        "repair it first",
        mesh.name, open));
}

double volumeOf(const Mesh& mesh) {
  if (mesh.triangles.empty())
    throw DataError(mesh.name + ": nothing can be proven inside, as it has no triangles");
  validate(mesh);
  requireNearOrigin(mesh);
  requireClosed(mesh);
  const double volume = signedVolume(mesh);
  if (!(volume > 0))
    throw DataError(mesh.name +
                    ": nothing can be proven inside, as it encloses no volume, or is "
                    "turned inside out");
  return volume;
}

double volumeOfCell(const SolidCells& cells, CellKey key) {
  const double edge = 2 * cells.world(key).halfEdge;
  return edge * edge * edge;
}

// Of the cells that are to be split those for which `room` is left: where least was missing.
std::vector<OpenCell> takeNearest(std::vector<OpenCell>& open, std::uint64_t room) {
  if (kLanes * open.size() <= room) return std::exchange(open, {});
  const auto end = open.begin() + static_cast<std::ptrdiff_t>(room / kLanes);
  std::nth_element(open.begin(), end, open.end(), [](const OpenCell& a, const OpenCell& b) {
    return std::tie(a.excess, a.key) < std::tie(b.excess, b.key);
  });
  std::vector<OpenCell> taken(open.begin(), end);
  open.erase(open.begin(), end);
  for (std::vector<OpenCell>* cells : {&taken, &open})
    std::sort(cells->begin(), cells->end(),
              [](const OpenCell& a, const OpenCell& b) { return a.key < b.key; });
  return taken;
}

// Level by level, largest cells first.
Outcome decideCells(const StepTrees& steps, const SolidCells& cells, double volume,
                    std::uint64_t limit) {
  Outcome out;
  out.open.push_back(OpenCell());
  double decidedVolume = 0;
  for (int level = 0; level < kMostLevels && out.examined + kLanes <= limit; ++level) {
    const std::vector<OpenCell> taken = takeNearest(out.open, limit - out.examined);
    if (taken.empty()) break;
    reportProgress("proving that nothing folds", std::min(1.0, decidedVolume / volume));
    std::vector<Outcome> blocks((taken.size() + kBlock - 1) / kBlock);
    parallelBlocks(taken.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      SetGroup group;
      for (std::size_t i = begin; i < end; ++i)
        splitCell(steps, cells, taken[i], group, blocks[begin / kBlock]);
    });
    for (const Outcome& block : blocks) {
      out.add(block);
      out.open.insert(out.open.end(), block.open.begin(), block.open.end());
      for (const DecidedCell& cell : block.decided) decidedVolume += volumeOfCell(cells, cell.key);
    }
  }
  return out;
}

void add(ProofCells& cells, const ProofCell& cell, bool keep) {
  ++cells.count;
  const double edge = 2 * cell.halfEdge;
  cells.volume += edge * edge * edge;
  if (keep) cells.places.push_back(cell);
}

// The signs that the greater volume has; among equals those of the cell that was decided first.
std::uint64_t commonSigns(const Outcome& outcome, const SolidCells& cells) {
  std::map<std::uint64_t, double> volumes;
  for (const DecidedCell& cell : outcome.decided)
    volumes[cell.signs] += volumeOfCell(cells, cell.key);
  std::uint64_t best = outcome.decided.empty() ? 0 : outcome.decided.front().signs;
  for (const auto& [signs, volume] : volumes)
    if (volume > volumes[best]) best = signs;
  return best;
}

SenseProof summary(const Outcome& outcome, const SolidCells& cells, double volume,
                   bool keepProven) {
  SenseProof out;
  out.examined = outcome.examined;
  const std::uint64_t common = commonSigns(outcome, cells);
  std::uint64_t odd = 0;
  for (std::size_t k = 0; k < kMostSteps; ++k) odd ^= common >> k & 1;
  out.mirrored = odd != 0;
  if (const auto least = outcome.least.find(common); least != outcome.least.end())
    out.least = least->second;
  for (const DecidedCell& cell : outcome.decided) {
    const bool proven = cell.signs == common;
    add(proven ? out.proven : out.negative, cells.world(cell.key), !proven || keepProven);
  }
  for (const OpenCell& cell : outcome.open) add(out.undecided, cells.world(cell.key), true);
  for (ProofCells* lot : {&out.proven, &out.negative, &out.undecided})
    lot->share = std::min(1.0, lot->volume / volume);
  if (out.proven.count > 0)
    out.provenShare = std::max(0.0, 1 - (out.negative.volume + out.undecided.volume) / volume);
  return out;
}

}  // namespace

SenseProof proveSense(const ExpandedMap& expanded, const Mesh& solid,
                      const ProofSettings& settings) {
  requireDescribed(settings);
  const ComposedMap& map = expanded.map();
  if (map.steps().size() > kMostSteps)
    throw DataError(fmt::format("a map in {} steps is too long for a proof; {} are taken at most",
                                map.steps().size(), kMostSteps));
  const double volume = volumeOf(solid);
  const std::uint64_t limit = cellLimit(map, settings);
  const SolidCells cells(solid);
  requireMemory("proving that nothing folds",
                FieldTree::memory(map.sources()) + kBytesPerCell * limit,
                "look at fewer cells a charge");
  const auto steps = expanded.expansions(cells.scale());
  return summary(decideCells(*steps, cells, volume, limit), cells, volume, settings.keepProven);
}

}  // namespace innermap
