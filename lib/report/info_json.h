// What `innermap info --json` says of each kind of file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "innermap/field/field_file.h"
#include "innermap/io/exr_slices.h"
#include "innermap/io/vdb_file.h"
#include "innermap/io/volume_texture.h"
#include "innermap/mesh/mesh.h"
#include "innermap/mesh/mesh_file.h"

namespace innermap {

std::string infoJson(const std::string& path, const VdbInfo& info);
std::string infoJson(const std::string& path, const std::vector<ExrPart>& parts,
                     const std::optional<VolumeTextureInfo>& volume);
std::string infoJson(const std::string& path, const FieldFile& file);
std::string infoJson(const std::string& path, const Mesh& mesh);
std::string infoJson(const std::string& path, const AnimationInfo& info);
std::string infoJson(const std::string& path, const VolumeFileInfo& info);

}  // namespace innermap
