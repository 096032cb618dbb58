#include "innermap/tetra/remesh_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/tetra/cells.h"
#include "innermap/tetra/tetrahedralize.h"
#include "tetra/detail/cell_system.h"
#include "tetra/detail/coarse_start.h"
#include "tetra/detail/guide_surface.h"
#include "tetra/detail/prove_with.h"
#include "tetra/detail/turn_fields.h"

namespace innermap {
namespace {

constexpr std::size_t kBlock = 1024;
// Share of the cells: patches make short work of fewer, and a coarse mesh of none.
constexpr double kFewInverted = 1e-3;
constexpr int kTurns = 4;
constexpr int kInverseLattice = 64;

// A field of the name in the way gets another.
constexpr const char* kSourceField = "source";

class Remesher {
 public:
  Remesher(const CellMesh& given, const MappedSolid& mapped, const RemeshSettings& settings)
      : given_(given),
        mapped_(mapped),
        settings_(settings),
        own_(settings.back ? sourceSurface(mapped) : targetSurface(mapped)),
        surface_(settings.surface ? *settings.surface : own_),
        guide_(surface_.vertices, surface_.triangles),
        diagonal_(boundingBox(surface_).diagonal()) {}

  Remesh run() {
    CarriedCells cells = timed(out_.seconds, "carry",
                               [&] { return settings_.back ? broughtBack() : carried(given_); });
    const Points first = cells.positions;
    out_.invertedCarried = invertedCells(given_, cells.positions);
    if (!settings_.back && settings_.coarse > 0 &&
        static_cast<double>(out_.invertedCarried) > kFewInverted * cellCount())
      timed(out_.seconds, "coarse", [&] { startCoarse(cells); });
    CellMesh mesh;
    mesh.name = given_.name;
    mesh.vertices = given_.vertices;
    mesh.tetrahedra = given_.tetrahedra;
    mesh.hexahedra = given_.hexahedra;
    repairInTurns(mesh, cells);
    measureWays(first, cells.positions);
    finish(std::move(mesh), cells);
    return std::move(out_);
  }

 private:
  double cellCount() const {
    return static_cast<double>(given_.tetrahedra.size() + given_.hexahedra.size());
  }

  CarryCellsSettings carrySettings() const {
    CarryCellsSettings carrying;
    carrying.farthest = settings_.farthest;
    return carrying;
  }

  CarriedCells carried(const CellMesh& mesh) {
    CarriedCells cells = carryCells(mesh, mapped_, carrySettings()).cells;
    layOnSurface(cells);
    return cells;
  }

  // From the map's own surface onto the one given.
  void layOnSurface(CarriedCells& cells) const {
    if (!settings_.surface) return;
    parallelBlocks(cells.positions.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        if (cells.onSurface[v].triangle < 0) continue;
        const ClosestPoint at = guide_.closest(cells.positions[v]);
        cells.positions[v] = at.position;
        cells.onSurface[v] = at.address;
      }
    });
  }

  TetrahedralizeSettings fillSettings(int resolution) const {
    TetrahedralizeSettings filling;
    filling.resolution = resolution;
    filling.keepTopology = false;
    return filling;
  }

  CellRepair repaired(const CellMesh& mesh, const Mesh& surface, CarriedCells& cells) const {
    return repairCells(mesh, surface, cells);
  }

  CarriedCells broughtBack() {
    const CellMesh lattice = tetrahedralize(
        mapped_.solid(), fillSettings(settings_.coarse > 0 ? settings_.coarse : kInverseLattice));
    CarriedCells there = carryCells(lattice, mapped_, carrySettings()).cells;
    const CellRepair repair = repaired(lattice, targetSurface(mapped_), there);
    if (repair.invertedAfter > 0)
      out_.notes.push_back(
          fmt::format("{} of the {} tetrahedra for the inverse map stay inverted and are left out",
                      repair.invertedAfter, repair.cells));
    CarriedCells cells =
        carryCellsBack(given_, mapped_, {&lattice, &there.positions}, carrySettings()).cells;
    layOnSurface(cells);
    return cells;
  }

  void startCoarse(CarriedCells& cells) {
    std::optional<CoarseLevel> level;
    const auto most = static_cast<std::size_t>(cellCount()) + 4 * given_.hexahedra.size();
    for (int resolution = settings_.coarse; resolution <= 1024; resolution *= 2) {
      if (outOfTime()) break;
      CellMesh mesh = tetrahedralize(mapped_.solid(), fillSettings(resolution));
      if (3 * mesh.tetrahedra.size() > most) break;
      CarriedCells moved = carried(mesh);
      const Points before = moved.positions;
      std::size_t inverted = invertedCells(mesh, before);
      if (level) startFrom(*level, guide_, mesh, moved, inverted);
      repaired(mesh, surface_, moved);
      CellLocator locator(mesh.vertices, mesh.tetrahedra);
      Points ways(before.size());
      for (std::size_t v = 0; v < ways.size(); ++v) ways[v] = moved.positions[v] - before[v];
      level = CoarseLevel{std::move(mesh), std::move(locator), std::move(ways)};
    }
    std::size_t inverted = out_.invertedCarried;
    if (level) out_.fromCoarse = startFrom(*level, guide_, given_, cells, inverted);
  }

  // Better shapes let the boundary land, and what has landed is improved again.
  void repairInTurns(CellMesh& mesh, CarriedCells& cells) {
    origin_.resize(mesh.tetrahedra.size());
    for (std::size_t t = 0; t < origin_.size(); ++t) origin_[t] = static_cast<int>(t);
    std::size_t poor = mesh.tetrahedra.size();
    for (int turn = 0; turn < kTurns; ++turn) {
      const CellRepair repair =
          timed(out_.seconds, "repair", [&] { return repaired(mesh, surface_, cells); });
      if (turn == 0) {
        out_.repair = repair;
        out_.invertedAtRest = repair.invertedAtRest;
      }
      out_.repair.invertedAfter = repair.invertedAfter;
      out_.repair.poorAfter = repair.poorAfter;
      out_.repair.notLanded = repair.notLanded;
      out_.repair.farthestOff = repair.farthestOff;
      if (!mesh.hexahedra.empty() || outOfTime()) break;
      if (turn + 1 == kTurns && repair.invertedAfter == 0 && repair.notLanded == 0) break;
      const CellImprovement improved =
          timed(out_.seconds, "shapes", [&] { return improve(mesh, cells); });
      const bool landed = repair.invertedAfter == 0 && repair.notLanded == 0;
      if (landed && 5 * improved.poorAfter > 4 * std::min(poor, improved.poorBefore)) break;
      poor = improved.poorAfter;
    }
  }

  CellImprovement improve(CellMesh& mesh, CarriedCells& cells) {
    ImproveCellsSettings improving;
    improving.angle = settings_.angle;
    improving.connect = !settings_.keepConnectivity;
    CellImprovement improved = improveCells(mesh, surface_, cells, improving);
    out_.swaps += improved.swaps;
    out_.collapses += improved.collapses;
    for (int& origin : improved.origin) origin = origin_[origin];
    origin_ = std::move(improved.origin);
    return improved;
  }

  void measureWays(const Points& first, const Points& last) {
    double squares = 0;
    out_.repair.farthestMoved = 0;
    for (std::size_t v = 0; v < first.size(); ++v) {
      const double way = norm(last[v] - first[v]);
      squares += way * way;
      out_.repair.farthestMoved = std::max(out_.repair.farthestMoved, way);
    }
    out_.repair.moved = first.empty() ? 0 : std::sqrt(squares / static_cast<double>(first.size()));
  }

  // Vertices that cells used and do not use any more are left out.
  std::vector<int> keptVertices(const CellMesh& mesh) const {
    std::vector<char> before(mesh.vertices.size(), 0), after(mesh.vertices.size(), 0);
    for (const Tetrahedron& t : given_.tetrahedra)
      for (const int v : t) before[v] = 1;
    for (const Tetrahedron& t : mesh.tetrahedra)
      for (const int v : t) after[v] = 1;
    for (const Hexahedron& h : mesh.hexahedra)
      for (const int v : h) after[v] = 1;
    std::vector<int> kept;
    for (std::size_t v = 0; v < before.size(); ++v)
      if (after[v] || !before[v]) kept.push_back(static_cast<int>(v));
    return kept;
  }

  void finish(CellMesh mesh, const CarriedCells& cells) {
    out_.inverted = invertedCells(mesh, cells.positions);
    measureBoundary(mesh, cells);
    const std::vector<int> kept = keptVertices(mesh);
    std::vector<int> number(mesh.vertices.size(), -1);
    CellMesh& made = out_.mesh;
    made.name = given_.name;
    Points source;
    for (const int v : kept) {
      number[v] = static_cast<int>(made.vertices.size());
      made.vertices.push_back(cells.positions[v]);
      source.push_back(mesh.vertices[v]);
    }
    made.tetrahedra = std::move(mesh.tetrahedra);
    made.hexahedra = std::move(mesh.hexahedra);
    for (Tetrahedron& t : made.tetrahedra)
      for (int& v : t) v = number[v];
    for (Hexahedron& h : made.hexahedra)
      for (int& v : h) v = number[v];
    std::vector<int> rows = origin_;
    for (std::size_t h = 0; h < made.hexahedra.size(); ++h)
      rows.push_back(static_cast<int>(given_.tetrahedra.size() + h));
    turnFields(given_, kept, rows, source, made);
    timed(out_.seconds, "proof", [&] { prove(source); });
    addSource(source);
    out_.quality = cellQuality(made);
    setQualityFields(made, out_.quality);
    warn();
  }

  void prove(Points& source) {
    std::optional<CellBoundary> boundary;
    out_.proof = proveWith(out_.mesh, boundary);
    std::swap(out_.mesh.vertices, source);
    out_.sourceProof = proveWith(out_.mesh, boundary);
    std::swap(out_.mesh.vertices, source);
  }

  void addSource(const Points& source) {
    CellField field;
    field.name = kSourceField;
    field.components = 3;
    for (const Vec3& p : source) field.values.insert(field.values.end(), {p.x, p.y, p.z});
    auto& fields = out_.mesh.vertexFields;
    fields.erase(std::remove_if(fields.begin(), fields.end(),
                                [](const CellField& f) { return f.name == kSourceField; }),
                 fields.end());
    fields.push_back(std::move(field));
  }

  void measureBoundary(const CellMesh& mesh, const CarriedCells& cells) {
    std::vector<char> used(mesh.vertices.size(), 0);
    for (const Triangle& t : boundaryTriangles(mesh))
      for (const int v : t) used[v] = 1;
    std::vector<double> distances(used.size(), 0);
    parallelBlocks(used.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v)
        if (used[v]) distances[v] = guide_.closest(cells.positions[v]).distance / diagonal_;
    });
    double squares = 0, count = 0;
    for (std::size_t v = 0; v < used.size(); ++v) {
      squares += distances[v] * distances[v];
      count += used[v];
      out_.boundaryMax = std::max(out_.boundaryMax, distances[v]);
    }
    out_.boundaryRms = count > 0 ? std::sqrt(squares / count) : 0;
  }

  void warn() {
    if (out_.invertedAtRest > 0)
      out_.notes.push_back(
          fmt::format("{} cells of the input are inverted; remesh gives them regular shapes",
                      out_.invertedAtRest));
    if (out_.inverted > 0)
      out_.warnings.push_back(
          fmt::format("{} cells stay inverted; a finer mesh may help", out_.inverted));
    if (out_.repair.notLanded > 0)
      out_.warnings.push_back(fmt::format(
          "{} vertices of the boundary are off the surface, at most {:.2g} of its diagonal",
          out_.repair.notLanded, out_.repair.farthestOff / diagonal_));
  }

  const CellMesh& given_;
  const MappedSolid& mapped_;
  const RemeshSettings& settings_;
  const Mesh own_;
  const Mesh& surface_;
  const GuideSurface guide_;
  double diagonal_;
  std::vector<int> origin_;
  Remesh out_;
};

}  // namespace

Remesh remeshCells(const CellMesh& mesh, const MappedSolid& mapped,
                   const RemeshSettings& settings) {
  requireDescribed(settings);
  if (settings.coarse != 0 && settings.coarse < 8)
    throw SettingError("coarse", fmt::format("{} is neither 0 nor 8 to 256", settings.coarse));
  validate(mesh);
  return Remesher(mesh, mapped, settings).run();
}

std::uint64_t remeshMemory(const CellMesh& mesh) {
  // Measured, of a cell: 175 to 210, less in larger meshes.
  return 16'000'000 + 200 * mesh.tetrahedra.size() + 1500 * mesh.hexahedra.size();
}

std::vector<Setting> describe(RemeshSettings& s) {
  return {
      Setting(
          "back", &s.back,
          "bring cells that fill the map's target back to its source; SURFACE is then the source's")
          .rare(),
      Setting("keep_connectivity", &s.keepConnectivity,
              "only move vertices: cells and their numbers stay"),
      Setting("angle", "ANGLE", &s.angle,
              "improve tetrahedra with a dihedral angle below this, or as near to 180")
          .in("degrees")
          .from(1, 30)
          .rare(),
      Setting("coarse", "N", &s.coarse,
              "cells along the longest side of a coarse mesh, which remesh repairs first if many "
              "cells are inverted, and which with {back} stands for the inverse map; 0: none, or "
              "64 with {back}")
          .from(0, 256)
          .rare()};
}

}  // namespace innermap
