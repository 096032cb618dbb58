#include "jobs/texture_need.h"

#include <fmt/format.h>

namespace innermap {

MemoryNeed textureNeed(const SolidTexturePlan& plan, const std::string& image,
                       const std::vector<UdimTile>& tiles) {
  return {"the solid texture", plan.memory + (image.empty() ? 0 : textureImageMemory(image, tiles)),
          fmt::format("use a {{voxel_size}} above {:.3g}, fewer {{charges}} or raise "
                      "{{max_memory}}",
                      1.5 * plan.voxelSize)};
}

}  // namespace innermap
