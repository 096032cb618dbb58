#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/proof/prove.h"
#include "mesh/connectivity.h"
#include "proof/detail/cell_limit.h"
#include "proof/detail/descent.h"
#include "proof/detail/solid_cells.h"

namespace innermap {
namespace {

using namespace proof;

constexpr std::size_t kMostSteps = 64;

struct DecidedCell {
  NodeKey key = 1;
  std::uint64_t signs = 0;  // bit k: the determinant of step k is negative
};

struct BlockCells {
  std::vector<DecidedCell> cells;
  // By signs; the least |det J|.
  std::map<std::uint64_t, double> least;
  std::uint64_t examined = 0;
};

class CellSplitter : public Splitter {
 public:
  CellSplitter(const SolidCells& cells, std::size_t steps) : cells_(cells), steps_(steps) {}

  void start(std::size_t open) {
    blocks_.assign((open + Descent::kBlock - 1) / Descent::kBlock, BlockCells());
  }
  const std::vector<BlockCells>& blocks() const { return blocks_; }

  ChildLanes children(const OpenNode& parent) const override { return cells_.children(parent); }
  void sets(NodeKey parent, LaneSets& out) const override { cells_.sets(parent, out); }

  std::uint8_t decide(std::size_t block, const OpenNode& parent, const ChildLanes& lanes,
                      const SetGroup& group) override {
    BlockCells& out = blocks_[block];
    unsigned open = 0;
    for (int lane = 0; lane < static_cast<int>(kLanes); ++lane) {
      if (!(lanes.alive >> lane & 1)) continue;
      ++out.examined;
      if (group.proven() >> lane & 1)
        add(childOf(parent.key, lane), group, lane, out);
      else
        open |= 1u << lane;
    }
    return static_cast<std::uint8_t>(open);
  }

 private:
  void add(NodeKey key, const SetGroup& group, int lane, BlockCells& out) const {
    DecidedCell cell{key, 0};
    double bound = 1;
    for (std::size_t k = 0; k < steps_; ++k) {
      const LaneFindings& found = group.step(k).findings;
      bound *= found.least[lane];
      if (found.determinant[lane] < 0) cell.signs |= std::uint64_t{1} << k;
    }
    out.cells.push_back(cell);
    const auto [place, fresh] = out.least.emplace(cell.signs, bound);
    if (!fresh) place->second = std::min(place->second, bound);
  }

  const SolidCells& cells_;
  const std::size_t steps_;
  std::vector<BlockCells> blocks_;
};

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

// All cells that were decided, and those that were not.
struct Outcome {
  std::vector<DecidedCell> decided;
  std::map<std::uint64_t, double> least;
  std::vector<OpenNode> open{OpenNode()};
  std::uint64_t examined = 0;
};

double volumeOfCell(const SolidCells& cells, NodeKey key) {
  const double edge = 2 * cells.world(key).halfEdge;
  return edge * edge * edge;
}

Outcome decideCells(const MapSteps& steps, const SolidCells& cells, double volume,
                    std::uint64_t limit) {
  CellSplitter splitter(cells, steps.count());
  Descent descent(steps, splitter);
  Outcome out;
  double decidedVolume = 0;
  for (int level = 0; level < kMostLevels && !out.open.empty(); ++level) {
    if (out.examined + kLanes * out.open.size() > limit) break;
    reportProgress("proving that nothing folds", std::min(1.0, decidedVolume / volume));
    splitter.start(out.open.size());
    out.open = descent.split(out.open);
    for (const BlockCells& block : splitter.blocks()) {
      out.examined += block.examined;
      for (const DecidedCell& cell : block.cells) {
        out.decided.push_back(cell);
        decidedVolume += volumeOfCell(cells, cell.key);
      }
      for (const auto& [signs, least] : block.least) {
        const auto [place, fresh] = out.least.emplace(signs, least);
        if (!fresh) place->second = std::min(place->second, least);
      }
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
  for (const OpenNode& node : outcome.open) add(out.undecided, cells.world(node.key), true);
  for (ProofCells* lot : {&out.proven, &out.negative, &out.undecided})
    lot->share = std::min(1.0, lot->volume / volume);
  if (out.proven.count > 0)
    out.provenShare = std::max(0.0, 1 - (out.negative.volume + out.undecided.volume) / volume);
  return out;
}

}  // namespace

SenseProof proveSense(const ComposedMap& map, const Mesh& solid, const ProofSettings& settings) {
  requireDescribed(settings);
  if (map.steps().size() > kMostSteps)
    throw DataError(fmt::format("a map in {} steps is too long for a proof; {} are taken at most",
                                map.steps().size(), kMostSteps));
  const double volume = volumeOf(solid);
  const std::uint64_t limit = cellLimit(map, settings);
  const SolidCells cells(solid);
  const MapSteps steps(map, cells.scale());
  requireMemory("proving that nothing folds", Descent::memory(steps) + 200 * limit,
                "look at fewer cells a charge");
  return summary(decideCells(steps, cells, volume, limit), cells, volume, settings.keepProven);
}

}  // namespace innermap
