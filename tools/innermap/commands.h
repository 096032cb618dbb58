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
Command makeJoinCommand();
Command makeVerifyCommand();
Command makeInfoCommand();
Command makeHelpCommand();

std::vector<Command> allCommands();

// Names under a title, as the help has them.
struct Topic {
  std::string title;
  std::vector<std::string> commands;
};
std::vector<Topic> commandTopics();  // each command is in one

// Throws UsageError with the nearest name.
Command findCommand(const std::string& name);

// The commands' texts come from their tables.
std::string shortHelp();  // of `innermap` alone: what most people need
std::string generalHelp();
std::string commandHelp(const Command& command, bool all);  // all: also what is advanced
std::string markdownHelp();                                 // docs/commands.md
std::string usageLine(const Command& command);
std::string leftOf(const Option& option);     // "-o, --output FILE"
std::string valueText(const Option& option);  // "world units; above 0", or ""

// Completion of the command line in "bash", "zsh" or "fish".
std::string completionScript(const std::string& shell);

// A page in man(7)'s language, of a command or of the program.
std::string manPage(const Command& command);
std::string generalManPage();

}  // namespace innermap::tool
