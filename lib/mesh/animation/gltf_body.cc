// Meshes of glTF files, with their vertices made one again where the file splits them.
#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "core/text_scanner.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "mesh/animation/detail/gltf_scene.h"

namespace innermap {
namespace {

using Json = GltfFile::Json;
using Influences = std::vector<GltfBody::Influence>;

// As in the file.
struct Split {
  Points vertices;
  std::vector<Points> targets;
  std::vector<Influences> influences;  // empty without skin
  std::vector<Triangle> triangles;
};

Points pointsOf(const GltfFile::Numbers& numbers) {
  Points out(numbers.count);
  for (std::size_t i = 0; i < numbers.count; ++i)
    out[i] = {numbers.at(i)[0], numbers.at(i)[1], numbers.at(i)[2]};
  return out;
}

int attribute(const GltfFile& file, const Json& attributes, const std::string& name) {
  return file.index(attributes, name.c_str(), file.list(file.root(), "accessors").size());
}

void addInfluences(const GltfFile& file, const Json& attributes, std::size_t count,
                   std::size_t joints, Split& split) {
  const std::size_t before = split.influences.size();
  split.influences.resize(before + count);
  for (int set = 0;; ++set) {
    const int joint = attribute(file, attributes, fmt::format("JOINTS_{}", set));
    const int weight = attribute(file, attributes, fmt::format("WEIGHTS_{}", set));
    if (joint < 0 || weight < 0) break;
    const auto js = file.read(joint, "VEC4", count), ws = file.read(weight, "VEC4", count);
    for (std::size_t v = 0; v < count; ++v)
      for (int k = 0; k < 4; ++k) {
        const double w = ws.at(v)[k], j = js.at(v)[k];
        if (!(w > 0)) continue;
        if (!(j >= 0 && j < static_cast<double>(joints)))
          file.fail(
              fmt::format("a vertex hangs on joint {} of {}: damaged; export it again", j, joints));
        split.influences[before + v].push_back({static_cast<int>(j), w});
      }
  }
  for (std::size_t v = before; v < split.influences.size(); ++v) {
    Influences& all = split.influences[v];
    double sum = 0;
    for (const auto& i : all) sum += i.weight;
    if (!(sum > 0))
      file.fail("has a skinned mesh with vertices that hang on no joint; give each a weight");
    for (auto& i : all) i.weight /= sum;
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return std::pair(a.joint, a.weight) < std::pair(b.joint, b.weight);
    });
  }
}

void addTriangles(const GltfFile& file, const Json& primitive, int first, std::size_t count,
                  Split& split) {
  if (file.index(primitive, "mode", 7, 4) != 4)
    file.fail("has a mesh of strips, lines or points; export it as triangles");
  const int indices = file.index(primitive, "indices", file.list(file.root(), "accessors").size());
  std::vector<double> corners;
  if (indices >= 0)
    corners = file.read(indices, "SCALAR").values;
  else
    for (std::size_t i = 0; i < count; ++i) corners.push_back(static_cast<double>(i));
  if (corners.size() % 3 != 0) file.fail("has a triangle without all corners: damaged");
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    Triangle t;
    for (int k = 0; k < 3; ++k) {
      const double corner = corners[i + k];
      if (!(corner >= 0 && corner < static_cast<double>(count)))
        file.fail("has a triangle with a vertex out of range: damaged; export it again");
      t[k] = first + static_cast<int>(corner);
    }
    split.triangles.push_back(t);
  }
}

void addPrimitive(const GltfFile& file, const Json& primitive, std::size_t joints, bool isFirst,
                  Split& split) {
  const Json attributes =
      primitive.is_object() ? primitive.value("attributes", Json::object()) : Json::object();
  const int position = attribute(file, attributes, "POSITION");
  if (position < 0) file.fail("has a mesh without places (POSITION); export it again");
  const Points places = pointsOf(file.read(position, "VEC3"));
  const int first = static_cast<int>(split.vertices.size());
  requireCountable(file.path(), split.vertices.size() + places.size());
  const Json& targets = file.list(primitive, "targets");
  if (isFirst) split.targets.resize(targets.size());
  if (split.targets.size() != targets.size())
    file.fail("has a mesh whose parts have other morph targets: damaged; export it again");
  constexpr std::uint64_t kPlace = 3 * sizeof(Vec3);  // read, kept, and its key
  requireMemory("reading " + file.path(),
                kPlace * (split.vertices.size() + places.size()) * (targets.size() + 2),
                std::min(memoryLimit(), availableMemory()), "use a coarser mesh");
  split.vertices.insert(split.vertices.end(), places.begin(), places.end());
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const int moved = attribute(file, targets[t], "POSITION");
    Points added(places.size());
    if (moved >= 0) added = pointsOf(file.read(moved, "VEC3", places.size()));
    split.targets[t].insert(split.targets[t].end(), added.begin(), added.end());
  }
  if (joints > 0) addInfluences(file, attributes, places.size(), joints, split);
  addTriangles(file, primitive, first, places.size(), split);
}

// All that decides where a vertex goes.
std::string keyOf(const Split& split, std::size_t v) {
  std::string key;
  const auto add = [&](double x) {
    const double number = x + 0.0;  // no negative zero
    key.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  for (int a = 0; a < 3; ++a) add(split.vertices[v][a]);
  for (const Points& target : split.targets)
    for (int a = 0; a < 3; ++a) add(target[v][a]);
  if (!split.influences.empty())
    for (const auto& i : split.influences[v]) {
      add(i.joint);
      add(i.weight);
    }
  return key;
}

void weld(const Split& split, GltfBody& body) {
  std::unordered_map<std::string, int> seen;
  std::vector<int> number(split.vertices.size());
  body.targets.resize(split.targets.size());
  body.influenceStart.push_back(0);
  for (std::size_t v = 0; v < split.vertices.size(); ++v) {
    if (v % 1024 == 0) throwIfCancelled();
    const auto [at, isNew] = seen.emplace(keyOf(split, v), static_cast<int>(body.vertices.size()));
    number[v] = at->second;
    if (!isNew) continue;
    body.vertices.push_back(split.vertices[v]);
    for (std::size_t t = 0; t < split.targets.size(); ++t)
      body.targets[t].push_back(split.targets[t][v]);
    if (split.influences.empty()) continue;
    body.influences.insert(body.influences.end(), split.influences[v].begin(),
                           split.influences[v].end());
    body.influenceStart.push_back(body.influences.size());
  }
  for (const Triangle& t : split.triangles) {
    const Triangle one{number[t[0]], number[t[1]], number[t[2]]};
    if (one[0] != one[1] && one[1] != one[2] && one[2] != one[0]) body.triangles.push_back(one);
  }
}

void readSkin(const GltfFile& file, const Json& skin, const GltfNodes& nodes, GltfBody& body) {
  for (const Json& joint : file.list(skin, "joints"))
    body.joints.push_back(file.index(joint, nodes.nodes.size(), "a joint"));
  if (body.joints.empty()) file.fail("has a skin without joints: damaged; export it again");
  const int binds =
      file.index(skin, "inverseBindMatrices", file.list(file.root(), "accessors").size());
  body.inverseBinds.resize(body.joints.size());
  if (binds < 0) return;
  const GltfFile::Numbers matrices = file.read(binds, "MAT4");
  if (matrices.count < body.joints.size())
    file.fail("has fewer bind matrices than joints: damaged; export it again");
  for (std::size_t i = 0; i < body.joints.size(); ++i)
    body.inverseBinds[i] = gltfAffine(matrices.at(i));
}

}  // namespace

std::vector<int> gltfBodies(const GltfNodes& nodes) {
  std::vector<int> out;
  for (std::size_t i = 0; i < nodes.nodes.size(); ++i)
    if (nodes.nodes[i].mesh >= 0) out.push_back(static_cast<int>(i));
  return out;
}

int chooseGltfBody(const GltfFile& file, const GltfNodes& nodes, const std::string& name) {
  const Json& meshes = file.list(file.root(), "meshes");
  std::vector<int> found;
  std::vector<std::string> names;
  for (const int node : gltfBodies(nodes)) {
    const GltfNode& n = nodes.nodes[node];
    const std::string mesh = file.text(meshes[n.mesh], "name");
    names.push_back(inQuotes(n.name.empty() ? mesh : n.name));
    if (name.empty() || n.name == name || mesh == name) found.push_back(node);
  }
  if (names.empty()) file.fail("has no mesh in its scene");
  if (names.size() > 20) {
    names.resize(20);
    names.push_back("...");
  }
  if (found.empty())
    file.fail(fmt::format("has no mesh {}; there are {}", inQuotes(name), fmt::join(names, ", ")));
  if (found.size() > 1)
    file.fail(fmt::format("has several meshes: {}; choose one by --mesh", fmt::join(names, ", ")));
  return found.front();
}

GltfBody readGltfBody(const GltfFile& file, const GltfNodes& nodes, int at) {
  GltfBody body;
  body.node = at;
  const GltfNode& node = nodes.nodes[body.node];
  const Json& mesh = file.list(file.root(), "meshes")[node.mesh];
  body.name = node.name.empty() ? file.text(mesh, "name") : node.name;
  if (node.skin >= 0) readSkin(file, file.list(file.root(), "skins")[node.skin], nodes, body);
  Split split;
  bool isFirst = true;
  for (const Json& primitive : file.list(mesh, "primitives")) {
    addPrimitive(file, primitive, body.joints.size(), isFirst, split);
    isFirst = false;
  }
  body.stored = split.vertices.size();
  weld(split, body);
  if (body.triangles.empty()) file.fail("has a mesh without triangles");
  return body;
}

Points GltfBody::placed(const GltfNodes& nodes, bool posed) const {
  Points out = vertices;
  const std::vector<double>& weights = nodes.nodes[node].values[3];
  for (std::size_t t = 0; t < std::min(targets.size(), weights.size()); ++t)
    for (std::size_t v = 0; v < out.size(); ++v) out[v] += weights[t] * targets[t][v];
  if (!joints.empty() && !posed) return out;
  const std::vector<GltfAffine> worlds = nodes.worlds();
  if (joints.empty()) {
    for (Vec3& p : out) p = worlds[node] * p;
    return out;
  }
  std::vector<GltfAffine> pulls(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) pulls[j] = worlds[joints[j]] * inverseBinds[j];
  for (std::size_t v = 0; v < out.size(); ++v) {
    Vec3 sum;
    for (std::size_t i = influenceStart[v]; i < influenceStart[v + 1]; ++i)
      sum += influences[i].weight * (pulls[influences[i].joint] * out[v]);
    out[v] = sum;
  }
  return out;
}

}  // namespace innermap
