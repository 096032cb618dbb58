// Mesh files in: OBJ, PLY, OFF, STL, glTF; animations of a mesh: files of frames, point caches.
//
// The readers are our own. For PLY, OFF and STL no packaged reader keeps non-manifold faces, reads
// triangle strips and refuses a header that promises more than the file holds before memory is
// allocated for it. For OBJ the packaged tinyobjloader holds coordinates as floats, reads malformed
// numbers as zeros and does not refuse negative indices below the first vertex.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// ".obj" and so on, of the files that hold one mesh in one pose.
const std::vector<std::string>& meshExtensions();

// Reads by the extension (case-insensitive) .obj, .ply, .off, .stl, .glb, .gltf.
//
// Vertices keep the file's order and number, loose ones included. STL corners are welded where
// their coordinates are equal bit by bit, in order of first appearance (STL has no connectivity).
// Convex polygons are cut as a fan from their lowest vertex index, others by ear clipping in their
// mean plane. A polygon of fewer than three corners is an error.
//
// OBJ: v (with optional colour), vt, f with negative indices; groups and materials are ignored.
// PLY: ASCII, binary little and big endian, any numeric types; vertex x y z, red green blue (uchar
// or float), s t / u v; face vertex_indices or vertex_index; tristrips.
// OFF: OFF, COFF, NOFF, STOFF and comments. STL: ASCII and binary, told apart by size. glTF: as
// readRestPose(), of the only mesh.
//
// Throws FileError: missing file, unknown extension, wrong or truncated content (with the line or
// byte), counts beyond the file's size, indices out of range, NaN or infinite coordinates, no
// vertices or no faces. Colours are clamped to [0, 1].
Mesh readMesh(const std::string& path);

// Reads a mesh that must have the connectivity of `reference` (a pose, the target of a map) and
// takes over the reference's triangulation, so that a polygon is cut alike in all frames.
// Throws as readMesh; DataError when the number of vertices or any polygon differs, naming the
// first difference and saying that meshes of other connectivity need a correspondence first
// (surface/correspond.h).
Mesh readMeshLike(const std::string& path, const Mesh& reference);

struct TargetMesh {
  Mesh mesh;
  bool related = true;  // of the source's connectivity
};

// What a source is to be mapped onto: as readMeshLike() where the connectivity is the same, else as
// readMesh(). Throws FileError.
TargetMesh readTarget(const std::string& path, const Mesh& source);

// Mesh files out.

// Writes .ply (binary little endian, double) or .obj (digits that read back to the same number) by
// the extension: vertices, triangles, vertex colours (in .ply 8 bits each); OBJ also texture
// coordinates. The file appears whole or not at all. Throws FileError.
void writeMesh(const std::string& path, const Mesh& mesh);

// A number for each vertex, beside its place.
struct VertexProperty {
  std::string name;                                                     // one word, as in the file
  std::variant<std::vector<std::int32_t>, std::vector<double>> values;  // #V; `int` or `double`
};

struct PlyExtras {
  std::string comment;                     // one line of the header; empty: none
  std::vector<VertexProperty> properties;  // after the place and the colour, in this order
};

// As writeMesh() writes .ply, with further properties of the vertices. Throws DataError for a
// property that has not a number for each vertex; FileError.
void writePly(const std::string& path, const Mesh& mesh, const PlyExtras& extras);

// Axes and units: most files do not tell theirs.

enum class UpAxis { y, z };

struct SpaceSettings {
  // What input has: the axis that points up (without: y), and metres a unit (without: 1). glTF has
  // y up and metres; it is brought to these first.
  std::optional<UpAxis> up;
  std::optional<double> unitScale;
  // What output shall have; without, what input has.
  std::optional<UpAxis> outUp;
  std::optional<double> outUnitScale;

  bool given() const { return up || unitScale || outUp || outUnitScale; }
  UpAxis upOfOutput() const { return outUp.value_or(up.value_or(UpAxis::y)); }
  double unitOfOutput() const { return outUnitScale.value_or(unitScale.value_or(1)); }
};
std::vector<Setting> describe(SpaceSettings& settings);

// From one space to another: a turn about x by quarters, then a scaling.
struct Similarity {
  int quarters = 0;  // 1: y up becomes z up, (x, y, z) to (x, -z, y); -1: back
  double scale = 1;

  bool isIdentity() const { return quarters == 0 && scale == 1; }
  Vec3 turned(const Vec3& v) const {
    return quarters == 0 ? v : quarters > 0 ? Vec3{v.x, -v.z, v.y} : Vec3{v.x, v.z, -v.y};
  }
  Vec3 operator()(const Vec3& p) const { return scale * turned(p); }
  Mat3 matrix() const;
};

// Throw SettingError for a unit that is not above 0.
Similarity inputToOutput(const SpaceSettings& settings);
Similarity gltfToOutput(const SpaceSettings& settings);
void move(Points& points, const Similarity& by);

// As readMesh(path), in the space of output.
Mesh readMesh(const std::string& path, const SpaceSettings& space);

// Animations: the vertices of one mesh, frame by frame.

struct AnimationSettings {
  // Number of the first frame of a file that holds several; without, MDD's is 1, PC2's what its
  // header says, rounded, and glTF's the first from where its animation begins, frame 0 being at 0
  // seconds. The others follow one by one, in PC2 by its frames a sample.
  std::optional<int> firstFrame;
  double framesPerSecond = 24;  // that glTF is baked at
  // Of glTF: which frame is the rest pose, without it the pose in which the mesh was bound; names
  // of the mesh, or its node, and of the animation, where there are several; empty: all animations,
  // unless they move the same.
  std::optional<int> restFrame;
  std::string mesh, animation;
  SpaceSettings space;  // frames are in that of output
};
std::vector<Setting> describe(AnimationSettings& settings);  // without the space

// The frames of an animation; each is read when it is asked for.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  std::vector<std::int64_t> numbers;    // ascending, each once
  std::vector<std::string> unnumbered;  // files that are left out, having no number in their names
  std::vector<std::string> notes;       // on what was taken for what

  // The file that holds the frame at this place of `numbers`.
  virtual const std::string& path(std::size_t index) const = 0;
  // Its vertices, with the triangles of `rest`, which is in output's space: its vertices in the
  // same order; of glTF, whose files split and reorder them, those that are at the same places in
  // the file's rest pose or first frame. Throws as readMeshLike.
  virtual Mesh read(std::size_t index, const Mesh& rest) const = 0;
  // Tells whether the frame is still the one that a result was made from, as fingerprintOf (core).
  virtual std::string fingerprint(std::size_t index) const = 0;
  // Throws DataError when no frame can be one of this mesh, as far as that can be told at once.
  virtual void requireLike(const Mesh&) const {}
};

// By the ending: .mdd, .pc2; .glb, .gltf; either, which hold several frames.
bool isPointCache(const std::string& path);
bool isGltf(const std::string& path);
bool isAnimationFile(const std::string& path);

// paths: either files with a frame's number in each name, folders, and patterns with *, ?, #### or
// %04d; or one animation file. Throws FileError when one names nothing, has no number or that of
// another, or is damaged; SettingError; MemoryError; Cancelled.
std::unique_ptr<FrameSource> openFrames(const std::vector<std::string>& paths,
                                        const AnimationSettings& settings = {});

// The rest pose of a glTF file. Vertices that are split for their normals or texture coordinates,
// which are alike in place and in how they move, are one, so that the mesh closes. Throws likewise.
Mesh readRestPose(const std::string& path, const AnimationSettings& settings = {});

// The files that this one takes bytes from: of .gltf its buffers. Throws likewise.
std::vector<std::string> filesBeside(const std::string& path);

// What an animation file says of itself.
struct AnimationInfo {
  struct Body {
    std::string name;
    std::uint64_t vertices = 0, stored = 0, triangles = 0;  // stored: before they are made one
    std::uint64_t joints = 0, targets = 0;                  // of a skin; morph targets
  };
  struct Clip {
    std::string name;
    double start = 0, end = 0;  // seconds
  };
  std::string format;                    // "MDD" (LightWave), "PC2" (3ds Max) or "glTF"
  std::uint64_t frames = 0, points = 0;  // of point caches
  double start = 0, step = 0;            // of PC2, frames
  std::vector<float> seconds;            // of each frame of MDD
  std::vector<Body> meshes;              // of glTF
  std::vector<Clip> animations;
};

// Throws FileError for no such file, counts below 1, another size than they make; as openFrames.
AnimationInfo readAnimationInfo(const std::string& path);

struct PointCacheLayout {
  std::uint64_t points = 0;
  std::vector<std::int64_t> numbers;  // of the frames, ascending; in PC2 at even steps
  double framesPerSecond = 24;        // MDD's seconds count from its first frame
};

// Writes .mdd or .pc2 by the ending. frames: calls what it is given with the points of each frame,
// in order, where DataError is thrown for another number of points, or places beyond a float's. The
// file appears whole when it returns, or not at all. Throws what it throws; DataError when it gave
// fewer frames; FileError.
void writePointCache(const std::string& path, const PointCacheLayout& layout,
                     const std::function<void(const std::function<void(const Points&)>&)>& frames);

}  // namespace innermap
