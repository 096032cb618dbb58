#include "innermap/texture/solid_texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/fit/surface_problem.h"
#include "innermap/levelset/level_set.h"
#include "levelset/level_set_settings.h"
#include "texture/detail/continuation.h"
#include "texture/detail/surface_texture.h"
#include "texture/detail/texture_figures.h"
#include "texture/detail/texture_grids.h"

namespace innermap {

struct SolidTexturePlan::Parts {
  SolidTextureSettings settings;
  Mesh mesh;
  std::optional<Solid> solid;
  std::optional<UvCharts> charts;
  std::optional<UvGroups> groups;
};

namespace {

constexpr double kVoxelsPerCharge = 2;  // along a side: what is finer, the surface itself gives
constexpr double kFewestCharges = 1000, kMostCharges = 50000;
constexpr double kPointsPerSource = 3;
constexpr std::size_t kHeldOut = 1000;
constexpr int kMostGroups = 16;
constexpr double kSumAccuracy = 1e-5;  // of colours and texture coordinates

bool usesImage(const SolidTextureSettings& s) { return s.mode != TextureMode::vertexColours; }

void check(const SolidTextureSettings& s, const Mesh& mesh) {
  if (s.seams == TextureSeams::blend && s.mode != TextureMode::coordinates)
    throw SettingError("seams", "are blended with continued coordinates only; colours show none");
  requireDescribed(s);
  if (!usesImage(s) && mesh.colours.empty())
    throw DataError(mesh.name +
                    ": has no vertex colours; give an image for its texture coordinates");
  if (usesImage(s) && mesh.uvTriangles.empty())
    throw DataError(mesh.name +
                    ": has no texture coordinates to look an image up with; unwrap it and save it "
                    "with its UVs");
}

std::size_t chargesFor(const Solid& solid, double voxel) {
  const double side = kVoxelsPerCharge * voxel;
  return static_cast<std::size_t>(
      std::clamp(std::round(solid.area() / (side * side)), kFewestCharges, kMostCharges));
}

std::size_t collocationFor(std::size_t sources) {
  return static_cast<std::size_t>(kPointsPerSource * static_cast<double>(sources)) + 16;
}

std::uint64_t memoryOf(const SolidTexturePlan& plan) {
  const SolidTexturePlan::Parts& parts = *plan.parts;
  const SolidTextureSettings& s = parts.settings;
  const std::uint64_t channels = s.mode == TextureMode::imageColours ? 6
                                 : parts.groups
                                     ? 3 * static_cast<std::uint64_t>(parts.groups->count)
                                     : 3;
  const double voxels = parts.solid->volume() / std::pow(plan.voxelSize, 3) +
                        12 * parts.solid->area() / (plan.voxelSize * plan.voxelSize);
  const auto grids =
      static_cast<std::uint64_t>((30.0 + 4.0 * static_cast<double>(channels)) * voxels);
  const std::size_t collocation = collocationFor(plan.sources);
  const std::uint64_t fit = fitMemory(collocation, plan.sources, kHeldOut, FitSolver::iterative) +
                            80 * channels * collocation;
  constexpr std::uint64_t kOther = 20'000'000;  // measured
  return kOther + std::max(fit, levelSetMemory(*parts.solid, levelSetSettings(s)) + grids);
}

void findCharts(SolidTexturePlan::Parts& parts, SolidTexturePlan& plan) {
  parts.charts = uvCharts(parts.mesh);
  if (parts.settings.seams != TextureSeams::blend) return;
  UvGroupSettings grouping;
  grouping.most = kMostGroups;
  parts.groups = uvGroups(parts.mesh, *parts.charts, grouping);
  plan.pieces = parts.groups->pieces;
  plan.groups = parts.groups->count;
  if (parts.groups->unresolvedLength > 0)
    plan.warnings.push_back(fmt::format(
        "{}: along {:.2g}% of the seams' length both sides share a field and are not blended",
        parts.mesh.name, 100 * parts.groups->unresolvedLength / parts.charts->seamLength));
}

// One solid texture being made.
class Maker {
 public:
  Maker(const SolidTexturePlan& plan, const TextureLookup& image)
      : plan_(plan),
        parts_(*plan.parts),
        settings_(parts_.settings),
        solid_(*parts_.solid),
        image_(image),
        surface_(surfaceTexture()) {}

  SolidTexture run() {
    out_.voxelSize = plan_.voxelSize;
    if (const double share = surface_.bearingShare(); share < 1 - 1e-9)
      out_.notes.push_back(
          fmt::format("{}: {:.3g}% of the surface has no texture coordinates and takes those of "
                      "the nearest point that has",
                      parts_.mesh.name, 100 * (1 - share)));
    const HarmonicField field = fit();
    timed("voxelize", [&] { voxelize(); });
    std::vector<openvdb::Vec3fGrid::Ptr> continued;
    timed("continue", [&] { continued = continueField(field); });
    timed("texture", [&] { colour(std::move(continued)); });
    timed("figures", [&] { measure(); });
    for (const openvdb::GridBase::Ptr& grid : out_.grids()) describe(*grid);
    return std::move(out_);
  }

 private:
  template <class Body>
  void timed(const char* stage, const Body& body) {
    innermap::timed(out_.seconds, stage, body);
  }

  SurfaceTexture surfaceTexture() const {
    if (!usesImage(settings_)) return {solid_, parts_.mesh, settings_.decode};
    const TextureKind kind = settings_.mode == TextureMode::imageColours ? TextureKind::colours
                             : parts_.groups                             ? TextureKind::groups
                                                                         : TextureKind::coordinates;
    return {solid_, parts_.mesh, kind, image_, parts_.groups};
  }

  double spacingOf(std::size_t points) const {
    return std::sqrt(solid_.area() / static_cast<double>(points));
  }

  HarmonicField fit() {
    SurfaceProblemSettings sample;
    sample.collocation = collocationFor(plan_.sources);
    sample.heldOut = kHeldOut;
    sample.seed = settings_.seed;
    const SurfaceValues values = [&](const std::vector<SurfacePoint>& points) {
      return surface_.values(points, spacingOf(sample.collocation));
    };
    FitProblem problem;
    timed("sample", [&] { problem = surfaceProblem(solid_, values, sample); });
    FitSettings settings;
    settings.sources = plan_.sources;
    settings.solver = FitSolver::iterative;
    settings.interpolation = Interpolation::linear;
    std::optional<FitResult> result;
    timed("fit", [&] { result.emplace(fitField(problem, settings)); });
    out_.fit.sources = result->field.sources().size();
    out_.fit.collocation = problem.surface.points.size();
    out_.fit.channels = surface_.channels();
    out_.fit.distance = result->distance;
    out_.fit.residuals = result->residuals;
    timed("certificate", [&] { out_.fit.error = errorOf(result->field, values); });
    return result->field;
  }

  // Of continued colours, those alone: not of the coordinates beside them.
  BoundaryError errorOf(const HarmonicField& field, const SurfaceValues& values) const {
    FreshSampleSettings fresh;
    fresh.seed = settings_.seed;
    const BoundarySamples samples = freshSamples(solid_, values, fresh);
    EvaluateFieldSettings sums;
    sums.accuracy = kSumAccuracy;
    const Matrix found = field.evaluate(samples.points, sums).values;
    const std::size_t counted =
        settings_.mode == TextureMode::coordinates ? surface_.channels() : 3;
    std::vector<double> errors(samples.points.size(), 0.0);
    for (std::size_t i = 0; i < errors.size(); ++i) {
      for (std::size_t k = 0; k < counted; ++k)
        errors[i] += std::pow(found(i, k) - samples.values(i, k), 2);
      errors[i] = std::sqrt(errors[i]);
    }
    return summarizeErrors(std::move(errors));
  }

  void voxelize() {
    out_.surface = makeLevelSet(solid_, levelSetSettings(settings_));
    out_.density = makeFog(*out_.surface);
    out_.warnings = checkLevelSet(*out_.surface, solid_).warnings;
    out_.interiorVoxels = interiorVoxels(*out_.surface);
    requireInterior(out_.interiorVoxels, solid_, parts_.mesh.name);
  }

  std::vector<openvdb::Vec3fGrid::Ptr> continueField(const HarmonicField& field) const {
    ContinuationSettings settings;
    settings.spacing = spacingOf(plan_.sources);
    settings.accuracy = kSumAccuracy;
    const BoundaryValues boundary = [&](const Solid::Closest& at, double* values) {
      surface_.values(at.onSurface, plan_.voxelSize, values);
    };
    return continueInside(field, solid_, *out_.surface, boundary, settings);
  }

  void colour(std::vector<openvdb::Vec3fGrid::Ptr> continued) {
    if (settings_.mode != TextureMode::coordinates) {
      out_.colour = continued[0];
      if (continued.size() > 1) out_.uv = continued[1];
    } else if (parts_.groups) {
      std::vector<ChartGroupGrid> groups;
      const std::vector<Vec2> centres = surface_.groupCentres();
      for (std::size_t g = 0; g < continued.size(); ++g)
        groups.push_back({std::move(continued[g]), centres[g]});
      const BlendedTexture blended = blendChartGroups(groups, image_);
      out_.colour = blended.colour;
      out_.uv = blended.uv;
    } else {
      out_.uv = continued[0];
      out_.colour = lookUpColours(*out_.uv, image_);
    }
    out_.colour->setName("Cd");
    if (out_.uv) out_.uv->setName("uv");
  }

  void measure() {
    std::vector<Segment> seams;
    if (parts_.charts) {
      seams = segmentsOf(parts_.mesh, parts_.charts->seams);
      out_.seams = seamFigures(*parts_.charts, seams);
    }
    const ColourErrors errors =
        colourErrors(solid_, seams, surface_, *out_.colour, settings_.seed + 1);
    out_.colourError = errors.all;
    out_.colourErrorAtSeams = errors.atSeams;
  }

  SeamFigures seamFigures(const UvCharts& charts, const std::vector<Segment>& seams) const {
    const double voxel = out_.surface->voxelSize()[0];
    SeamFigures f;
    f.charts = charts.count;
    f.edges = charts.seams.size();
    f.length = charts.seamLength;
    if (charts.edgeLength > 0) f.lengthShare = charts.seamLength / charts.edgeLength;
    f.voxelShare = static_cast<double>(voxelsAlong(seams, *out_.surface)) /
                   static_cast<double>(out_.interiorVoxels);
    f.areaShare = areaShareAlong(seams, solid_, voxel);
    f.colourDifference = seamDifferences(parts_.mesh, charts, surface_, voxel);
    return f;
  }

  void describe(openvdb::GridBase& grid) const {
    const auto text = [&](const char* key, const std::string& value) {
      grid.insertMeta(key, openvdb::StringMetadata(value));
    };
    const bool byCoordinates = settings_.mode == TextureMode::coordinates;
    text("innermap_source", parts_.mesh.name);
    text("innermap_texture_mode", byCoordinates ? "uv" : "colour");
    if (byCoordinates) text("innermap_texture_seams", parts_.groups ? "blend" : "keep");
    text("innermap_colour_space", "linear");
    grid.insertMeta("innermap_sources",
                    openvdb::Int64Metadata(static_cast<std::int64_t>(plan_.sources)));
  }

  const SolidTexturePlan& plan_;
  const SolidTexturePlan::Parts& parts_;
  const SolidTextureSettings& settings_;
  const Solid& solid_;
  const TextureLookup& image_;
  SurfaceTexture surface_;
  SolidTexture out_;
};

}  // namespace

const Mesh& SolidTexturePlan::mesh() const { return parts->mesh; }

openvdb::GridPtrVec SolidTexture::grids() const {
  openvdb::GridPtrVec all;
  for (const openvdb::GridBase::Ptr& grid :
       {openvdb::GridBase::Ptr(surface), openvdb::GridBase::Ptr(density),
        openvdb::GridBase::Ptr(colour), openvdb::GridBase::Ptr(uv)})
    if (grid) all.push_back(grid);
  return all;
}

SolidTexturePlan planSolidTexture(Mesh mesh, const SolidTextureSettings& settings) {
  check(settings, mesh);
  SolidTexturePlan plan;
  auto parts = std::make_shared<SolidTexturePlan::Parts>();
  parts->settings = settings;
  parts->mesh = std::move(mesh);
  timed(plan.seconds, "solid", [&] {
    SolidSettings solid;
    parts->solid.emplace(parts->mesh, solid);
  });
  for (const std::string& note : parts->solid->repaired().notes)
    plan.notes.push_back(parts->mesh.name + ": " + note);
  const LevelSetSettings levelSet = levelSetSettings(settings);
  plan.voxelSize = voxelSizeFor(*parts->solid, levelSet);
  if (const std::string note = voxelSizeNote(*parts->solid, levelSet); !note.empty())
    plan.notes.push_back(note);
  plan.sources =
      settings.sources > 0 ? settings.sources : chargesFor(*parts->solid, plan.voxelSize);
  if (usesImage(settings)) timed(plan.seconds, "charts", [&] { findCharts(*parts, plan); });
  plan.parts = std::move(parts);
  plan.memory = memoryOf(plan);
  return plan;
}

SolidTexture makeSolidTexture(const SolidTexturePlan& plan, const TextureLookup& image) {
  const SolidTextureSettings& settings = plan.parts->settings;
  if (usesImage(settings) && !image) throw SettingError("image", "is missing; give a lookup");
  requireMemory("the solid texture", plan.memory,
                "use larger voxels, fewer charges or raise the limit");
  return Maker(plan, image).run();
}

SolidTexture makeSolidTexture(const Mesh& mesh, const TextureLookup& image,
                              const SolidTextureSettings& settings) {
  SolidTexturePlan plan = planSolidTexture(mesh, settings);
  SolidTexture out = makeSolidTexture(plan, image);
  out.notes.insert(out.notes.begin(), plan.notes.begin(), plan.notes.end());
  out.warnings.insert(out.warnings.begin(), plan.warnings.begin(), plan.warnings.end());
  addSeconds(plan.seconds, out.seconds);
  out.seconds = std::move(plan.seconds);
  return out;
}

std::vector<Setting> describe(SolidTextureSettings& s) {
  return {
      Setting("mode", "MODE",
              choiceOf<TextureMode>(&s.mode, {{"uv", TextureMode::coordinates},
                                              {"colour", TextureMode::imageColours}}),
              "uv: continue the texture coordinates and look up the image at each voxel; colour: "
              "continue the colours themselves"),
      Setting("seams", "WAY",
              choiceOf<TextureSeams>(
                  &s.seams, {{"keep", TextureSeams::keep}, {"blend", TextureSeams::blend}}),
              "for {mode} uv. keep: continue the coordinates as they are, which sweep through the "
              "image below a seam; blend: continue each chart by itself and mix their colours"),
      Setting("charges", "N", &s.sources, "number of charges")
          .was("sources")
          .from(100, 1e6)
          .otherwise(0, "one every two voxels of the surface, 1000 to 50000")
          .rare(),
      seedSetting(&s.seed)};
}

}  // namespace innermap
