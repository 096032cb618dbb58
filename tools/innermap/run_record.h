// What every report says of the run itself: version, command line, settings, date and machine.
#pragma once

#include "command.h"

namespace innermap::tool {

// As the command was given, before it runs. What it finds out later, it adds by Context::used.
void recordRun(const Command& command, const CommonOptions& common, Report& report);

// "--voxel-size" or "MESH" as a key of reports: voxel_size, mesh.
std::string settingKey(const std::string& option);

}  // namespace innermap::tool
