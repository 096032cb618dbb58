// The page of an output folder, from its files.
#pragma once

#include <string>

#include "report/page/page.h"

namespace innermap::tool {

// Adds the surfaces and sections that belong to a report: map.ply and .vdb files of the folder, the
// meshes that the report names. What cannot be shown is said in the page.
void showOutputs(Page& page, const std::string& report, const std::string& folder);

}  // namespace innermap::tool
