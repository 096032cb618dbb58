#include "mesh/animation/detail/gltf_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <mutex>
#include <set>

#include "core/file.h"
#include "core/file_bytes.h"
#include "core/point_grid.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "mesh/animation/detail/gltf_scene.h"

namespace innermap {
namespace {

constexpr double kSame = 1e-5;  // of the diagonal, from a vertex to the same one

// The clips that are played: of this name, or all, if no two set the same.
std::vector<GltfClip> chosenClips(const GltfFile& file, std::vector<GltfClip> clips,
                                  const std::string& name) {
  std::vector<std::string> names;
  for (const GltfClip& clip : clips)
    if (names.size() < 20) names.push_back(inQuotes(clip.name));
  if (!name.empty()) {
    clips.erase(std::remove_if(clips.begin(), clips.end(),
                               [&](const GltfClip& clip) { return clip.name != name; }),
                clips.end());
    if (clips.empty())
      file.fail(fmt::format("has no animation {}; there are {}", inQuotes(name),
                            names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  }
  std::set<std::pair<int, int>> set;
  for (const GltfClip& clip : clips)
    for (const GltfChannel& channel : clip.channels)
      if (!set.emplace(channel.node, channel.value).second)
        file.fail(
            fmt::format("has several animations of the same joints: {}; choose one by "
                        "--animation",
                        fmt::join(names, ", ")));
  return clips;
}

// A mesh of a glTF file in its poses.
class GltfMotion {
 public:
  GltfMotion(const std::string& path, const AnimationSettings& settings)
      : settings_(settings), toOutput_(gltfToOutput(settings.space)), path_(path) {
    const GltfFile file(path);
    nodes_ = readGltfNodes(file);
    body_ = readGltfBody(file, nodes_, chooseGltfBody(file, nodes_, settings.mesh));
    clips_ = chosenClips(file, readGltfClips(file, nodes_), settings.animation);
    if (!clips_.empty()) setTimes();
  }

  const std::string& path() const { return path_; }
  std::int64_t frames() const { return frames_; }  // 0 without animation
  std::int64_t first() const {
    return settings_.firstFrame ? *settings_.firstFrame : static_cast<std::int64_t>(begin_);
  }
  const std::vector<Triangle>& triangles() const { return body_.triangles; }

  Points frame(std::int64_t index) const {
    // At whole frames; an animation that is shorter than one has that of its beginning.
    const double time =
        std::clamp((begin_ + static_cast<double>(index)) / settings_.framesPerSecond, start_, end_);
    GltfNodes posed = nodes_;
    for (const GltfClip& clip : clips_)
      for (const GltfChannel& channel : clip.channels)
        posed.nodes[channel.node].values[channel.value] = channel.at(time);
    return inOutput(body_.placed(posed, true));
  }

  Points bound() const { return inOutput(body_.placed(nodes_, false)); }

  Points rest() const {
    if (!settings_.restFrame) return bound();
    const std::int64_t index = *settings_.restFrame - first();
    if (index < 0 || index >= frames_)
      throw SettingError("rest",
                         fmt::format("{} has no frame {}; {}", path_, *settings_.restFrame,
                                     frames_ == 0 ? "it has no animation"
                                                  : fmt::format("they are {} to {}", first(),
                                                                first() + frames_ - 1)));
    return frame(index);
  }

 private:
  void setTimes() {
    constexpr double kMost = 1e6, kRounding = 1e-3;  // frames
    start_ = clips_.front().start();
    end_ = clips_.front().end();
    for (const GltfClip& clip : clips_) {
      start_ = std::min(start_, clip.start());
      end_ = std::max(end_, clip.end());
    }
    const double fps = settings_.framesPerSecond;
    begin_ = std::ceil(start_ * fps - kRounding);
    const double last = std::max(std::floor(end_ * fps + kRounding), begin_);
    if (!(std::abs(begin_) < 1e9) || !(last - begin_ < kMost))
      throw FileError(path_, fmt::format("takes {:g} s, at {:g} frames per second too many frames; "
                                         "use a lower --fps",
                                         end_ - start_, fps));
    frames_ = static_cast<std::int64_t>(last - begin_) + 1;
  }

  Points inOutput(Points points) const {
    for (const Vec3& p : points)
      if (!isFinite(p)) throw FileError(path_, "puts a vertex nowhere: damaged; export it again");
    move(points, toOutput_);
    return points;
  }

  const AnimationSettings settings_;
  const Similarity toOutput_;
  const std::string path_;
  GltfNodes nodes_;
  GltfBody body_;
  std::vector<GltfClip> clips_;
  double start_ = 0, end_ = 0, begin_ = 0;  // seconds; frames from 0 seconds to the first
  std::int64_t frames_ = 0;
};

class FramesOfGltf : public FrameSource {
 public:
  FramesOfGltf(const std::string& path, const AnimationSettings& settings)
      : motion_(path, settings) {
    if (motion_.frames() == 0)
      throw FileError(path, "has no animation; export it with one, or give frames beside it");
    for (std::int64_t i = 0; i < motion_.frames(); ++i) numbers.push_back(motion_.first() + i);
  }

  const std::string& path(std::size_t) const override { return motion_.path(); }

  Mesh read(std::size_t index, const Mesh& rest) const override {
    const std::shared_ptr<const Match> match = matchOf(rest);
    const std::vector<int>& which = match->vertices;
    const Points frame = motion_.frame(static_cast<std::int64_t>(index));
    Mesh mesh = rest;
    mesh.name = fmt::format("{}, frame {}", motion_.path(), numbers.at(index));
    for (std::size_t v = 0; v < which.size(); ++v) mesh.vertices[v] = frame[which[v]];
    requireNearOrigin(mesh);
    return mesh;
  }

  std::string fingerprint(std::size_t index) const override {
    const Points frame = motion_.frame(static_cast<std::int64_t>(index));
    const std::size_t bytes = frame.size() * sizeof(Vec3);
    return fmt::format("{}-{:016x}", bytes,
                       hashOf({reinterpret_cast<const char*>(frame.data()), bytes}));
  }

  void requireLike(const Mesh& rest) const override { matchOf(rest); }

 private:
  struct Match {
    Points rest;
    std::vector<int> vertices;
  };

  // Found once for a rest pose, which is that of all frames.
  std::shared_ptr<const Match> matchOf(const Mesh& rest) const {
    const auto same = [&](const Points& points) {
      return points.size() == rest.vertices.size() &&
             std::memcmp(points.data(), rest.vertices.data(), points.size() * sizeof(Vec3)) == 0;
    };
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!match_ || !same(match_->rest))
      match_ = std::make_shared<const Match>(Match{rest.vertices, verticesOf(rest)});
    return match_;
  }

  // The vertex of the file that each vertex of the rest pose is.
  std::vector<int> verticesOf(const Mesh& rest) const {
    std::vector<int> found;
    std::string why;
    for (const Points& pose : {motion_.rest(), motion_.bound(), motion_.frame(0)})
      if (match(rest, pose, &found, &why)) return found;
    throw DataError(why);
  }

  bool match(const Mesh& rest, const Points& pose, std::vector<int>* found,
             std::string* why) const {
    const double near = kSame * boundingBox(rest.vertices).diagonal();
    const auto close = [&](std::size_t a, std::size_t b) {
      return norm(rest.vertices[a] - pose[b]) <= near;
    };
    found->assign(rest.vertices.size(), -1);
    bool alike = pose.size() == rest.vertices.size();
    for (std::size_t v = 0; alike && v < pose.size(); ++v) {
      alike = close(v, v);
      (*found)[v] = static_cast<int>(v);
    }
    if (alike) return true;
    const PointGrid grid(pose, std::max(4 * near, 1e-300));
    for (std::size_t v = 0; v < rest.vertices.size(); ++v) {
      const Vec3& p = rest.vertices[v];
      std::vector<std::size_t> there = grid.within({p, p}, near);
      there.erase(
          std::remove_if(there.begin(), there.end(), [&](std::size_t i) { return !close(v, i); }),
          there.end());
      if (there.size() == 1) {
        (*found)[v] = static_cast<int>(there.front());
        continue;
      }
      if (why->empty())
        *why = there.empty() ? fmt::format(
                                   "{}: is not {} in any pose: none of its {} vertices is where "
                                   "vertex {} (counted from 0) is; export both from the same mesh "
                                   "with the same axis up, or use --up z, --rest or the file alone",
                                   motion_.path(), rest.name, pose.size(), v)
                             : fmt::format(
                                   "{}: has {} vertices that move apart where {} has its vertex {} "
                                   "(counted from 0); use the file alone, as its own rest pose",
                                   motion_.path(), there.size(), rest.name, v);
      return false;
    }
    return true;
  }

  GltfMotion motion_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const Match> match_;  // of the last rest pose
};

}  // namespace

bool isGltf(const std::string& path) {
  const std::string extension = extensionOf(path);
  return equalsIgnoringCase(extension, ".glb") || equalsIgnoringCase(extension, ".gltf");
}

std::unique_ptr<FrameSource> openGltfFrames(const std::string& path,
                                            const AnimationSettings& settings) {
  return std::make_unique<FramesOfGltf>(path, settings);
}

Mesh readRestPose(const std::string& path, const AnimationSettings& settings) {
  requireDescribed(settings);
  const GltfMotion motion(path, settings);
  Mesh mesh;
  mesh.name = path;
  mesh.vertices = motion.rest();
  mesh.triangles = motion.triangles();
  validate(mesh);
  requireNearOrigin(mesh);
  return mesh;
}

std::vector<std::string> filesBeside(const std::string& path) {
  return isGltf(path) ? GltfFile(path).filesBeside() : std::vector<std::string>();
}

AnimationInfo readGltfInfo(const std::string& path) {
  const GltfFile file(path);
  const GltfNodes nodes = readGltfNodes(file);
  AnimationInfo info;
  info.format = "glTF";
  for (const int node : gltfBodies(nodes)) {
    const GltfBody body = readGltfBody(file, nodes, node);
    info.meshes.push_back({body.name, body.vertices.size(), body.stored, body.triangles.size(),
                           body.joints.size(), body.targets.size()});
  }
  for (const GltfClip& clip : readGltfClips(file, nodes))
    info.animations.push_back({clip.name, clip.start(), clip.end()});
  return info;
}

}  // namespace innermap
