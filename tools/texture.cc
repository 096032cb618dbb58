// `innermap texture`: a surface's texture continued into its solid.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "boundary_samples.h"
#include "commands.h"
#include "innermap/core/memory.h"
#include "innermap/field/boundary_error.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/levelset/level_set.h"
#include "innermap/mesh/read.h"
#include "innermap/texture/continuation.h"
#include "texture_images.h"
#include "texture_seams.h"
#include "texture_surface.h"

namespace innermap::tool {
namespace {

constexpr double kBand = 3;             // voxels: the skin of 2 and one more for interpolation
constexpr double kVoxelsPerCharge = 2;  // along a side: what is finer, the surface itself gives
constexpr double kFewestCharges = 1000, kMostCharges = 50000;
constexpr double kPointsPerSource = 3;
constexpr int kMostGroups = 16;
constexpr double kSumAccuracy = 1e-5;  // of colours and texture coordinates

struct TextureOptions {
  std::string mesh, image, output, mode = "uv", seams = "keep", colourSpace = "auto",
                                   wrap = "repeat", names = "innermap";
  std::optional<std::uint64_t> sources;
  int resolution = LevelSetSettings().resolution;
  std::optional<double> voxelSize;
  std::uint64_t seed = 1;

  bool colours() const { return mode != "uv" || image.empty(); }
  bool blends() const { return seams == "blend"; }
};

// What the command works on; the rest refers to it.
struct Job {
  const TextureOptions& options;
  Context& context;
  Mesh mesh;
  std::optional<Solid> solid;
  std::optional<UvCharts> charts;
  std::optional<UvGroups> groups;
  std::optional<TextureImages> images;
  std::optional<TextureSurface> surface;
  double voxel = 0;
  PointCounts counts;
};

LevelSetSettings levelSetSettings(const TextureOptions& options, Context& context) {
  LevelSetSettings s;
  s.resolution = options.resolution;
  s.voxelSize = options.voxelSize.value_or(0);
  s.halfWidth = kBand;
  s.maxMemory = context.maxMemory();
  s.progress = context.progress();
  return s;
}

double spacingOf(const Job& job, std::size_t points) {
  return std::sqrt(job.solid->area() / static_cast<double>(points));
}

void readInput(Job& job) {
  const TextureOptions& o = job.options;
  Context& context = job.context;
  context.timed("read", [&] {
    ReadSettings settings;
    settings.progress = context.progress();
    job.mesh = readMesh(o.mesh, settings);
  });
  if (o.image.empty() && job.mesh.colours.empty())
    throw DataError(o.mesh + ": has no vertex colours; give an IMAGE for its texture coordinates");
  if (!o.image.empty() && job.mesh.uvTriangles.empty())
    throw DataError(o.mesh + ": has no texture coordinates to look " + o.image +
                    " up with; unwrap it and save it with its UVs");
  context.timed("solid", [&] {
    SolidSettings settings;
    settings.progress = context.progress();
    job.solid.emplace(job.mesh, settings);
  });
  for (const std::string& note : job.solid->repaired().notes) context.note(o.mesh + ": " + note);
  job.voxel = voxelSizeFor(*job.solid, levelSetSettings(o, context));
  const double side = kVoxelsPerCharge * job.voxel;
  job.counts.sources = o.sources.value_or(static_cast<std::uint64_t>(
      std::clamp(std::round(job.solid->area() / (side * side)), kFewestCharges, kMostCharges)));
  job.counts.collocation =
      static_cast<std::size_t>(kPointsPerSource * static_cast<double>(job.counts.sources)) + 16;
  job.counts.heldOut = 1000;
}

void findCharts(Job& job) {
  if (job.options.image.empty()) return;
  Context& context = job.context;
  context.timed("charts", [&] { job.charts = uvCharts(job.mesh, context.progress()); });
  if (!job.options.blends()) return;
  context.timed("charts", [&] {
    job.groups = uvGroups(job.mesh, *job.charts, kMostGroups, context.progress());
  });
  context.report().set("seams.pieces", static_cast<std::int64_t>(job.groups->pieces));
  context.report().set("seams.groups", static_cast<std::int64_t>(job.groups->count));
  if (job.groups->unresolvedLength > 0)
    context.warning(fmt::format(
        "{}: along {:.2g}% of the seams' length both sides share a field and are not blended",
        job.mesh.name, 100 * job.groups->unresolvedLength / job.charts->seamLength));
}

TextureImageOptions imageOptions(const TextureOptions& o) {
  return {o.image, parseColourSpace("--colour-space", o.colourSpace), parseWrap("--wrap", o.wrap)};
}

// Peak need in bytes: the image beside what follows it.
std::uint64_t memoryOf(const Job& job) {
  const TextureOptions& o = job.options;
  const std::uint64_t channels = o.image.empty() ? 3
                                 : o.colours()   ? 6
                                 : job.groups    ? 3 * static_cast<std::uint64_t>(job.groups->count)
                                                 : 3;
  const LevelSetSettings settings = levelSetSettings(o, job.context);
  const double voxels = job.solid->volume() / std::pow(job.voxel, 3) +
                        12 * job.solid->area() / (job.voxel * job.voxel);
  const auto grids =
      static_cast<std::uint64_t>((33.0 + 4.0 * static_cast<double>(channels)) * voxels);
  const std::uint64_t fit = fitMemory(job.counts.collocation, job.counts.sources,
                                      job.counts.heldOut, FitSolver::iterative) +
                            80 * channels * job.counts.collocation;
  const std::uint64_t image = o.image.empty() ? 0 : textureImageMemory(imageOptions(o), job.mesh);
  return image + std::max(fit, levelSetMemory(*job.solid, settings) + grids);
}

void readTexture(Job& job) {
  const TextureOptions& o = job.options;
  Context& context = job.context;
  if (o.image.empty()) {
    TextureSurface::Decoding decode;
    if (o.colourSpace == "srgb") decode = linearFromSrgb;
    job.surface.emplace(*job.solid, job.mesh, decode);
    return;
  }
  context.timed("image", [&] { job.images.emplace(imageOptions(o), job.mesh, context); });
  const TextureLookup lookup = [images = &*job.images](const Vec2& uv, const Vec2& a,
                                                       const Vec2& b) {
    return images->at(uv, a, b);
  };
  const TextureKind kind = o.colours()  ? TextureKind::colours
                           : o.blends() ? TextureKind::groups
                                        : TextureKind::coordinates;
  job.surface.emplace(*job.solid, job.mesh, kind, lookup, job.groups);
  if (const double share = job.surface->bearingShare(); share < 1 - 1e-9)
    context.note(
        fmt::format("{}: {:.3g}% of the surface has no texture coordinates and takes those "
                    "of the nearest point that has",
                    o.mesh, 100 * (1 - share)));
}

// Over the first channels.
std::vector<double> errorsOf(const HarmonicField& field, const BoundarySamples& samples,
                             std::size_t channels, Progress* progress) {
  const Matrix found = field.evaluate(samples.points, kSumAccuracy, false, progress).values;
  std::vector<double> squares(samples.points.size(), 0.0);
  for (std::size_t k = 0; k < channels; ++k)
    for (std::size_t i = 0; i < squares.size(); ++i)
      squares[i] += std::pow(found(i, k) - samples.values(i, k), 2);
  for (double& s : squares) s = std::sqrt(s);
  return squares;
}

HarmonicField fit(const Job& job) {
  Context& context = job.context;
  const double apart = spacingOf(job, job.counts.collocation);
  const ValuesOf values = [&](const std::vector<SurfacePoint>& points) {
    return job.surface->values(points, apart);
  };
  FitProblem problem;
  context.timed("sample", [&] {
    problem = surfaceProblem(*job.solid, values, job.options.seed, job.counts, context);
  });
  FitSettings settings;
  settings.sources = job.counts.sources;
  settings.solver = FitSolver::iterative;
  settings.interpolation = Interpolation::linear;
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  std::optional<FitResult> result;
  context.timed("fit", [&] { result.emplace(fitField(problem, settings)); });
  Report& report = context.report();
  ReportSolve solve;
  solve.method = "iterative";
  solve.sources = solve.rank = result->field.sources().size();
  solve.collocation = problem.surface.points.size();
  solve.iterations = static_cast<int>(result->residuals.size()) - 1;
  report.solve = solve;
  report.set("solve.distance", result->distance);
  report.set("solve.residuals", result->residuals);
  report.set("solve.channels", static_cast<std::int64_t>(job.surface->channels()));
  report.set("solve.seed", static_cast<std::int64_t>(job.options.seed));
  context.timed("certificate", [&] {
    const BoundarySamples fresh = freshSamples(*job.solid, values, job.options.seed, context);
    const std::size_t counted = job.options.colours() ? 3 : job.surface->channels();
    const BoundaryError e =
        summarizeErrors(errorsOf(result->field, fresh, counted, context.progress()));
    report.set("surface.fit_error_rms", e.rms);
    report.set("surface.fit_error_p99", e.p99);
    report.set("surface.fit_error_max", e.max);
  });
  return result->field;
}

// Cd and, with texture coordinates, uv.
openvdb::GridPtrVec textureGrids(const Job& job, std::vector<openvdb::Vec3fGrid::Ptr> continued) {
  Progress* progress = job.context.progress();
  const TextureLookup lookup = [&](const Vec2& uv, const Vec2& a, const Vec2& b) {
    return job.images->at(uv, a, b);
  };
  openvdb::Vec3fGrid::Ptr colour, uv;
  if (job.options.colours()) {
    colour = continued[0];
    if (continued.size() > 1) uv = continued[1];
  } else if (job.options.blends()) {
    std::vector<ChartGroupGrid> groups;
    const std::vector<Vec2> centres = job.surface->groupCentres();
    for (std::size_t g = 0; g < continued.size(); ++g)
      groups.push_back({std::move(continued[g]), centres[g]});
    const BlendedTexture blended = blendChartGroups(groups, lookup, progress);
    colour = blended.colour;
    uv = blended.uv;
  } else {
    uv = continued[0];
    colour = lookUpColours(*uv, lookup, progress);
  }
  colour->setName("Cd");
  openvdb::GridPtrVec grids{colour};
  if (uv) {
    uv->setName("uv");
    grids.push_back(uv);
  }
  return grids;
}

void describe(const Job& job, const openvdb::GridPtrVec& grids) {
  const TextureOptions& o = job.options;
  for (const auto& grid : grids) {
    const auto text = [&](const char* key, const std::string& value) {
      grid->insertMeta(key, openvdb::StringMetadata(value));
    };
    text("innermap_source", o.mesh);
    text("innermap_texture", o.image.empty() ? "vertex colours" : o.image);
    text("innermap_texture_mode", o.colours() ? "colour" : "uv");
    if (!o.colours()) text("innermap_texture_seams", o.seams);
    if (!o.image.empty()) text("innermap_texture_wrap", o.wrap);
    text("innermap_colour_space", "linear");
    grid->insertMeta("innermap_sources",
                     openvdb::Int64Metadata(static_cast<std::int64_t>(job.counts.sources)));
  }
}

openvdb::GridPtrVec makeGrids(const Job& job, const HarmonicField& field) {
  Context& context = job.context;
  openvdb::FloatGrid::Ptr levelSet, density;
  context.timed("voxelize", [&] {
    levelSet = makeLevelSet(*job.solid, levelSetSettings(job.options, context));
    density = makeFog(*levelSet);
    for (const std::string& w : checkLevelSet(*levelSet, *job.solid).warnings) context.warning(w);
  });
  std::vector<openvdb::Vec3fGrid::Ptr> continued;
  context.timed("continue", [&] {
    ContinuationSettings settings;
    settings.spacing = spacingOf(job, job.counts.sources);
    settings.accuracy = kSumAccuracy;
    settings.maxMemory = context.maxMemory();
    settings.progress = context.progress();
    const BoundaryValues boundary = [&](const Solid::Closest& at, double* values) {
      job.surface->values(at.onSurface, job.voxel, values);
    };
    continued = continueInside(field, *job.solid, *levelSet, boundary, settings);
  });
  openvdb::GridPtrVec grids{levelSet, density}, texture;
  context.timed("texture", [&] { texture = textureGrids(job, std::move(continued)); });
  context.timed("figures", [&] {
    std::vector<Segment> seams;
    if (job.charts) {
      seams = segmentsOf(job.mesh, job.charts->seams);
      reportSeams(*job.solid, job.mesh, *job.charts, *job.surface, *levelSet, context);
    }
    reportSurface(*job.solid, seams, *job.surface,
                  *openvdb::gridConstPtrCast<openvdb::Vec3fGrid>(texture[0]), job.options.seed + 1,
                  context);
  });
  grids.insert(grids.end(), texture.begin(), texture.end());
  describe(job, grids);
  ReportGrid grid;
  grid.voxelSize = job.voxel;
  grid.activeVoxels = texture[0]->activeVoxelCount();
  for (auto it = levelSet->cbeginValueAll(); it; ++it)
    if (*it < 0) grid.interiorVoxels += it.getVoxelCount();
  if (grid.interiorVoxels == 0)
    throw DataError(job.options.mesh +
                    ": is thinner than the voxels everywhere, none has its centre inside; use a "
                    "higher --resolution");
  context.report().grid = grid;
  return grids;
}

void check(const TextureOptions& o) {
  if (o.blends() && o.image.empty())
    throw UsageError("--seams blend needs an IMAGE: vertex colours have no seams");
  if (o.blends() && o.mode != "uv")
    throw UsageError(
        "--seams blend is for --mode uv: colours continued by --mode colour show no seams; leave "
        "one of the two out");
}

void run(const TextureOptions& options, Context& context) {
  check(options);
  context.output(options.output);
  Job job{options, context, {}, {}, {}, {}, {}, {}, 0, {}};
  readInput(job);
  findCharts(job);
  const std::uint64_t need = memoryOf(job);
  if (context.dryRun())
    return context.plan({fmt::format("continue {} into {} with {} charges and voxels of {:.6g}",
                                     options.image.empty() ? "vertex colours" : options.image,
                                     options.mesh, job.counts.sources, job.voxel),
                         "write surface, density, Cd and uv to " + options.output},
                        need);
  requireMemory(
      "the solid texture", need, context.maxMemory(),
      fmt::format("use a --voxel-size above {:.3g}, fewer --sources or raise --max-memory",
                  1.5 * job.voxel));
  readTexture(job);
  const HarmonicField field = fit(job);
  const openvdb::GridPtrVec grids = makeGrids(job, field);
  context.timed("write", [&] {
    VdbWriteSettings write;
    write.names = parseNamingScheme("--names", options.names);
    write.progress = context.progress();
    writeVdb(options.output, grids, {}, write);
  });
}

}  // namespace

Command makeTextureCommand() {
  auto o = std::make_shared<TextureOptions>();
  Command c("texture", "Continue a surface's texture into its solid");
  c.description(
      "Writes the grids surface, density, Cd (linear colour) and uv; values are active inside and "
      "in a skin of two voxels, which has the colours of the closest surface. Without IMAGE, the "
      "mesh's vertex colours are continued. Seams' share of the solid, the jump of the texture's "
      "own colours across them and the error at the surface stand in the report.");
  c.positional("MESH", &o->mesh, "mesh file with texture coordinates or vertex colours");
  c.positional("IMAGE", &o->image,
               "the texture, in any format of OpenImageIO; with <UDIM> in its name, a set of tiles")
      .optional();
  c.option("--output", "FILE", &o->output, "the .vdb file to write").shortName("-o").required();
  c.option("--mode", "MODE", &o->mode,
           "uv: the texture coordinates are continued and the image is looked up at each voxel's; "
           "colour: the colours themselves are")
      .choices({"uv", "colour", "color"});
  c.option("--seams", "WAY", &o->seams,
           "with --mode uv. keep: the coordinates are continued as they are and sweep through the "
           "image below a seam; blend: those of each chart for themselves, and their colours mixed")
      .choices({"keep", "blend"});
  c.option("--colour-space", "SPACE", &o->colourSpace,
           "of the image; auto: as the file says, else sRGB for 8 bits and linear for more; vertex "
           "colours are linear unless srgb is given")
      .choices({"auto", "linear", "srgb"});
  c.option("--wrap", "WAY", &o->wrap, "what stands beyond the image's borders")
      .choices({"repeat", "clamp", "mirror", "black"});
  c.option("--resolution", "N", &o->resolution, "voxels along the longest side of the solid")
      .range(4, 4096);
  c.option("--voxel-size", "L", &o->voxelSize, "edge of a voxel, in place of --resolution")
      .unit("world units")
      .above(0)
      .defaults("by --resolution");
  c.option("--sources", "N", &o->sources, "number of charges")
      .range(100, 1e6)
      .defaults("one every two voxels of the surface, 1000 to 50000");
  c.option("--seed", "N", &o->seed, "of all random points").range(0, 1e15);
  c.option("--names", "SCHEME", &o->names, "what the grids are called in the file")
      .choices({"innermap", "blender", "houdini"});
  c.example("innermap texture spot.obj spot_texture.png -o spot.vdb --mode colour");
  c.example("innermap texture spot.obj 'spot.<UDIM>.exr' -o spot.vdb --seams blend");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
