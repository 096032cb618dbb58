// Command lines taken apart, so that a run in jobs hands on the options that it was given.
#pragma once

#include <string>
#include <vector>

namespace innermap::tool {

// "innermap", a command's name, and its words.
using CommandLine = std::vector<std::string>;

// The line less these options, which are called by their usual names, and their values.
CommandLine without(const CommandLine& line, const std::vector<std::string>& options);

// `words`, and the options of `line` that their command has too. Where the files go and how the run
// is cut (--output, --share, --jobs, --tasks) stays behind, and what concerns the whole run
// (optionsOfTheWhole) unless `last` says that the command ends it.
CommandLine handedOn(const CommandLine& line, CommandLine words, bool last);

// The first option of the line that none of `commands` has, or empty.
std::string keptByNone(const CommandLine& line, const std::vector<std::string>& commands);

// Options that only the last of several commands can heed.
const std::vector<std::string>& optionsOfTheWhole();

}  // namespace innermap::tool
