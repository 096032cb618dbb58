// Animations of glTF files as frames.
#pragma once

#include <memory>
#include <string>

#include "innermap/mesh/mesh_file.h"

namespace innermap {

// As openFrames and readAnimationInfo of such a file.
std::unique_ptr<FrameSource> openGltfFrames(const std::string& path,
                                            const AnimationSettings& settings);
AnimationInfo readGltfInfo(const std::string& path);

}  // namespace innermap
