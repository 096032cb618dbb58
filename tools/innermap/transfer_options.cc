#include "transfer_options.h"

#include <fmt/format.h>

#include "innermap/transfer/carry.h"
#include "inputs.h"
#include "lists.h"
#include "report/figures.h"

namespace innermap::tool {
namespace {

// Twelve numbers, the rows of a 3 x 4 matrix.
RigidMotion parseMotion(const std::string& text) {
  const std::vector<double> numbers = parseNumbers(
      "--fade-to", text, 12,
      "neither cut, identity nor fitted nor the twelve numbers of a rigid motion's 3 x 4 matrix, "
      "row by row with commas between");
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

}  // namespace

void addTransferOptions(Command& c, TransferOptions& o) {
  c.group("grids to carry");
  c.option("--grids", "LIST", &o.grids, "carry only these grids; commas between names")
      .defaults("all");
  c.settings(only(describe(o.carry), {"sampling"}));
  c.flag("--density", &o.carry.allDensities,
         "treat scalars as densities: divide them by the change of volume; push and deform keep "
         "their mass exactly");
  c.option("--densities", "LIST", &o.densities, "treat only these scalars as densities")
      .defaults("none")
      .advanced();
  c.option("--stress", "LIST", &o.stress,
           "Cauchy stresses: NAME stands for the six grids NAME.xx, .yy, .zz, .xy, .yz, .xz or "
           "the rows NAME.x, .y, .z")
      .defaults("none")
      .advanced();
  c.option("--strain", "LIST", &o.strain, "the same for covariant strains")
      .defaults("none")
      .advanced();
  c.setting(outsideSetting(&o.outside));
  c.option("--fade-to", "MOTION", &o.fadeTo,
           "motion that the map fades to with --outside: cut (the map ends there), identity, "
           "fitted (the best rigid motion of the surface), or twelve numbers, a rigid motion's 3 x "
           "4 matrix by rows")
      .advanced();
  c.settings(only(describe(o.carry), {"density_limit"}));
  c.settings(describe(o.verdict));
  c.settings(
      describe(o.grid, "the solid",
               "voxels as fine as those of the grids, for the size of the solid that they go to"));
  c.setting(namesSetting(&o.names));
}

CarrySettings carrySettings(const TransferOptions& options) {
  CarrySettings out = options.carry;
  out.densities = commaList(options.densities);
  out.stresses = commaList(options.stress);
  out.strains = commaList(options.strain);
  return out;
}

FadeTo fadeTo(const TransferOptions& options) {
  if (options.fadeTo == "cut") return {};
  if (!(options.outside > 0))
    throw UsageError("--fade-to: is for what lies outside; give --outside too");
  if (options.fadeTo == "fitted") return {{}, true};
  return {options.fadeTo == "identity" ? RigidMotion() : parseMotion(options.fadeTo)};
}

openvdb::GridPtrVec readVolume(const std::string& path, const TransferOptions& options,
                               Context& context) {
  const bool tensors = !options.stress.empty() || !options.strain.empty();
  if (tensors && !inputToOutput(context.space()).isIdentity())
    throw UsageError(
        "--stress and --strain: are carried in the axes and unit that they have; leave out "
        "--out-up and --out-unit-scale");
  openvdb::GridPtrVec grids = readGridFile(path, commaList(options.grids), context);
  if (grids.empty()) throw FileError(path, "holds no grid");
  requireCarriable(grids, carrySettings(options));
  return grids;
}

void reportPush(const PushResult& result, Context& context) {
  Report& report = context.report();
  if (result.inverted) report.add("inverse", figures(result.statistics));
  for (const CarriedMass& mass : result.masses) {
    report.add("mass", massFigures(mass));
    report.add("densities", densityFigures(mass));
  }
  for (const std::string& warning : result.warnings) context.warning(warning);
}

std::string inverseText(const InverseStatistics& s) {
  return fmt::format(
      "inverse: found for {1:.4f}% of {0} voxels inside, not for {2}; of {3} outside the "
      "surface, not for {4}\n",
      s.inside, 100 * s.invertedInside(), s.failedInside, s.voxels - s.inside,
      s.failed - s.failedInside);
}

std::string pushText(const PushResult& result) {
  std::string text = result.inverted ? inverseText(result.statistics) : "";
  for (const CarriedMass& mass : result.masses)
    text += fmt::format(
        "mass of {}: {:.6g} before, {:.6g} after ({:+.3f}%); densities grow at most {:.4g} times\n",
        mass.name, mass.before, mass.after,
        mass.before != 0 ? 100 * (mass.after / mass.before - 1) : 0.0, mass.largestRatio);
  for (const CarriedMass& mass : result.masses)
    if (mass.cut != 0)
      text +=
          fmt::format("--density-limit leaves out {:.6g} of the mass of {} ({:.3g}%)\n", mass.cut,
                      mass.name, mass.before != 0 ? 100 * mass.cut / mass.before : 0.0);
  return text;
}

}  // namespace innermap::tool
