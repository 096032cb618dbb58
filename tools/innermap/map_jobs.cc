#include "map_jobs.h"

#include <algorithm>
#include <filesystem>

#include "commands.h"
#include "lists.h"

namespace innermap::tool {
namespace {

bool isCalled(const Option& option, const std::string& name) {
  const std::vector<std::string> former = commaList(option.formerName);
  return option.name == name || (!option.shortName.empty() && option.shortName == name) ||
         std::find(former.begin(), former.end(), name) != former.end();
}

const Option* findOption(const std::vector<Option>& options, const std::string& name) {
  const auto at = std::find_if(options.begin(), options.end(),
                               [&](const Option& o) { return isCalled(o, name); });
  return at == options.end() ? nullptr : &*at;
}

}  // namespace

MapCommands mapCommands(const std::vector<std::string>& arguments, const std::string& source,
                        const std::string& target, const std::string& output) {
  const std::filesystem::path folder(output);
  const std::string map = (folder / "map.ply").string();
  MapCommands out{{"innermap", "fit", source, target, "-o", map},
                  {"innermap", "evaluate", map, "-o", (folder / "map.vdb").string()}};
  CommonOptions common;
  const auto tableOf = [&](const char* name) { return allOptions(findCommand(name), common); };
  const std::vector<Option> own = tableOf("map"), fit = tableOf("fit"),
                            evaluate = tableOf("evaluate");
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    const std::string name = word.substr(0, word.find('='));
    const Option* option = word.size() > 1 && word[0] == '-' ? findOption(own, name) : nullptr;
    if (!option) continue;  // a mesh
    std::vector<std::string> words{word};
    if (!option->isFlag() && option->impliedValue.empty() && name.size() == word.size() &&
        i + 1 < arguments.size())
      words.push_back(arguments[++i]);
    if (option->name == "--output" || option->name == "--jobs" || option->name == "--tasks")
      continue;
    bool taken = false;
    for (auto [table, line] : {std::pair(&fit, &out.fit), std::pair(&evaluate, &out.evaluate)})
      if (findOption(*table, option->name)) {
        line->insert(line->end(), words.begin(), words.end());
        taken = true;
      }
    if (!taken)
      throw UsageError(option->name +
                       ": the jobs fit and evaluate alone, and make no pictures; leave it out");
  }
  return out;
}

}  // namespace innermap::tool
