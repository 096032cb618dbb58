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
          makeHarmonicCommand(),
          makeWeightsCommand(),
          makeTextureCommand(),
          makePushCommand(),
          makePullCommand(),
          makeTransferDistanceCommand(),
          makeCheckCommand(),
          makeVoxelizeCommand(),
          makeTetrahedralizeCommand(),
          makePolycubeCommand(),
          makeHexahedralizeCommand(),
          makeRemeshCommand(),
          makeCompareFemCommand(),
          makeStudyCommand(),
          makeSliceCommand(),
          makeExportCommand(),
          makeImportCommand(),
          makeInfoCommand(),
          makeReportCommand(),
          makeHelpCommand()};
}

Command findCommand(const std::string& name) {
  std::vector<std::string> names;
  for (const Command& c : allCommands()) {
    if (c.name() == name) return c;
    names.push_back(c.name());
  }
  const bool option = name.compare(0, 1, "-") == 0;
  throw UsageError(std::string("unknown ") + (option ? "option" : "command") + " '" + name + "'" +
                   didYouMean(name, names) + (option ? "; options stand after the command" : "") +
                   "; see 'innermap --help'");
}

}  // namespace innermap::tool
