#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "core/file.h"
#include "core/frame_files.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/animation/detail/gltf_frames.h"
#include "mesh/animation/detail/point_cache.h"
#include "mesh/detail/scene_files.h"

namespace innermap {
namespace {

// A file a frame.
class FramesInFiles : public FrameSource {
 public:
  FramesInFiles(const std::vector<std::string>& paths, const SpaceSettings& space)
      : toOutput_(inputToOutput(space)) {
    FrameList list = findFrames(paths, meshExtensions());
    if (list.frames.empty())
      throw DataError(fmt::format("{}: none of the {} files has a frame number in its name",
                                  paths.front(), list.unnumbered.size()));
    unnumbered = std::move(list.unnumbered);
    files_ = std::move(list.frames);
    for (const FrameFile& file : files_) numbers.push_back(file.number);
  }

  const std::string& path(std::size_t index) const override { return files_.at(index).path; }
  Mesh read(std::size_t index, const Mesh& rest) const override {
    Mesh mesh = readMeshLike(path(index), rest);
    move(mesh.vertices, toOutput_);
    requireNearOrigin(mesh);
    return mesh;
  }
  std::string fingerprint(std::size_t index) const override { return fingerprintOf(path(index)); }

 private:
  const Similarity toOutput_;
  std::vector<FrameFile> files_;
};

class FramesOfCache : public FrameSource {
 public:
  FramesOfCache(const std::string& path, const AnimationSettings& settings)
      : toOutput_(inputToOutput(settings.space)), cache_(path) {
    const double rounded = std::round(cache_.step());
    const bool whole = rounded >= 1 && std::abs(cache_.step() - rounded) < 1e-3;
    if (!whole)
      notes.push_back(
          fmt::format("{}: holds a frame for each {:g} frames of the scene; innermap numbers them "
                      "one by one, so velocities fit a cache that plays one a frame",
                      path, cache_.step()));
    const bool isMdd = cache_.format() == PointCacheFormat::mdd;
    const auto step = static_cast<std::int64_t>(whole ? rounded : 1);
    const std::int64_t first = settings.firstFrame ? *settings.firstFrame
                               : isMdd             ? 1
                                       : static_cast<std::int64_t>(std::llround(cache_.start()));
    for (std::size_t i = 0; i < cache_.frames(); ++i)
      numbers.push_back(first + static_cast<std::int64_t>(i) * step);
  }

  const std::string& path(std::size_t) const override { return cache_.path(); }

  Mesh read(std::size_t index, const Mesh& rest) const override {
    requireLike(rest);
    Mesh mesh = rest;
    mesh.name = cache_.path() + ", frame " + std::to_string(numbers.at(index));
    mesh.vertices = cache_.read(index);
    move(mesh.vertices, toOutput_);
    requireNearOrigin(mesh);
    return mesh;
  }

  std::string fingerprint(std::size_t index) const override {
    const std::string bytes = cache_.bytes(index);
    return fmt::format("{}-{:016x}", bytes.size(), hashOf(bytes));
  }

  void requireLike(const Mesh& rest) const override {
    if (cache_.points() != rest.vertices.size())
      throw DataError(fmt::format(
          "{}: cache has {} points, mesh {} has {} vertices; export both from the same mesh",
          cache_.path(), cache_.points(), rest.name, rest.vertices.size()));
  }

 private:
  const Similarity toOutput_;
  PointCache cache_;
};

}  // namespace

std::vector<Setting> describe(AnimationSettings& s) {
  return {Setting("first_frame", "N", &s.firstFrame,
                  "number of the first frame of a file that holds several; the others follow")
              .from(-1e9, 1e9)
              .otherwise("1 for .mdd, the file's own for .pc2, by seconds for glTF"),
          Setting("fps", "N", &s.framesPerSecond,
                  "frames per second for baking glTF, for velocities and in .mdd files")
              .above(0, 1e6),
          Setting("rest", "N", &s.restFrame, "frame of glTF to take as the rest pose")
              .from(-1e9, 1e9)
              .otherwise("the pose in which its mesh was bound")};
}

bool isAnimationFile(const std::string& path) { return isPointCache(path) || isGltf(path); }

std::unique_ptr<FrameSource> openFrames(const std::vector<std::string>& paths,
                                        const AnimationSettings& settings) {
  requireDescribed(settings);
  for (const std::string& path : paths) {
    if (std::filesystem::is_directory(path)) continue;
    requireNoScene(path);
    if (!isAnimationFile(path)) continue;
    if (paths.size() > 1)
      throw FileError(path, "holds all frames; give it alone, or frames as files of their own");
    if (isGltf(path)) return openGltfFrames(path, settings);
    return std::make_unique<FramesOfCache>(path, settings);
  }
  return std::make_unique<FramesInFiles>(paths, settings.space);
}

AnimationInfo readAnimationInfo(const std::string& path) {
  if (isGltf(path)) return readGltfInfo(path);
  const PointCache cache(path);
  AnimationInfo info;
  info.format = cache.format() == PointCacheFormat::mdd ? "MDD" : "PC2";
  info.frames = cache.frames();
  info.points = cache.points();
  info.start = cache.start();
  info.step = cache.step();
  info.seconds = cache.seconds();
  return info;
}

}  // namespace innermap
