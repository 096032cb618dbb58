#include "mesh/detail/scene_files.h"

#include "core/file_bytes.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"

namespace innermap {

void requireNoScene(const std::string& path) {
  constexpr std::pair<const char*, const char*> kScenes[] = {{".abc", "Alembic"}, {".usd", "USD"},
                                                             {".usda", "USD"},    {".usdc", "USD"},
                                                             {".usdz", "USD"},    {".fbx", "FBX"}};
  const std::string extension = extensionOf(path);
  for (const auto& [ending, format] : kScenes)
    if (equalsIgnoringCase(extension, ending))
      throw FileError(path, std::string("is ") + format +
                                ", which is not read; export the mesh at rest as .obj, and its "
                                "animation as .mdd or .pc2, or both as glTF");
}

}  // namespace innermap
