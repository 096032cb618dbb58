#include <fmt/format.h>
#include <openvdb/tools/ValueTransformer.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "evaluate/detail/cell_check.h"
#include "evaluate/detail/map_blocks.h"
#include "evaluate/detail/outside_voxels.h"
#include "evaluate/detail/proof_marks.h"
#include "innermap/core/error.h"
#include "innermap/evaluate/grids.h"
#include "innermap/field/field_file.h"
#include "innermap/levelset/level_set.h"
#include "levelset/level_set_settings.h"
#include "levelset/set_metadata.h"

namespace innermap {
namespace {

// What no target is needed for.
EvaluateSettings evaluateSettings(const MapGridSettings& settings) {
  EvaluateSettings out;
  out.lame = settings.lame;
  out.repairUpTo = settings.repair == RepairFolds::on          ? 1
                   : settings.repair == RepairFolds::automatic ? kRepairedFolds
                                                               : 0;
  return out;
}

EvaluateSettings onto(const TargetBoundary& target, const Solid& source, double accuracy,
                      EvaluateSettings settings) {
  settings.targetVolume = target.volume;
  settings.mirrored = orientationOf(source, target) < 0;
  settings.accuracy = accuracy;
  return settings;
}

constexpr double kTenth = 0.1;  // of the tolerance

using Figures = std::initializer_list<std::pair<const char*, double>>;

void insert(const openvdb::GridPtrVec& grids, const Figures& figures) {
  for (const openvdb::GridBase::Ptr& grid : grids)
    for (const auto& [key, value] : figures)
      setMetadata(*grid, std::string("innermap_") + key, openvdb::DoubleMetadata(value));
}

void insertTotals(const openvdb::GridPtrVec& grids, const MapGrids& values) {
  insert(grids, {{"harmonic_energy_total", values.harmonicTotal},
                 {"deformation_energy_total", values.deformationTotal},
                 {"jacobian_min", values.jacobianMin},
                 {"jacobian_max", values.jacobianMax},
                 {"folded_fraction", values.foldedFraction}});
  if (values.repaired) insert(grids, {{"repaired_farthest", values.repairedFarthest}});
}

// Of 99% of the boundary, world units of the target.
double boundaryErrorOf(const MappedSolid& mapped) {
  const double told = fitFacts(mapped.facts).error.p99;
  const double known = mapped.injectivity.boundaryError;
  return (known > 0 ? known : std::isfinite(told) ? told : 0) * mapped.boundary.target.diagonal;
}

void findOutside(const MappedSolid& mapped, const TargetShape& target, SolidGrids& out) {
  OutsideVoxelsSettings settings;
  settings.slack = boundaryErrorOf(mapped);
  settings.origin = out.localOrigin;
  out.outside = outsideVoxels(*out.values.map, *out.surface, target, settings);
  if (!out.outside) return;
  out.outsideFraction = static_cast<double>(out.outside->activeVoxelCount()) /
                        static_cast<double>(out.values.interiorVoxels);
}

// A product of folded steps has the sign of a map that is not, so that its determinant hides them.
void markProof(const ProofFigures& proof, SolidGrids& out) {
  out.undecided = markCells(proof.undecidedCells, *out.surface, "undecided");
  out.values.folded = markCells(proof.negativeCells, *out.surface, "folded", out.values.folded);
}

// What voxels and the cells between them tell, beside what is known of the map.
Injectivity injectivityOf(const MappedSolid& mapped, const SolidGrids& grids,
                          const TargetShape& target) {
  const MapGrids& values = grids.values;
  const double error = boundaryErrorOf(mapped);
  Injectivity out = mapped.injectivity;
  out.voxels.checked = values.interiorVoxels;
  out.voxels.least = target.orientation() < 0 ? -values.jacobianMax : values.jacobianMin;
  out.voxels.folded = values.foldedVoxelsLeft;
  out.repaired = values.foldedVoxels - values.foldedVoxelsLeft;
  const auto distance = grids.surface->getConstAccessor();
  const auto position = values.map->getConstAccessor();
  const Vec3& origin = grids.localOrigin;
  if (out.voxels.folded > 0)
    for (auto voxel = values.jacobian->cbeginValueOn(); voxel; ++voxel) {
      if (target.orientation() * *voxel > 0 || !(distance.getValue(voxel.getCoord()) < 0)) continue;
      const openvdb::Vec3f p = position.getValue(voxel.getCoord());
      if (target.runsThroughItself(origin + Vec3{p.x(), p.y(), p.z()}, error))
        ++out.voxels.foldedAtOverlap;
    }
  out.cells = checkCells(*values.map, *grids.surface, target, error, origin);
  out.cells.local = origin.x != 0 || origin.y != 0 || origin.z != 0;
  out.cells.share = static_cast<double>(out.cells.checked) / 6 * std::pow(grids.voxelSize, 3) /
                    mapped.solid().volume();
  return out;
}

// What the map was fitted to.
double toleranceOf(const MappedSolid& mapped) {
  const double tolerance = fitFacts(mapped.facts).tolerance.value_or(0);
  return tolerance > 0 ? tolerance : kUsualTolerance;
}

// Where floats hold the target's positions well enough, the origin; else a point near its middle
// that floats hold too.
Vec3 localOriginOf(const MappedSolid& mapped) {
  const Points& target = mapped.boundary.target.moved;
  if (!needsLocalMap(target, toleranceOf(mapped))) return {};
  Vec3 middle = boundingBox(target).center();
  for (int a = 0; a < 3; ++a) middle[a] = static_cast<double>(static_cast<float>(middle[a]));
  return middle;
}

// `map` less the origin becomes map_local, and absolute again.
void splitMap(const MappedSolid& mapped, SolidGrids& grids) {
  grids.mapRounding = grids.values.rounding / mapped.boundary.target.diagonal;
  const Vec3 o = grids.localOrigin;
  if (o.x == 0 && o.y == 0 && o.z == 0) return;
  const double tolerance = toleranceOf(mapped);
  if (grids.mapRounding > kTenth * tolerance)
    grids.warnings.push_back(fmt::format(
        "so far from the origin the floats of the grid 'map' hold positions to {:.2g} of the "
        "target's diagonal only ({:.4g} world units), over a tenth of the tolerance of {:g}; take "
        "'map_local', positions less its metadata innermap_map_local_origin, or move both meshes "
        "nearer to the origin",
        grids.mapRounding, grids.values.rounding, tolerance));
  grids.mapLocal = grids.values.map;
  grids.values.map = grids.mapLocal->deepCopy();
  grids.mapLocal->setName("map_local");
  const openvdb::Vec3d origin(o.x, o.y, o.z);
  openvdb::tools::foreach (grids.values.map->beginValueOn(), [&](const auto& voxel) {
    voxel.setValue(openvdb::Vec3f(openvdb::Vec3d(*voxel) + origin));
  });
}

void insertStatement(const openvdb::GridPtrVec& grids, const Injectivity& known) {
  for (const openvdb::GridBase::Ptr& grid : grids)
    setMetadata(*grid, "innermap_one_to_one", openvdb::StringMetadata(injectivityStatement(known)));
}

// Of a map that the grid was made with before.
void dropCertificate(openvdb::MetaMap& map) {
  std::vector<std::string> names;
  for (auto meta = map.beginMeta(); meta != map.endMeta(); ++meta)
    for (const std::string_view begin : {"innermap_boundary_error", "innermap_one_to_one"})
      if (std::string_view(meta->first).substr(0, begin.size()) == begin)
        names.push_back(meta->first);
  for (const std::string& name : names) map.removeMeta(name);
}

}  // namespace

openvdb::GridPtrVec SolidGrids::all() const {
  openvdb::GridPtrVec out{surface, density};
  for (const openvdb::GridBase::Ptr& grid : values.all()) out.push_back(grid);
  if (undecided) out.push_back(undecided);
  if (outside) out.push_back(outside);
  if (mapLocal) out.push_back(mapLocal);
  return out;
}

namespace {

EvaluateSettings evaluateSettings(const MappedSolid& mapped, const MapGridSettings& settings) {
  EvaluateSettings out =
      onto(mapped.boundary.target, mapped.solid(), sumAccuracy(mapped), evaluateSettings(settings));
  out.origin = localOriginOf(mapped);
  return out;
}

// All that takes the whole of a level set and of its voxels' values. out: with the surface.
SolidGrids conclude(const MappedSolid& mapped, const MapGridSettings& settings, SolidGrids out,
                    const std::function<MapValues(const EvaluateSettings&)>& values) {
  const Solid& solid = mapped.solid();
  const std::string note = voxelSizeNote(solid, levelSetSettings(settings));
  if (!note.empty()) out.notes.push_back(note);
  timed(out.seconds, "voxelize", [&] {
    out.density = makeFog(*out.surface);
    out.warnings = checkLevelSet(*out.surface, solid).warnings;
  });
  requireInterior(interiorVoxels(*out.surface), solid, mapped.boundary.source.mesh.name);
  timed(out.seconds, "evaluate", [&] {
    const EvaluateSettings evaluate = evaluateSettings(mapped, settings);
    out.localOrigin = evaluate.origin;
    out.values = concludeValues(mapped.map, solid, *out.surface, evaluate, values(evaluate));
  });
  out.voxelSize = out.surface->voxelSize()[0];
  const TargetShape target(mapped.boundary);
  timed(out.seconds, "outside", [&] { findOutside(mapped, target, out); });
  out.injectivity = timed(out.seconds, "cells", [&] {
    markProof(mapped.injectivity.proof, out);
    return injectivityOf(mapped, out, target);
  });
  splitMap(mapped, out);
  const openvdb::GridPtrVec all = out.all();
  if (out.mapLocal)
    out.mapLocal->insertMeta(
        "innermap_map_local_origin",
        openvdb::Vec3DMetadata({out.localOrigin.x, out.localOrigin.y, out.localOrigin.z}));
  insert(all, {{"map_rounding", out.mapRounding}, {"outside_fraction", out.outsideFraction}});
  describeMap(all, mapped);
  insertStatement(all, out.injectivity);
  insertTotals(all, out.values);
  insert(all, {{"lame_lambda", settings.lame.lambda}, {"lame_mu", settings.lame.mu}});
  return out;
}

}  // namespace

SolidGrids evaluateOnGrid(const MappedSolid& mapped, const MapGridSettings& settings) {
  SolidGrids out;
  timed(out.seconds, "voxelize",
        [&] { out.surface = makeLevelSet(mapped.solid(), levelSetSettings(settings)); });
  const openvdb::FloatGrid::Ptr surface = out.surface;
  return conclude(mapped, settings, std::move(out), [&](const EvaluateSettings& evaluate) {
    return mapValues(mapped.map, mapped.solid(), *surface, evaluate);
  });
}

GridBlock evaluateBlock(const MappedSolid& mapped, const MapGridSettings& settings,
                        const openvdb::Coord& origin) {
  const openvdb::FloatGrid::Ptr surface =
      makeLevelSetBlock(mapped.solid(), levelSetSettings(settings), origin);
  const MapValues values =
      mapValues(mapped.map, mapped.solid(), *surface, evaluateSettings(mapped, settings));
  GridBlock out{values.grids.all(), {}};
  out.grids.insert(out.grids.begin(), surface);
  out.totals = totalsOf(values.blocks.empty() ? BlockTotals{origin, {}} : values.blocks.front());
  return out;
}

SolidGrids joinBlocks(const MappedSolid& mapped, const MapGridSettings& settings,
                      std::vector<GridBlock> blocks) {
  SolidGrids out;
  MapValues values = timed(out.seconds, "join", [&] {
    const auto transform =
        transformFor(mapped.solid(), voxelSizeFor(mapped.solid(), levelSetSettings(settings)));
    return mergeBlocks(std::move(blocks), transform, out.surface);
  });
  return conclude(mapped, settings, std::move(out),
                  [&](const EvaluateSettings&) { return std::move(values); });
}

bool needsLocalMap(const Points& target, double tolerance) {
  constexpr double kHalfUnit = 1.0 / (1 << 24);
  const Box3 box = boundingBox(target);
  const Vec3 far{std::max(std::abs(box.lower.x), std::abs(box.upper.x)),
                 std::max(std::abs(box.lower.y), std::abs(box.upper.y)),
                 std::max(std::abs(box.lower.z), std::abs(box.upper.z))};
  return kHalfUnit * norm(far) > kTenth * tolerance * box.diagonal();
}

MapGridKind mapGridKind(const MappedSolid& mapped) {
  return {mapped.map.steps().size(),
          needsLocalMap(mapped.boundary.target.moved, toleranceOf(mapped))};
}

std::uint64_t mapGridMemory(const Solid& solid, const MapGridSettings& settings,
                            const MapGridKind& kind) {
  // Leaves of 8^3 voxels are allocated whole: along the surface they reach about 6 voxels to either
  // side. Map, Jacobian, two energies, masks; map_local is one more.
  constexpr double kReach = 12, kVoxel = 26, kLocal = 13, kLeaf = 512;
  // Bytes that FieldRegion keeps to a voxel's area of the surface: two voxels of the skin, one cut.
  constexpr double kPlan = 160;
  // Measured, bytes: what the first of several steps gives, for as many leaves as are evaluated
  // together (visit_field.cc); the boundary of the cells, a face, where overlaps are looked for and
  // beyond (cell_check.cc); anything else.
  constexpr double kBetweenSteps = 200e3, kTogether = 1024, kFace = 500, kMostFaces = 550e3,
                   kBeyond = 100, kOther = 20e6;
  const LevelSetSettings levelSet = levelSetSettings(settings);
  const double voxel = voxelSizeFor(solid, levelSet), area = solid.area() / (voxel * voxel);
  const double voxels = solid.volume() / std::pow(voxel, 3) + kReach * area;
  const double between = kind.steps > 1 ? kBetweenSteps * std::min(kTogether, voxels / kLeaf) : 0;
  // Two triangles of a cell's side, of which a surface has one and a half to a square on average.
  const double faces = 3 * area;
  const double rest = kind.frame ? kPlan * area : (faces < kMostFaces ? kFace : kBeyond) * faces;
  // The density is a second level set.
  return 2 * levelSetMemory(solid, levelSet) +
         static_cast<std::uint64_t>((kVoxel + (kind.local ? kLocal : 0)) * voxels +
                                    std::max(between, rest) + kOther);
}

std::uint64_t mapBlockMemory(const MapGridKind& kind) {
  constexpr std::uint64_t kBlock = 350'000'000, kSteps = 250'000'000;
  return kBlock + (kind.steps > 1 ? kSteps : 0);
}

void describeMap(const openvdb::GridPtrVec& grids, const MappedSolid& mapped) {
  const Facts figures = injectivityFacts(mapped.injectivity);  // the statement says them
  for (const openvdb::GridBase::Ptr& grid : grids)
    for (const auto& fact : mapped.facts)
      if (std::find(figures.begin(), figures.end(), fact) == figures.end())
        setMetadata(*grid, "innermap_" + fact.first, openvdb::StringMetadata(fact.second));
  insertStatement(grids, mapped.injectivity);
}

FrameEvaluator::FrameEvaluator(const FrameFitter& fitter, std::vector<std::string> names,
                               const MapGridSettings& settings)
    : fitter_(fitter), names_(std::move(names)), evaluate_(evaluateSettings(settings)) {
  for (const std::string& name : names_)
    if (std::find(mapGridNames().begin(), mapGridNames().end(), name) == mapGridNames().end())
      throw SettingError(
          "grids", fmt::format("'{}' is not one of {}", name, fmt::join(mapGridNames(), ", ")));
  if (settings.repair != RepairFolds::on) evaluate_.repairUpTo = 0;
  evaluate_.map = wants("map");
  evaluate_.jacobian = wants("jacobian");
  evaluate_.harmonicEnergy = wants("harmonic_energy");
  evaluate_.deformationEnergy = wants("deformation_energy");
  timed(seconds_, "voxelize", [&] {
    surface_ = makeLevelSet(fitter.solid(), levelSetSettings(settings));
    if (wants("density")) density_ = makeFog(*surface_);
    warnings_ = checkLevelSet(*surface_, fitter.solid()).warnings;
  });
  requireInterior(interiorVoxels(*surface_), fitter.solid(), fitter.rest().mesh.name);
  timed(seconds_, "voxelize", [&] {
    mask_ = mapRegion(*surface_, evaluate_);
    region_ = std::make_shared<FieldRegion>(fitter.solid(), *surface_, *mask_);
    region_->keepPlans();
  });
}

bool FrameEvaluator::wants(const char* name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

MapGrids FrameEvaluator::evaluate(const FrameFit& fit) const {
  return evaluateMap(HarmonicMap(fit.field), *region_,
                     onto(fit.boundary, fitter_.solid(), sumAccuracy(fit.error.rms), evaluate_));
}

openvdb::GridPtrVec FrameEvaluator::grids(const NumberedFit& frame, const MapGrids& values) const {
  openvdb::GridPtrVec all = values.all(), out;
  all.push_back(surface_);
  if (density_) all.push_back(density_);
  for (const std::string& name : names_)
    for (const openvdb::GridBase::Ptr& grid : all)
      if (grid->getName() == name) out.push_back(grid->copyGrid());  // the voxels are shared
  describeFrame(out, frame);
  insertTotals(out, values);
  return out;
}

const std::vector<std::string>& mapGridNames() {
  static const std::vector<std::string> names{"surface",  "density",         "map",
                                              "jacobian", "harmonic_energy", "deformation_energy"};
  return names;
}

void describeFrame(const openvdb::GridPtrVec& grids, const NumberedFit& frame) {
  for (const openvdb::GridBase::Ptr& grid : grids) {
    dropCertificate(*grid);
    setMetadata(*grid, "innermap_frame", openvdb::Int64Metadata(frame.number));
  }
  const BoundaryError& error = frame.fit->error;
  insert(grids, {{"boundary_error_rms", error.rms},
                 {"boundary_error_p99", error.p99},
                 {"boundary_error_max", error.max},
                 {"boundary_error_bound", error.bound}});
}

Setting repairSetting(RepairFolds* repair) {
  return Setting("repair", "WHEN",
                 choiceOf<RepairFolds>(repair, {{"auto", RepairFolds::automatic},
                                                {"on", RepairFolds::on},
                                                {"off", RepairFolds::off}}),
                 fmt::format("move folded voxels until the grids do not fold; the grid `repaired` "
                             "says how far. auto: if at most {:g}% of the voxels fold",
                             100 * kRepairedFolds))
      .rare();
}

}  // namespace innermap
