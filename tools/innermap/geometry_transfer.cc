#include "geometry_transfer.h"

#include <fmt/format.h>

#include "lists.h"
#include "report/figures.h"

namespace innermap::tool {

void addGeometryOptions(Command& c, GeometryOptions& o, bool subdivide) {
  c.group("geometry that is carried");
  c.option("--vectors", "LIST", &o.vectors,
           "of geometry: properties (.ply: NAME_x, NAME_y, NAME_z) or fields (.vtu, .msh) that are "
           "vectors and turned by the map's Jacobian")
      .defaults("those that the file declares");
  c.option("--normals", "LIST", &o.normals,
           "of geometry: properties or fields that are normals of surfaces, turned by the inverse "
           "transpose of the Jacobian")
      .defaults("nx, ny, nz; those that the file declares");
  if (subdivide) c.setting(subdivideSetting(&o.subdivide));
  c.setting(splatsSetting(&o.splats));
}

void requireFitting(const std::string& input, const std::string& output,
                    const TransferOptions& transfer, const GeometryOptions& geometry) {
  const bool isGeometry = isGeometryFile(input);
  const auto refuse = [](const char* option, bool given, const char* what) {
    if (given) throw UsageError(fmt::format("{}: is for {}; leave it out", option, what));
  };
  if (!isGeometry) {
    refuse("--vectors", !geometry.vectors.empty(), "geometry");
    refuse("--normals", !geometry.normals.empty(), "geometry");
    refuse("--subdivide", geometry.subdivide > 0, "geometry");
    refuse("--splats", geometry.splats != SplatOpacity::look, "geometry");
    return;
  }
  refuse("--grids", !transfer.grids.empty(), "volumes");
  refuse("--density", transfer.carry.allDensities, "volumes");
  refuse("--densities", !transfer.densities.empty(), "volumes");
  refuse("--stress", !transfer.stress.empty(), "volumes");
  refuse("--strain", !transfer.strain.empty(), "volumes");
  refuse("--resolution", transfer.grid.resolution.has_value(), "volumes");
  refuse("--voxel-size", transfer.grid.voxelSize.has_value(), "volumes");
  requireWritableAs(input, output);
}

std::unique_ptr<GeometryFile> readGeometryFile(const std::string& path,
                                               const GeometryOptions& options, Context& context) {
  ReadGeometrySettings settings;
  settings.vectors = commaList(options.vectors);
  settings.normals = commaList(options.normals);
  auto file = context.timed("read", [&] { return readGeometry(path, settings); });
  for (const std::string& note : file->notes) context.note(note);
  return file;
}

void warnOf(const CarriedGeometry& carried, const TransferOptions& options, const std::string& part,
            Context& context) {
  const CarriedPoints& points = carried.points;
  if (points.cut > 0)
    context.warning(fmt::format(
        "{}{} points lie too far outside the solid; they and the {} faces, lines or cells that use "
        "them are left out{}",
        part, points.cut, carried.cutElements,
        options.outside > 0 ? "; raise --outside or give --fade-to"
                            : "; give --outside to keep them"));
  if (points.failed > 0)
    context.warning(
        fmt::format("{}at {} points the map has no inverse; they get the nearest place found", part,
                    points.failed));
  if (carried.folded > 0)
    context.warning(fmt::format("{}at {} points the map folds; directions there mean little", part,
                                carried.folded));
  if (carried.splats.capped > 0)
    context.warning(
        fmt::format("{}{} splats shrink so much that no opacity dims as much as before; they get "
                    "the largest, 0.99 or their own",
                    part, carried.splats.capped));
  const auto& [cells, before, after] = carried.inverted;
  if (after > before)
    context.warning(
        fmt::format("{}{} of {} cells are inverted, {} were before", part, after, cells, before));
}

std::string reportGeometry(const CarriedGeometry& carried, Context& context) {
  const CarriedPoints& points = carried.points;
  const Figures made = figures(carried);
  context.report().add("geometry", made);
  std::string text = fmt::format("{} points, {} directions carried\n", carried.ownPoints,
                                 numberOf(*findFigure(made, "directions")));
  if (carried.splats.degree >= 0)
    text += fmt::format("the points are Gaussian splats, with colours of degree {}\n",
                        carried.splats.degree);
  if (carried.added > 0) text += fmt::format("{} points added on split edges\n", carried.added);
  if (points.outside > 0)
    text += fmt::format(
        "{} points outside the solid, {} cut, the others up to {:.3g} of the "
        "diagonal away\n",
        points.outside, points.cut, points.farthest);
  if (const auto& [cells, before, after] = carried.inverted; cells > 0)
    text += fmt::format("{} cells, inverted: {} before, {} after\n", cells, before, after);
  return text;
}

void writeGeometryFile(const std::string& path, const GeometryFile& file,
                       const CarriedGeometry& carried, Context& context) {
  const std::vector<std::string> lost =
      context.timed("write", [&] { return writeGeometry(path, file, carried); });
  for (const std::string& name : lost)
    context.warning(path + ": its format cannot hold the field '" + name + "'; it is left out");
}

}  // namespace innermap::tool
