// Temporary files and small grids for the tests of io/.
#pragma once

#include <openvdb/openvdb.h>
#include <signal.h>
#include <sys/resource.h>

#include <fstream>
#include <string>

#include "core/temporary_folder.h"

namespace innermap::test {

inline void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// In a folder that goes with the program.
inline std::string pathOf(const std::string& name) {
  static const TemporaryFolder folder;
  return folder.file(name);
}

inline std::string written(const std::string& name, const std::string& bytes) {
  write(pathOf(name), bytes);
  return pathOf(name);
}

// While it lives, no file grows over so many bytes, as on a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

// Level set of a ball about `centre` (index space), half width 3.
inline openvdb::FloatGrid::Ptr ball(double radius, openvdb::Vec3d centre, double voxel) {
  openvdb::initialize();
  auto grid = openvdb::FloatGrid::create(static_cast<float>(3 * voxel));
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  const int reach = static_cast<int>(radius) + 4;
  auto accessor = grid->getAccessor();
  const openvdb::Coord middle = openvdb::Coord::round(centre);
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -reach; k <= reach; ++k) {
        const openvdb::Coord at = middle.offsetBy(i, j, k);
        const double d = (at.asVec3d() - centre).length() - radius;
        if (std::abs(d) < 3)
          accessor.setValue(at, static_cast<float>(d * voxel));
        else if (d < 0)
          accessor.setValueOff(at, static_cast<float>(-3 * voxel));
      }
  return grid;
}

// A grid of any type whose value at (x, y, z) is fill(x, y, z) within a block.
template <class Grid, class Fill>
typename Grid::Ptr block(const std::string& name, openvdb::CoordBBox box, const Fill& fill,
                         double voxel = 1) {
  openvdb::initialize();
  auto grid = Grid::create();
  grid->setName(name);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  auto accessor = grid->getAccessor();
  for (auto at = box.begin(); at != box.end(); ++at) accessor.setValue(*at, fill(*at));
  return grid;
}

// 18 x 8 x 12 voxels, and grids on it of voxels of 0.5.
inline const openvdb::CoordBBox kBox(openvdb::Coord(-5, 2, 30), openvdb::Coord(12, 9, 41));

inline float scalarAt(const openvdb::Coord& c) {
  return float(c.x() + 100 * c.y()) + 0.125f * float(c.z());
}

inline openvdb::FloatGrid::Ptr scalar(const std::string& name = "jacobian") {
  return block<openvdb::FloatGrid>(name, kBox, scalarAt, 0.5);
}

// Each voxel's own indices.
template <class Grid = openvdb::Vec3SGrid>
typename Grid::Ptr vectors(const std::string& name, const openvdb::CoordBBox& box = kBox) {
  using Number = typename Grid::ValueType::ValueType;
  return block<Grid>(
      name, box,
      [](auto c) { return typename Grid::ValueType(Number(c.x()), Number(c.y()), Number(c.z())); },
      0.5);
}

}  // namespace innermap::test
