#include "commands.h"

namespace innermap::tool {

std::vector<Command> allCommands() {
  return {makeCheckCommand(), makeVoxelizeCommand(), makeSliceCommand(), makeInfoCommand(),
          makeHelpCommand()};
}

}  // namespace innermap::tool
