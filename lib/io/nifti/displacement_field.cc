// Displacement fields as medical programs read them.
#include <openvdb/tools/ValueTransformer.h>

#include "innermap/io/volume_texture.h"
#include "io/volume/detail/volume_formats.h"

namespace innermap {

VolumeTextureResult writeDisplacementField(const std::string& path,
                                           const openvdb::Vec3SGrid& displacement) {
  const openvdb::Vec3SGrid::Ptr lps = displacement.deepCopy();
  openvdb::tools::foreach (lps->beginValueAll(), [](const auto& value) {
    const openvdb::Vec3s v = *value;
    value.setValue(value.isValueOn() ? openvdb::Vec3s(-v.x(), -v.y(), v.z()) : openvdb::Vec3s(0));
  });
  return writeNifti(path, {lps}, {});
}

}  // namespace innermap
