#include "commands.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "spelling.h"

namespace innermap::tool {

std::vector<Command> allCommands() {
  constexpr Command (*kMakers[])() = {
    makeMapCommand,
    makeCorrespondCommand,
    makeSphereCommand,
    makeFitCommand,
    makeEvaluateCommand,
    makeVerifyCommand,
    makeSequenceCommand,
    makeDeformCommand,
    makeJoinCommand,
    makeHarmonicCommand,
    makeWeightsCommand,
    makeTextureCommand,
    makePushCommand,
    makePullCommand,
    makeTransferDistanceCommand,
    makeCheckCommand,
    makeVoxelizeCommand,
#if INNERMAP_TETRA
    makeTetrahedralizeCommand,
    makePolycubeCommand,
    makeHexahedralizeCommand,
    makeRemeshCommand,
    makeCompareFemCommand,
#endif
#if INNERMAP_STUDY
    makeStudyCommand,
#endif
    makeSliceCommand,
    makeExportCommand,
    makeImportCommand,
    makeInfoCommand,
    makeReportCommand,
    makeHelpCommand
  };
  std::vector<Command> out;
  out.reserve(std::size(kMakers));
  for (const auto make : kMakers) out.push_back(make());
  return out;
}

std::vector<Topic> commandTopics() {
  std::vector<Topic> topics = {
      {"maps", {"map", "correspond", "sphere", "fit", "evaluate", "verify", "study"}},
      {"what goes through a map", {"push", "pull", "transfer-distance", "remesh"}},
      {"animation", {"sequence", "deform", "join"}},
      {"solids",
       {"check", "voxelize", "texture", "harmonic", "weights", "tetrahedralize", "hexahedralize",
        "polycube"}},
      {"files and pictures", {"info", "slice", "export", "import", "report"}},
      {"other", {}}};
  const std::vector<Command> all = allCommands();
  const auto isLeftOut = [&](const std::string& name) {
    return std::none_of(all.begin(), all.end(), [&](const Command& c) { return c.name() == name; });
  };
  for (Topic& topic : topics)
    topic.commands.erase(std::remove_if(topic.commands.begin(), topic.commands.end(), isLeftOut),
                         topic.commands.end());
  for (const Command& c : all) {
    const auto has = [&](const Topic& topic) {
      return std::count(topic.commands.begin(), topic.commands.end(), c.name()) > 0;
    };
    if (std::none_of(topics.begin(), topics.end(), has)) topics.back().commands.push_back(c.name());
  }
  return topics;
}

Command findCommand(const std::string& name) {
  std::vector<std::string> names;
  std::vector<Command> all = allCommands();
  for (Command& c : all) {
    for (const std::string& spelling : spellings(c.name()))
      if (spelling == name) return std::move(c);
    names.push_back(c.name());
  }
  const bool option = name.compare(0, 1, "-") == 0;
  throw UsageError(std::string("unknown ") + (option ? "option" : "command") + " '" + name + "'" +
                   didYouMean(name, names) + (option ? "; options stand after the command" : "") +
                   "; see 'innermap --help'");
}

}  // namespace innermap::tool
