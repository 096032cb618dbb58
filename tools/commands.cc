#include "commands.h"

namespace innermap::tool {

std::vector<Command> allCommands() {
  return {makeMapCommand(),
          makeCorrespondCommand(),
          makeSphereCommand(),
          makeFitCommand(),
          makeEvaluateCommand(),
          makeSequenceCommand(),
          makeDeformCommand(),
          makeTextureCommand(),
          makePushCommand(),
          makePullCommand(),
          makeTransferDistanceCommand(),
          makeCheckCommand(),
          makeVoxelizeCommand(),
          makeSliceCommand(),
          makeExportCommand(),
          makeImportCommand(),
          makeInfoCommand(),
          makeHelpCommand()};
}

}  // namespace innermap::tool
