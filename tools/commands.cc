#include "commands.h"

namespace innermap::tool {

std::vector<Command> allCommands() {
  return {makeMapCommand(),     makeFitCommand(),   makeEvaluateCommand(),
          makeTextureCommand(), makeCheckCommand(), makeVoxelizeCommand(),
          makeSliceCommand(),   makeInfoCommand(),  makeHelpCommand()};
}

}  // namespace innermap::tool
