#include "transfer_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "innermap/core/memory.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/levelset/level_set.h"
#include "largest.h"
#include "lists.h"

namespace innermap::tool {
namespace {

constexpr double kBand = 3;  // voxels: the skin of 2 and one more for interpolation

// Twelve numbers, the rows of a 3 x 4 matrix.
RigidMotion parseMotion(const std::string& text) {
  const std::vector<std::string> parts = commaList(text);
  std::vector<double> numbers;
  for (const std::string& part : parts) {
    char* end = nullptr;
    numbers.push_back(std::strtod(part.c_str(), &end));
    if (end == part.c_str() || *end || !std::isfinite(numbers.back())) numbers.clear();
    if (numbers.empty()) break;
  }
  if (numbers.size() != 12)
    throw UsageError("--fade-to: '" + text +
                     "' is neither cut, identity nor fitted nor the twelve numbers of a rigid "
                     "motion's 3 x 4 matrix, row by row with commas between");
  RigidMotion motion;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) motion.rotation[r][c] = numbers[4 * r + c];
    motion.translation[static_cast<int>(r)] = numbers[4 * r + 3];
  }
  if (!isRigid(motion))
    throw UsageError(
        "--fade-to: the matrix is no rotation; rows must be orthonormal and "
        "right-handed");
  return motion;
}

LevelSetSettings levelSetSettings(const openvdb::GridPtrVec& grids, const TransferOptions& options,
                                  const Context* context) {
  LevelSetSettings settings;
  settings.halfWidth = kBand;
  if (context) settings.maxMemory = context->maxMemory();
  if (context) settings.progress = context->progress();
  if (options.resolution) settings.resolution = *options.resolution;
  if (options.voxelSize)
    settings.voxelSize = *options.voxelSize;
  else if (!options.resolution)
    settings.voxelSize = finestVoxel(grids);
  return settings;
}

}  // namespace

void addTransferOptions(Command& c, TransferOptions& o) {
  c.option("--grids", "LIST", &o.grids, "grids to carry, with commas between").defaults("all");
  c.option("--sampling", "WAY", &o.sampling,
           "between voxels; whole numbers are always taken from the nearest")
      .choices({"nearest", "linear", "quadratic"});
  c.flag("--density", &o.density,
         "scalars are densities: divided by the change of volume, so that mass is kept");
  c.option("--densities", "LIST", &o.densities, "only these scalars are densities")
      .defaults("none");
  c.option("--stress", "LIST", &o.stress,
           "Cauchy stresses: NAME stands for the six grids NAME.xx, .yy, .zz, .xy, .yz, .xz or "
           "the rows NAME.x, .y, .z")
      .defaults("none");
  c.option("--strain", "LIST", &o.strain, "the same for covariant strains").defaults("none");
  c.option("--outside", "D", &o.outside,
           "carry also what is around the solid, up to this distance from it")
      .unit("fraction of the diagonal")
      .range(0, 1);
  c.option(
      "--fade-to", "MOTION", &o.fadeTo,
      "what the map fades to with --outside: cut (it ends there), identity, fitted (the best "
      "rigid motion of the surface), or twelve numbers, a rigid motion's 3 x 4 matrix by rows");
  c.option("--resolution", "N", &o.resolution, "voxels along the longest side of the solid")
      .range(4, 4096)
      .defaults("voxels as fine as those of the grids");
  c.option("--voxel-size", "L", &o.voxelSize, "edge of a voxel, in place of --resolution")
      .unit("world units")
      .above(0);
  c.option("--names", "PROGRAM", &o.names, "names of grids as this program expects them")
      .choices({"innermap", "blender", "houdini"});
}

CarrySettings carrySettings(const TransferOptions& options) {
  CarrySettings out;
  out.sampling = options.sampling == "nearest"     ? Sampling::nearest
                 : options.sampling == "quadratic" ? Sampling::quadratic
                                                   : Sampling::linear;
  out.allDensities = options.density;
  out.densities = commaList(options.densities);
  out.stresses = commaList(options.stress);
  out.strains = commaList(options.strain);
  return out;
}

OutsideSettings outsideSettings(const TransferOptions& options, const Points& from,
                                const Points& to) {
  OutsideSettings out;
  out.distance = options.outside;
  if (options.fadeTo == "cut") return out;
  if (!(options.outside > 0))
    throw UsageError("--fade-to: is for what lies outside; give --outside too");
  if (options.fadeTo == "identity")
    out.fadeTo = RigidMotion();
  else
    out.fadeTo =
        options.fadeTo == "fitted" ? bestRigidMotion(from, to) : parseMotion(options.fadeTo);
  return out;
}

PushSettings pushSettings(const TransferOptions& options, const Points& from, const Points& to,
                          Context& context) {
  PushSettings out;
  out.carry = carrySettings(options);
  out.outside = outsideSettings(options, from, to);
  out.maxMemory = context.maxMemory();
  out.progress = context.progress();
  return out;
}

openvdb::GridPtrVec readVolume(const std::string& path, const TransferOptions& options,
                               Context& context) {
  VdbReadSettings settings;
  settings.names = commaList(options.grids);
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  openvdb::GridPtrVec grids;
  context.timed("read", [&] { grids = readVdb(path, settings).grids; });
  if (grids.empty()) throw FileError(path, "holds no grid");
  return grids;
}

std::uint64_t transferMemory(const Solid& solid, const openvdb::GridPtrVec& grids,
                             const TransferOptions& options) {
  OutsideSettings outside;
  outside.distance = options.outside;
  return carryMemory(solid, grids, levelSetSettings(grids, options, nullptr), outside);
}

void requireTransferMemory(const Solid& solid, const openvdb::GridPtrVec& grids,
                           const TransferOptions& options, const Context& context) {
  const auto fits = [&](std::uint64_t resolution) {
    TransferOptions o = options;
    o.voxelSize.reset();
    o.resolution = static_cast<int>(resolution);
    return transferMemory(solid, grids, o) <= context.maxMemory();
  };
  const std::uint64_t most = largestThat(4, 4096, fits);
  requireMemory("carrying the volume", transferMemory(solid, grids, options), context.maxMemory(),
                most > 0 ? fmt::format("use --resolution {} or raise --max-memory", most)
                         : "raise --max-memory");
}

openvdb::FloatGrid::Ptr outputLevelSet(const Solid& solid, const openvdb::GridPtrVec& grids,
                                       const TransferOptions& options, Context& context) {
  const LevelSetSettings settings = levelSetSettings(grids, options, &context);
  openvdb::FloatGrid::Ptr out;
  context.timed("level set", [&] { out = makeLevelSet(solid, settings); });
  return out;
}

void writeVolume(const std::string& path, const openvdb::GridPtrVec& grids,
                 const TransferOptions& options, Context& context) {
  VdbWriteSettings settings;
  settings.names = parseNamingScheme("--names", options.names);
  settings.progress = context.progress();
  writeVdb(path, grids, {}, settings);
}

void reportPush(const PushResult& result, Context& context) {
  const InverseStatistics& s = result.statistics;
  Report& report = context.report();
  const auto count = [&](const char* key, std::uint64_t value) {
    report.set(std::string("inverse.") + key, static_cast<std::int64_t>(value));
  };
  count("voxels", s.voxels);
  count("inside", s.inside);
  count("uncovered", s.uncovered);
  count("not_inverted", s.failed);
  count("not_inverted_inside", s.failedInside);
  // The map itself ends at the surface: its inverse is judged inside.
  report.set("inverse.inverted_fraction", s.invertedInside());
  report.set("inverse.inverted_fraction_outside", s.invertedOutside());
  report.set("inverse.largest_residual_voxels", s.largestResidual);
  if (s.failedInside > 0) {
    const Vec3 &a = s.failedBox.lower, &b = s.failedBox.upper;
    report.set("inverse.not_inverted_lower", std::vector<double>{a.x, a.y, a.z});
    report.set("inverse.not_inverted_upper", std::vector<double>{b.x, b.y, b.z});
    std::vector<double> places;
    for (const Vec3& p : s.failedAt) places.insert(places.end(), {p.x, p.y, p.z});
    report.set("inverse.not_inverted_at", places);
  }
  for (const CarriedMass& mass : result.masses) {
    report.set("mass." + mass.name + "_before", mass.before);
    report.set("mass." + mass.name + "_after", mass.after);
  }
  for (const std::string& warning : result.warnings) context.warning(warning);
}

std::string pushText(const PushResult& result) {
  const InverseStatistics& s = result.statistics;
  std::string text = fmt::format(
      "inverse: {} voxels inside, {:.4f}% inverted, {} not; {} outside the surface, {} not\n",
      s.inside, 100 * s.invertedInside(), s.failedInside, s.voxels - s.inside,
      s.failed - s.failedInside);
  for (const CarriedMass& mass : result.masses)
    text +=
        fmt::format("mass of {}: {:.6g} before, {:.6g} after ({:+.3f}%)\n", mass.name, mass.before,
                    mass.after, mass.before != 0 ? 100 * (mass.after / mass.before - 1) : 0.0);
  return text;
}

}  // namespace innermap::tool
