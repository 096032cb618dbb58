// Files of whole scenes, which are not read.
#pragma once

#include <string>

namespace innermap {

// Throws FileError for the path of an Alembic, USD or FBX file, saying how to export its mesh and
// animation.
void requireNoScene(const std::string& path);

}  // namespace innermap
