// `innermap texture`: a surface's texture continued into its solid.
#include <fmt/format.h>

#include "commands.h"
#include "grid_options.h"
#include "innermap/core/memory.h"
#include "innermap/fit/fit_map.h"
#include "innermap/io/pictures.h"
#include "innermap/texture/solid_texture.h"
#include "inputs.h"
#include "job_cost.h"
#include "jobs/texture_need.h"
#include "report/figures.h"
#include "report/report_figures.h"
#include "report/verdict.h"

namespace innermap::tool {
namespace {

const std::vector<std::pair<std::string, Wrap>> kWraps{{"repeat", Wrap::repeat},
                                                       {"clamp", Wrap::clamp},
                                                       {"mirror", Wrap::mirror},
                                                       {"black", Wrap::black}};

struct TextureOptions {
  std::string mesh, image, output;
  NamingScheme names = NamingScheme::innermap;
  LatticeChoice grid;
  SolidTextureSettings texture;
  TextureImageSettings images;
  double tolerance = kUsualTolerance;

  bool blends() const { return texture.seams == TextureSeams::blend; }
};

SolidTextureSettings settingsOf(const TextureOptions& o) {
  if (o.blends() && o.image.empty())
    throw UsageError("--seams blend needs an IMAGE: vertex colours have no seams");
  if (o.blends() && o.texture.mode != TextureMode::coordinates)
    throw UsageError(
        "--seams blend is for --mode uv: colours continued by --mode colour show no seams; leave "
        "one of the two out");
  auto s = o.grid.in(o.texture);
  if (o.image.empty()) s.mode = TextureMode::vertexColours;
  if (o.images.colourSpace == ColourSpace::srgb) s.decode = linearFromSrgb;
  return s;
}

TextureImages readImages(const TextureOptions& o, const std::vector<UdimTile>& tiles,
                         Context& context) {
  TextureImages images =
      context.timed("image", [&] { return TextureImages(o.image, tiles, o.images); });
  for (const std::string& note : images.notes()) context.note(note);
  ReportImage image{o.image, "", images.count(), "", 0, 0, isTiled(o.image)};
  if (images.count() > 0) {
    image.colourSpace = images.colourSpace();
    image.channels = images.channels();
    image.width = images.width();
    image.height = images.height();
  }
  context.report().add("texture", figures(image));
  return images;
}

void fillReport(const SolidTexture& made, const TextureOptions& options, Report& report) {
  report.add("solve", solveFigures(made));
  report.add("solve", choiceFigures(options.texture.seed));
  if (made.seams) report.add("seams", figures(*made.seams));
  report.add("surface", surfaceFigures(made));
  report.add("grid",
             gridFigures(made.voxelSize, made.colour->activeVoxelCount(), made.interiorVoxels));
}

void expectPhases(const TextureOptions& o, const SolidTextureSettings& settings,
                  const SolidTexturePlan& plan, Context& context) {
  const Mesh& mesh = plan.mesh();
  double area = surfaceArea(mesh);
  JobSize size = jobSize(std::abs(signedVolume(mesh)), area, plan.voxelSize, plan.sources);
  const bool colours = settings.mode == TextureMode::imageColours;
  // In fields of three channels; colours are solved with more care.
  const double fields = o.blends() ? std::max(1, plan.groups) : colours ? 2.5 : 1;
  size.items = fields * size.charges;
  std::vector<JobPhase> phases;
  if (!o.image.empty()) phases.push_back(stageOf("reading the image", size));
  for (const char* stage : {"placing samples", "factoring clusters", "solving", "level set"})
    phases.push_back(stageOf(stage, size));
  size.items = fields * size.inside;
  phases.push_back(stageOf(colours ? "continuing inwards: colours" : "continuing inwards", size));
  phases.push_back(stageOf("meeting the surface", size));
  if (o.blends())
    phases.push_back(stageOf("blending charts", size));
  else if (settings.mode == TextureMode::coordinates)
    phases.push_back(stageOf("looking up colours", size));
  phases.push_back(stageOf("writing the VDB file", size));
  context.expect(phases);
}

void run(const TextureOptions& o, Context& context) {
  const SolidTextureSettings settings = settingsOf(o);
  context.output(o.output);
  const SolidTexturePlan plan = planSolidTexture(readMeshFile(o.mesh, context), settings);
  context.tell(plan);
  if (o.blends()) context.report().add("seams", blendFigures(plan.pieces, plan.groups));
  const std::string image = o.image.empty() ? "vertex colours" : o.image;
  std::vector<UdimTile> tiles;
  if (isTiled(o.image)) tiles = udimTiles(plan.mesh());
  expectPhases(o, settings, plan, context);
  if (!context.begins({fmt::format("continue {} into {} with {} charges and voxels of {:.6g}",
                                   image, o.mesh, plan.sources, plan.voxelSize),
                       "write surface, density, Cd and uv to " + o.output},
                      textureNeed(plan, o.image, tiles)))
    return;
  TextureLookup lookup;
  if (!o.image.empty())
    lookup = [images = readImages(o, tiles, context)](
                 const Vec2& uv, const Vec2& a, const Vec2& b) { return images.at(uv, a, b); };
  const SolidTexture made = makeSolidTexture(plan, lookup);
  context.tell(made);
  fillReport(made, o, context.report());
  context.judge(judgeTexture(made.fit.error, o.tolerance));
  const openvdb::GridPtrVec grids = made.grids();
  for (const openvdb::GridBase::Ptr& grid : grids) {
    grid->insertMeta("innermap_texture", openvdb::StringMetadata(image));
    for (const auto& [name, wrap] : kWraps)
      if (wrap == o.images.wrap && !o.image.empty())
        grid->insertMeta("innermap_texture_wrap", openvdb::StringMetadata(name));
  }
  writeGridFile(o.output, grids, o.names, context);
}

}  // namespace

Command makeTextureCommand() {
  auto o = std::make_shared<TextureOptions>();
  Command c("texture", "Continue a surface's texture into its solid");
  c.description(
      "Writes the grids surface, density, Cd (linear colour) and uv; values are active inside and "
      "in a skin of two voxels, which has the colours of the closest surface. Without IMAGE, "
      "texture continues the mesh's vertex colours. The report has the seams' share of the solid, "
      "the jump of the texture's own colours across them and the error at the surface.");
  c.positional("MESH", &o->mesh, "mesh file with texture coordinates or vertex colours");
  c.positional("IMAGE", &o->image,
               "the texture, in any format of OpenImageIO; with <UDIM> in its name, a set of tiles")
      .optional();
  c.outputFile(&o->output, {".vdb"}, "the .vdb file to write");
  c.settings(describe(o->texture));
  c.settings(describe(o->images));
  c.settings(describe(o->grid));
  c.option("--tolerance", "T", &o->tolerance,
           "warn unless 99% of the surface has its values within T")
      .unit("of values in 0 to 1")
      .above(0);
  c.setting(namesSetting(&o->names));
  c.example("innermap texture spot.obj spot_texture.png -o spot.vdb --mode colour");
  c.example("innermap texture spot.obj 'spot.<UDIM>.exr' -o spot.vdb --seams blend");
  return c.running(o, run);
}

}  // namespace innermap::tool
