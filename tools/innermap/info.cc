// `innermap info`: what a file holds.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "commands.h"
#include "core/text_scanner.h"
#include "innermap/field/field_file.h"
#include "innermap/io/exr_slices.h"
#include "innermap/io/vdb_file.h"
#include "innermap/io/volume_texture.h"
#include "innermap/mesh/mesh_file.h"
#include "inputs.h"
#include "report/info_json.h"

namespace innermap::tool {
namespace {

struct InfoOptions {
  std::string file;
  bool metadata = false, json = false;
};

std::string extension(const std::string& path) {
  std::string e = std::filesystem::path(path).extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return std::tolower(c); });
  return e;
}

std::string meshInfo(const InfoOptions& options, Context& context) {
  const Mesh mesh = readMeshFile(options.file, context);
  if (options.json) return infoJson(options.file, mesh);
  const Box3 box = boundingBox(mesh);
  const Vec3 size = box.extent();
  std::string text = fmt::format("{}: mesh, {} vertices, {} triangles", options.file,
                                 mesh.vertices.size(), mesh.triangles.size());
  if (mesh.polygonStart.size() > 1)
    text += fmt::format(" from {} polygons", mesh.polygonStart.size() - 1);
  if (!mesh.uvs.empty()) text += fmt::format(", {} texture coordinates", mesh.uvs.size());
  if (!mesh.colours.empty()) text += ", vertex colours";
  text += fmt::format(
      "\n  box ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}), {:.6g} x {:.6g} x {:.6g}, "
      "diagonal {:.6g}\n  area {:.6g}, volume {:.6g}\n",
      box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z, size.x, size.y,
      size.z, box.diagonal(), surfaceArea(mesh), signedVolume(mesh));
  return text;
}

std::string mapInfo(const InfoOptions& options) {
  const FieldFile file = readField(options.file);
  if (options.json) return infoJson(options.file, file);
  std::size_t sources = 0;
  for (const HarmonicField& step : file.steps) sources += step.sources().size();
  const std::size_t channels = file.steps.front().channels(), steps = file.steps.size();
  std::string text = fmt::format(
      "{}: {}, {} channel{}, {} charges, boundary of {} vertices and {} triangles\n", options.file,
      steps == 1 ? "harmonic field" : fmt::format("map in {} harmonic steps", steps), channels,
      channels == 1 ? "" : "s", sources, file.boundary.size(), file.boundaryTriangles.size());
  if (options.metadata) {
    for (const auto& [key, value] : file.facts) text += fmt::format("    {}: {}\n", key, value);
    return text;
  }
  for (const char* key : {"source", "target"})
    if (const auto name = factText(file.facts, key)) text += fmt::format("  {}: {}\n", key, *name);
  const FitFacts fit = fitFacts(file.facts);
  if (std::isfinite(fit.error.p99))
    text += fmt::format("  boundary error: 99% within {:.3g}, at most {:.3g}{}\n", fit.error.p99,
                        fit.error.max,
                        fit.tolerance ? fmt::format("; {:g} was wanted", *fit.tolerance) : "");
  return text;
}

std::string vdbInfo(const InfoOptions& options) {
  const VdbInfo info = readVdbInfo(options.file);
  return options.json ? infoJson(options.file, info)
                      : describe(info, options.file, options.metadata);
}

std::string exrInfo(const InfoOptions& options) {
  const std::vector<ExrPart> parts = readExrInfo(options.file);
  const std::optional<VolumeTextureInfo> volume = readVolumeTextureInfo(options.file);
  if (options.json) return infoJson(options.file, parts, volume);
  return describe(parts, options.file) + (volume ? describe(*volume) : "");
}

bool isVolumeFile(const std::string& path) {
  return volumeFormatOf(path).name != volumeFormats().front().name;
}

std::string volumeInfo(const InfoOptions& options) {
  const VolumeFileInfo info = readVolumeFileInfo(options.file);
  return options.json ? infoJson(options.file, info) : describe(info, options.file);
}

std::string gltfText(const std::string& path, const AnimationInfo& info) {
  std::string text = fmt::format("{}: glTF, {} meshes, {} animations\n", path, info.meshes.size(),
                                 info.animations.size());
  for (const AnimationInfo::Body& mesh : info.meshes)
    text += fmt::format(
        "  mesh {}: {} vertices ({} in the file), {} triangles, {} joints, {} morph "
        "targets\n",
        inQuotes(mesh.name), mesh.vertices, mesh.stored, mesh.triangles, mesh.joints, mesh.targets);
  for (const AnimationInfo::Clip& clip : info.animations)
    text += fmt::format("  animation {}: {:g} s to {:g} s\n", inQuotes(clip.name), clip.start,
                        clip.end);
  return text;
}

std::string animationInfo(const InfoOptions& options) {
  const AnimationInfo info = readAnimationInfo(options.file);
  if (options.json) return infoJson(options.file, info);
  if (isGltf(options.file)) return gltfText(options.file, info);
  std::string text = fmt::format("{}: {} point cache, {} frames of {} points\n", options.file,
                                 info.format, info.frames, info.points);
  if (info.seconds.empty())
    text += fmt::format("  first frame {:g}, a frame each {:g} frames\n", info.start, info.step);
  else
    text += fmt::format("  from {:g} s to {:g} s\n", info.seconds.front(), info.seconds.back());
  return text;
}

void run(const InfoOptions& options, Context& context) {
  const std::string e = extension(options.file);
  // A dry run reads too, as only what is in the file tells what it takes.
  const std::string text = e == ".vdb"                     ? vdbInfo(options)
                           : e == ".exr"                   ? exrInfo(options)
                           : isVolumeFile(options.file)    ? volumeInfo(options)
                           : isAnimationFile(options.file) ? animationInfo(options)
                           : isFieldFile(options.file)     ? mapInfo(options)
                                                           : meshInfo(options, context);
  if (context.dryRun()) return context.plan({"describe " + options.file}, 0);
  context.print(text);
}

}  // namespace

Command makeInfoCommand() {
  auto o = std::make_shared<InfoOptions>();
  Command c("info",
            "Describe a file: grids, a map, a mesh, an animation, or a volume of another format");
  c.positional(
      "FILE", &o->file,
      "a .vdb, .exr, .nvdb, .vti, .dds, .nii, .nii.gz or .usda file, a map, mesh, .mdd, .pc2 or "
      "glTF file");
  c.flag("--metadata", &o->metadata,
         "also show all metadata of the grids, or all that a map's file says");
  c.flag("--json", &o->json, "print machine-readable text with all metadata on stdout");
  c.example("innermap info map.vdb");
  c.example("innermap info map.vdb --json | jq '.grids[].name'");
  return c.running(o, run);
}

}  // namespace innermap::tool
