// All commands, in the order of the help.
#pragma once

#include <vector>

#include "command.h"

namespace innermap::tool {

Command makeMapCommand();
Command makeCorrespondCommand();
Command makeSphereCommand();
Command makeFitCommand();
Command makeEvaluateCommand();
Command makeTextureCommand();
Command makeSequenceCommand();
Command makeDeformCommand();
Command makePushCommand();
Command makePullCommand();
Command makeCheckCommand();
Command makeVoxelizeCommand();
Command makeTetrahedralizeCommand();
Command makePolycubeCommand();
Command makeHexahedralizeCommand();
Command makeHarmonicCommand();
Command makeWeightsCommand();
Command makeRemeshCommand();
Command makeCompareFemCommand();
Command makeStudyCommand();
Command makeSliceCommand();
Command makeTransferDistanceCommand();
Command makeExportCommand();
Command makeImportCommand();
Command makeReportCommand();
Command makeInfoCommand();
Command makeHelpCommand();

std::vector<Command> allCommands();

// Throws UsageError with the nearest name.
Command findCommand(const std::string& name);

// Of innermap::tool's own; the commands' texts come from their tables.
std::string generalHelp();
std::string commandHelp(const Command& command);
std::string markdownHelp();  // docs/commands.md

}  // namespace innermap::tool
