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

namespace {

// Also those of parts that this build leaves out.
std::vector<Topic> everyTopic() {
  return {{"maps", {"map", "correspond", "sphere", "fit", "evaluate", "verify", "study"}},
          {"what goes through a map", {"push", "pull", "transfer-distance", "remesh"}},
          {"animation", {"sequence", "deform", "join"}},
          {"solids",
           {"check", "voxelize", "texture", "harmonic", "weights", "tetrahedralize",
            "hexahedralize", "polycube"}},
          {"files and pictures", {"info", "slice", "export", "import", "report"}},
          {"other", {"compare-fem"}}};
}

}  // namespace

std::vector<Topic> commandTopics() {
  std::vector<std::string> names;
  for (const Command& c : allCommands()) names.push_back(c.name());
  std::vector<Topic> topics = everyTopic();
  for (Topic& topic : topics) {
    std::vector<std::string> there;
    for (const std::string& name : topic.commands) {
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end()) continue;
      there.push_back(name);
      names.erase(found);
    }
    topic.commands = there;
  }
  std::vector<std::string>& others = topics.back().commands;
  others.insert(others.end(), names.begin(), names.end());
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
  for (const Topic& topic : everyTopic())
    if (std::count(topic.commands.begin(), topic.commands.end(), name) > 0)
      throw UsageError("this build leaves out '" + name +
                       "'; build with INNERMAP_TETRA and "
                       "INNERMAP_STUDY on");
  const bool option = name.compare(0, 1, "-") == 0;
  throw UsageError(std::string("unknown ") + (option ? "option" : "command") + " '" + name + "'" +
                   didYouMean(name, names) + (option ? "; options stand after the command" : "") +
                   "; see 'innermap --help'");
}

}  // namespace innermap::tool
