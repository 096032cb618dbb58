// What of a glTF file moves a mesh: nodes, animations, and the mesh itself.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "innermap/mesh/mesh.h"
#include "mesh/animation/detail/gltf_file.h"

namespace innermap {

struct GltfAffine {
  Mat3 linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 shift;
};
inline Vec3 operator*(const GltfAffine& a, const Vec3& p) { return a.linear * p + a.shift; }
inline GltfAffine operator*(const GltfAffine& a, const GltfAffine& b) {
  return {product(a.linear, b.linear), a * b.shift};
}
GltfAffine gltfAffine(const double* columns);  // 16 numbers, column by column

struct GltfNode {
  std::string name;
  std::vector<int> children;
  int parent = -1, mesh = -1, skin = -1;
  // Translation, rotation as a quaternion x y z w, scale, weights of the mesh's morph targets.
  std::array<std::vector<double>, 4> values{
      std::vector<double>{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}, {}};
  std::optional<GltfAffine> matrix;  // in place of the first three
};

// One of a node's values over time.
struct GltfChannel {
  enum class Interpolation { step, linear, cubic };
  int node = 0, value = 0;  // of GltfNode::values
  Interpolation interpolation = Interpolation::linear;
  std::vector<double> times;  // seconds, ascending
  std::vector<double> keys;   // #times x width; cubic: tangent in, value, tangent out of each

  // Before the first and after the last key: theirs.
  std::vector<double> at(double time) const;
};

struct GltfClip {
  std::string name;
  std::vector<GltfChannel> channels;
  double start() const;  // seconds
  double end() const;
};

struct GltfNodes {
  std::vector<GltfNode> nodes;
  std::vector<int> order;  // parents before their children

  std::vector<GltfAffine> worlds() const;  // of each node
};

// Both throw FileError.
GltfNodes readGltfNodes(const GltfFile& file);
std::vector<GltfClip> readGltfClips(const GltfFile& file, const GltfNodes& nodes);

// A mesh at a node. What is alike in place, targets and weights is one vertex: files split vertices
// where normals or texture coordinates differ.
struct GltfBody {
  int node = 0;
  std::string name;        // the node's, or the mesh's
  std::size_t stored = 0;  // vertices in the file
  Points vertices;         // of the mesh itself
  std::vector<Triangle> triangles;
  std::vector<Points> targets;  // what each adds
  // The joints that pull at a vertex: [influenceStart[v], influenceStart[v + 1]); none without
  // skin.
  struct Influence {
    int joint = 0;  // of `joints`
    double weight = 0;
  };
  std::vector<Influence> influences;
  std::vector<std::size_t> influenceStart;
  std::vector<int> joints;               // nodes
  std::vector<GltfAffine> inverseBinds;  // of each joint

  // Where the vertices are when the nodes are so; without `posed` joints as they were bound.
  Points placed(const GltfNodes& nodes, bool posed) const;
};

// The nodes that bear meshes; the one of this name, or whose mesh has it; empty: the only one.
std::vector<int> gltfBodies(const GltfNodes& nodes);
int chooseGltfBody(const GltfFile& file, const GltfNodes& nodes, const std::string& name);
// Throw FileError.
GltfBody readGltfBody(const GltfFile& file, const GltfNodes& nodes, int node);

}  // namespace innermap
