#include "mesh/animation/detail/gltf_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace innermap {
namespace {

constexpr const char* kValues[] = {"translation", "rotation", "scale", "weights"};
constexpr std::size_t kWidths[] = {3, 4, 3, 0};
constexpr int kRotation = 1;

void normalize(std::vector<double>& q) {
  double sum = 0;
  for (const double x : q) sum += x * x;
  if (!(sum > 0)) q = {0, 0, 0, 1};
  for (double& x : q) x /= sum > 0 ? std::sqrt(sum) : 1;
}

// Ken Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985; the shorter way.
std::vector<double> slerp(std::vector<double> a, std::vector<double> b, double t) {
  normalize(a);
  normalize(b);
  double cosine = 0;
  for (int k = 0; k < 4; ++k) cosine += a[k] * b[k];
  const double sign = cosine < 0 ? -1 : 1, angle = std::acos(std::min(std::abs(cosine), 1.0));
  constexpr double kSmall = 1e-6;
  const double u = angle < kSmall ? 1 - t : std::sin((1 - t) * angle) / std::sin(angle);
  const double v = angle < kSmall ? t : std::sin(t * angle) / std::sin(angle);
  for (int k = 0; k < 4; ++k) a[k] = u * a[k] + sign * v * b[k];
  normalize(a);
  return a;
}

GltfAffine localOf(const GltfNode& node) {
  if (node.matrix) return *node.matrix;
  std::vector<double> q = node.values[kRotation];
  normalize(q);
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  GltfAffine out;
  out.linear = {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                 {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                 {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
  for (auto& row : out.linear)
    for (int c = 0; c < 3; ++c) row[c] *= node.values[2][c];
  out.shift = {node.values[0][0], node.values[0][1], node.values[0][2]};
  return out;
}

// Parents before children. Throws for nodes with two parents, and for those that are their own
// ancestors, which no order reaches.
void sortNodes(const GltfFile& file, GltfNodes& nodes) {
  for (std::size_t i = 0; i < nodes.nodes.size(); ++i)
    for (const int child : nodes.nodes[i].children) {
      int& parent = nodes.nodes[child].parent;
      if (parent >= 0) file.fail(fmt::format("node {} has two parents: damaged", child));
      parent = static_cast<int>(i);
    }
  for (std::size_t i = 0; i < nodes.nodes.size(); ++i)
    if (nodes.nodes[i].parent < 0) nodes.order.push_back(static_cast<int>(i));
  for (std::size_t i = 0; i < nodes.order.size(); ++i)
    for (const int child : nodes.nodes[nodes.order[i]].children) nodes.order.push_back(child);
  if (nodes.order.size() != nodes.nodes.size())
    file.fail("has nodes that are their own ancestors: damaged; export it again");
}

GltfChannel readChannel(const GltfFile& file, const GltfFile::Json& sampler, int node, int value) {
  const std::size_t accessors = file.list(file.root(), "accessors").size();
  const int input = file.index(sampler, "input", accessors);
  const int output = file.index(sampler, "output", accessors);
  if (input < 0 || output < 0) file.fail("has an animation without keys: damaged");
  GltfChannel channel;
  channel.node = node;
  channel.value = value;
  const std::string how = file.text(sampler, "interpolation");
  if (how == "STEP") channel.interpolation = GltfChannel::Interpolation::step;
  if (how == "CUBICSPLINE") channel.interpolation = GltfChannel::Interpolation::cubic;
  channel.times = file.read(input, "SCALAR").values;
  for (std::size_t i = 1; i < channel.times.size(); ++i)
    if (!(channel.times[i] > channel.times[i - 1]))
      file.fail("has an animation whose times do not ascend: damaged; export it again");
  const char* type = value == kRotation ? "VEC4" : value == 3 ? "SCALAR" : "VEC3";
  channel.keys = file.read(output, type).values;
  const std::size_t keys =
      channel.times.size() * (channel.interpolation == GltfChannel::Interpolation::cubic ? 3 : 1);
  if (channel.keys.size() % keys != 0 ||
      (kWidths[value] > 0 && channel.keys.size() != keys * kWidths[value]))
    file.fail("has an animation with other numbers of times and values: damaged");
  return channel;
}

}  // namespace

GltfAffine gltfAffine(const double* m) {
  GltfAffine out;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out.linear[r][c] = m[4 * c + r];
    out.shift[r] = m[12 + r];
  }
  return out;
}

std::vector<double> GltfChannel::at(double time) const {
  const std::size_t parts = interpolation == Interpolation::cubic ? 3 : 1;
  const std::size_t width = keys.size() / times.size() / parts;
  // part: of cubic keys, 0 the tangent in, 1 the value, 2 the tangent out.
  const auto key = [&](std::size_t k, std::size_t part) {
    const auto begin = keys.begin() + static_cast<std::ptrdiff_t>((k * parts + part) * width);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(width));
  };
  const std::size_t middle = parts / 2;
  // Keys' times are floats: one of a frame may come a hair after the frame's own time.
  constexpr double kHair = 1e-6;
  const double reached =
      interpolation == Interpolation::step ? time + kHair * std::max(1.0, std::abs(time)) : time;
  const auto above = std::upper_bound(times.begin(), times.end(), reached);
  if (above == times.begin()) return key(0, middle);
  if (above == times.end()) return key(times.size() - 1, middle);
  const auto next = static_cast<std::size_t>(above - times.begin());
  std::vector<double> a = key(next - 1, middle);
  if (interpolation == Interpolation::step) return a;
  const std::vector<double> b = key(next, middle);
  const double span = times[next] - times[next - 1], t = (time - times[next - 1]) / span;
  if (interpolation == Interpolation::linear) {
    if (value == kRotation) return slerp(a, b, t);
    for (std::size_t k = 0; k < width; ++k) a[k] += t * (b[k] - a[k]);
    return a;
  }
  const std::vector<double> out = key(next - 1, 2), in = key(next, 0);
  for (std::size_t k = 0; k < width; ++k)
    a[k] = (2 * t * t * t - 3 * t * t + 1) * a[k] + span * (t * t * t - 2 * t * t + t) * out[k] +
           (3 * t * t - 2 * t * t * t) * b[k] + span * (t * t * t - t * t) * in[k];
  if (value == kRotation) normalize(a);
  return a;
}

double GltfClip::start() const {
  double first = channels.front().times.front();
  for (const GltfChannel& c : channels) first = std::min(first, c.times.front());
  return first;
}

double GltfClip::end() const {
  double last = channels.front().times.back();
  for (const GltfChannel& c : channels) last = std::max(last, c.times.back());
  return last;
}

std::vector<GltfAffine> GltfNodes::worlds() const {
  std::vector<GltfAffine> out(nodes.size());
  for (const int i : order) {
    out[i] = localOf(nodes[i]);
    if (nodes[i].parent >= 0) out[i] = out[nodes[i].parent] * out[i];
  }
  return out;
}

GltfNodes readGltfNodes(const GltfFile& file) {
  const GltfFile::Json& all = file.list(file.root(), "nodes");
  const std::size_t meshes = file.list(file.root(), "meshes").size();
  const std::size_t skins = file.list(file.root(), "skins").size();
  GltfNodes out;
  for (const GltfFile::Json& json : all) {
    GltfNode node;
    node.name = file.text(json, "name");
    node.mesh = file.index(json, "mesh", meshes);
    node.skin = file.index(json, "skin", skins);
    for (const GltfFile::Json& child : file.list(json, "children"))
      node.children.push_back(file.index(child, all.size(), "a node's child"));
    if (node.mesh >= 0)
      node.values[3] = file.numbers(file.list(file.root(), "meshes")[node.mesh], "weights", 0);
    for (int v = 0; v < 4; ++v)
      if (const std::vector<double> values = file.numbers(json, kValues[v], kWidths[v]);
          !values.empty())
        node.values[v] = values;
    if (const std::vector<double> matrix = file.numbers(json, "matrix", 16); !matrix.empty())
      node.matrix = gltfAffine(matrix.data());
    out.nodes.push_back(std::move(node));
  }
  sortNodes(file, out);
  return out;
}

std::vector<GltfClip> readGltfClips(const GltfFile& file, const GltfNodes& nodes) {
  std::vector<GltfClip> clips;
  for (const GltfFile::Json& json : file.list(file.root(), "animations")) {
    GltfClip clip;
    clip.name = file.text(json, "name");
    const GltfFile::Json& samplers = file.list(json, "samplers");
    for (const GltfFile::Json& channel : file.list(json, "channels")) {
      const int sampler = file.index(channel, "sampler", samplers.size());
      const GltfFile::Json target =
          channel.is_object() ? channel.value("target", GltfFile::Json()) : GltfFile::Json();
      const int node = file.index(target, "node", nodes.nodes.size());
      const std::string path = file.text(target, "path");
      const auto value = std::find(std::begin(kValues), std::end(kValues), path);
      if (sampler < 0 || node < 0 || value == std::end(kValues)) continue;  // of an extension
      if (nodes.nodes[node].matrix && path != "weights")
        file.fail(fmt::format("node {} has a matrix and is animated: damaged", node));
      clip.channels.push_back(readChannel(file, samplers[sampler], node,
                                          static_cast<int>(value - std::begin(kValues))));
    }
    if (!clip.channels.empty()) clips.push_back(std::move(clip));
  }
  return clips;
}

}  // namespace innermap
