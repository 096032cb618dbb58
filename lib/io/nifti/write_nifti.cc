// NIfTI files of a grid.
#include <fmt/format.h>

#include <ostream>

#include "core/file.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "io/nifti/detail/gzip.h"
#include "io/nifti/detail/nifti_header.h"
#include "io/volume/detail/dense_types.h"
#include "io/volume/detail/volume_formats.h"

namespace innermap {
namespace {

VolumePlan planOf(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings) {
  if (grids.size() > 1)
    throw DataError(
        fmt::format("there are {} grids, and a NIfTI file holds one; choose it by "
                    "--grids {}",
                    grids.size(), grids.front()->getName()));
  VolumePlan plan = makeDensePlan(grids, settings);
  for (int a = 0; a < 3; ++a)
    if (plan.lattice.size[a] > 32767)
      throw DataError(
          fmt::format("the box has {} voxels along an axis; NIfTI-1 holds 32767, "
                      "use a lower --resolution",
                      plan.lattice.size[a]));
  return plan;
}

std::string headerOf(const VolumePlan& plan) {
  const VolumeGrid& grid = plan.grids.front();
  const DenseType& type = denseType(grid.type);
  NiftiHeader header;
  header.dim = {grid.isVector() ? 5 : 3,
                plan.lattice.size.x(),
                plan.lattice.size.y(),
                plan.lattice.size.z(),
                1,
                grid.isVector() ? 3 : 1,
                1,
                1};
  header.datatype = type.nifti;
  header.intent = grid.isVector() ? kNiftiVector : 0;
  header.intentName = grid.name;
  openvdb::Mat4d place = plan.lattice.indexToWorld;
  place.setTranslation(place.transform(plan.lattice.origin.asVec3d()));
  return niftiHeaderBytes(header, type.bytes, place);
}

bool isPacked(const std::string& path) {
  return path.size() > 3 && equalsIgnoringCase(path.substr(path.size() - 3), ".gz");
}

using Sink = std::function<void(std::string_view)>;

// All values, x fastest; of a vector one component after the other.
void putValues(const VolumePlan& plan, const Sink& sink) {
  const DenseType& type = denseType(plan.grids.front().type);
  for (std::size_t c = 0; c < plan.grids.front().channels.size(); ++c)
    forSlices(plan, 0, 1, "writing the NIfTI file", [&](int, const SliceValues& values) {
      std::string bytes(values[c].size() * type.bytes, '\0');
      for (std::size_t i = 0; i < values[c].size(); ++i)
        type.put(values[c][i], &bytes[i * type.bytes]);
      sink(bytes);
    });
}

}  // namespace

VolumeTextureResult planNifti(const std::string& path, const openvdb::GridPtrVec& grids,
                              const VolumeTextureSettings& settings) {
  return denseResult(path, planOf(grids, settings));
}

std::uint64_t niftiMemory(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings) {
  return 2 * sliceMemory(planOf(grids, settings)) + (std::uint64_t(8) << 20);
}

VolumeTextureResult writeNifti(const std::string& path, const openvdb::GridPtrVec& grids,
                               const VolumeTextureSettings& settings) {
  const VolumePlan plan = planOf(grids, settings);
  writeWholeFile(path, [&](std::ostream& stream) {
    if (!isPacked(path)) {
      stream << headerOf(plan);
      return putValues(plan, [&](std::string_view bytes) { stream << bytes; });
    }
    GzipWriter gzip(stream);
    gzip.add(headerOf(plan));
    putValues(plan, [&](std::string_view bytes) { gzip.add(bytes); });
    gzip.finish();
  });
  return denseResult(path, plan);
}

}  // namespace innermap
