#include "readers.h"

#include <openvdb/openvdb.h>

#include <sstream>

#include "core/expect.h"
#include "core/file_bytes.h"
#include "innermap/core/memory.h"
#include "innermap/correspond/mesh_correspondence.h"
#include "innermap/field/field_file.h"
#include "innermap/io/exr_slices.h"
#include "innermap/io/geometry_file.h"
#include "innermap/io/pictures.h"
#include "innermap/io/vdb_file.h"
#include "innermap/io/volume_texture.h"
#include "innermap/mesh/mesh_file.h"
#include "report/detail/part_json.h"

namespace innermap::fuzz {
namespace {

// What readers may take where they are told; main.cc's limits on the process leave room for it.
constexpr std::uint64_t kMemory = std::uint64_t(8) << 20;

void mesh(const std::string& path) { readMesh(path); }

Mesh octahedron() {
  Mesh m;
  m.name = "octahedron";
  m.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  m.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                 {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return m;
}

// A correspondence, or a pose: a mesh of known connectivity, that of most of the corpus.
void pose(const std::string& path) { readMeshLike(path, octahedron()); }

// All frames of a point cache.
void frames(const std::string& path) {
  const MemoryLimit limit(kMemory);
  readAnimationInfo(path);
  const auto source = openFrames({path});
  for (std::size_t i = 0; i < source->numbers.size(); ++i) {
    source->fingerprint(i);
    source->read(i, octahedron());
  }
}

// Some frames of a glTF file, of its own rest pose.
void gltf(const std::string& path) {
  const MemoryLimit limit(kMemory);
  readAnimationInfo(path);
  const Mesh rest = readRestPose(path);
  const auto source = openFrames({path});
  constexpr std::size_t kMost = 5;
  for (std::size_t i = 0; i < std::min(source->numbers.size(), kMost); ++i) source->read(i, rest);
}

void groups(const std::string& path) { readGroups(path, readMesh(path)); }

void properties(const std::string& path) { readVertexProperties(path, {"s"}, readMesh(path)); }

void table(const std::string& path) { readVertexTable(path, octahedron()); }

// Every third point cut, and what uses it.
void cut(const Geometry& geometry, CarriedGeometry& carried) {
  const Elements& elements = geometry.elements;
  for (std::size_t i = 0; i < geometry.ownPoints; i += 3) carried.number[i] = -1;
  carried.points.cut = 1;
  int next = 0;
  for (int& number : carried.number)
    if (number >= 0) number = next++;
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (std::size_t k = elements.start[e]; k < elements.start[e + 1]; ++k) {
      const int point = elements.corners[k].point;
      if (point >= 0 && carried.number[static_cast<std::size_t>(point)] < 0 &&
          elements.kinds[e] != Elements::Kind::points)
        carried.stays[e] = 0;
    }
}

// Also written again, with all where it was and with points cut, which uses every index that was
// read.
void geometry(const std::string& path) {
  const MemoryLimit limit(kMemory + 160000000);  // what readGeometry plans for carrying
  const auto file = readGeometry(path);
  CarriedGeometry carried;
  const Geometry& g = file->geometry;
  carried.points.points = g.points;
  carried.points.fates.assign(g.points.size(), PointFate::carried);
  carried.points.jacobians.assign(g.points.size(), {{{1, 0.5, 0}, {0, 2, 0}, {0, 0.25, 1}}});
  carried.splats.opacity = SplatOpacity::mass;
  for (const Directions& d : g.directions) carried.directions.push_back(d.values);
  carried.ownPoints = g.ownPoints;
  for (std::size_t i = 0; i < g.ownPoints; ++i) carried.number.push_back(static_cast<int>(i));
  carried.stays.assign(g.elements.size(), 1);
  std::ostringstream out;
  file->write(path, carried, out);
  cut(g, carried);
  file->write(path, carried, out);
  file->inverted(carried);
  file->cappedOpacities(carried);
}

void landmarks(const std::string& path) { readLandmarks(path); }

void field(const std::string& path) {
  const FieldFile file = readField(path);
  const Vec3 origin;
  for (const HarmonicField& step : file.steps) {
    std::vector<double> values(step.channels()), gradients(3 * step.channels());
    step.evaluate(&origin, 1, values.data(), gradients.data());
  }
}

void vdb(const std::string& path) {
  describe(readVdbInfo(path), path, /*metadata=*/true);
  const MemoryLimit limit(kMemory);
  readVdb(path);
}

void exrInfo(const std::string& path) { describe(readExrInfo(path), path); }

// By what the file says, or else by what the options of `innermap import` would.
void volumeTexture(const std::string& path) {
  const MemoryLimit limit(processMemory(kMemory));
  volumeTextureReadNeed(path, {});
  readVolumeTexture(path);
}

// Wherever the file says its voxels are, and wherever it does not.
void scan(const std::string& path) {
  const MemoryLimit limit(processMemory(kMemory));
  VolumeTextureReadSettings settings;
  for (const bool asVoxels : {false, true}) {
    settings.asVoxels = asVoxels;
    try {
      volumeTextureReadNeed(path, settings);
      readVolumeTexture(path, settings);
    } catch (const Error&) {
      if (asVoxels) throw;
    }
  }
}

// What `innermap info` says of the formats that are not VDB or EXR.
void volumeInfo(const std::string& path) {
  const MemoryLimit limit(kMemory);
  describe(readVolumeFileInfo(path), path);
}

// What a share leaves of its run, or of a frame.
void part(const std::string& path) {
  const MemoryLimit limit(kMemory);
  const std::string content = readFileBytes(path, "a part").bytes;
  try {
    runJson(parseRun(path, content));
  } catch (const Error&) {
    partJson(parsePart(path, content, "r"), "r");
  }
}

void foreignVolumeTexture(const std::string& path) {
  const MemoryLimit limit(processMemory(kMemory));
  VolumeTextureReadSettings settings;
  settings.names = {"a"};
  settings.layout = VolumeLayout::atlas;
  settings.tiles = {2, 2};
  settings.voxelSize = 1;
  settings.background = 0;
  readVolumeTexture(path, settings);
}

void image(const std::string& path) {
  const MemoryLimit limit(kMemory);
  readImage(path);
}

}  // namespace

const std::vector<Reader>& readers() {
  static const std::vector<Reader> all{
      {"mesh-obj", "obj", mesh},
      {"mesh-ply", "ply", mesh},
      {"mesh-off", "off", mesh},
      {"mesh-stl", "stl", mesh},
      {"correspondence", "ply", pose},
      {"frames-mdd", "mdd", frames},
      {"frames-pc2", "pc2", frames},
      {"frames-glb", "glb", gltf},
      {"frames-gltf", "gltf", gltf},
      {"landmarks", "txt", landmarks},
      {"groups", "obj", groups},
      {"properties", "ply", properties},
      {"table", "csv", table},
      {"map", "map.ply", field},
      {"geometry-obj", "obj", geometry},
      {"geometry-ply", "ply", geometry},
      {"geometry-off", "off", geometry},
      {"geometry-stl", "stl", geometry},
      {"cells-vtu", "vtu", geometry},
      {"cells-msh", "msh", geometry},
      {"cells-mesh", "mesh", geometry},
      {"vdb", "vdb", vdb},
      {"exr-info", "exr", exrInfo},
      {"exr-volume", "exr", volumeTexture},
      {"exr-foreign", "exr", foreignVolumeTexture},
      {"nifti", "nii", scan},
      {"nifti-packed", "nii.gz", scan},
      {"info-nvdb", "nvdb", volumeInfo},
      {"info-vti", "vti", volumeInfo},
      {"info-dds", "dds", volumeInfo},
      {"info-usda", "usda", volumeInfo},
      {"part", "json", part},
      {"image-exr", "exr", image},
      {"image-png", "png", image},
      {"image-jpg", "jpg", image},
      {"image-tif", "tif", image},
  };
  return all;
}

}  // namespace innermap::fuzz
