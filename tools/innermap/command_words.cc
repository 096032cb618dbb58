#include "command_words.h"

#include <algorithm>

#include "commands.h"
#include "lists.h"
#include "spelling.h"

namespace innermap::tool {
namespace {

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool isCalled(const Option& option, const std::string& name) {
  return !option.isPositional() && (option.shortName == name || has(spellings(option.name), name) ||
                                    has(commaList(option.formerName), name));
}

const Option* findOption(const std::vector<Option>& options, const std::string& name) {
  const auto at = std::find_if(options.begin(), options.end(),
                               [&](const Option& o) { return isCalled(o, name); });
  return at == options.end() ? nullptr : &*at;
}

bool takes(const std::string& command, const std::string& option) {
  CommonOptions common;
  return findOption(allOptions(findCommand(command), common), option) != nullptr;
}

// An option with its value, or another word.
struct Piece {
  std::string option;  // its usual name; empty: another word
  std::vector<std::string> words;
};

std::vector<Piece> piecesOf(const CommandLine& line) {
  CommonOptions common;
  const std::vector<Option> table = allOptions(findCommand(line.at(1)), common);
  std::vector<Piece> out;
  for (std::size_t i = 2; i < line.size(); ++i) {
    const std::string& word = line[i];
    const std::string name = word.substr(0, word.find('='));
    const Option* option = word.size() > 1 && word[0] == '-' ? findOption(table, name) : nullptr;
    out.push_back({option ? option->name : "", {word}});
    const bool takesValue = option && !option->isFlag() && option->impliedValue.empty();
    if (takesValue && name.size() == word.size() && i + 1 < line.size())
      out.back().words.push_back(line[++i]);
  }
  return out;
}

const std::vector<std::string>& optionsOfTheCut() {
  static const std::vector<std::string> kNames{"--output", "--share", "--jobs", "--tasks"};
  return kNames;
}

}  // namespace

const std::vector<std::string>& optionsOfTheWhole() {
  static const std::vector<std::string> kNames{"--report", "--strict"};
  return kNames;
}

CommandLine without(const CommandLine& line, const std::vector<std::string>& options) {
  CommandLine out(line.begin(), line.begin() + 2);
  for (const Piece& piece : piecesOf(line))
    if (!has(options, piece.option)) out.insert(out.end(), piece.words.begin(), piece.words.end());
  return out;
}

CommandLine handedOn(const CommandLine& line, CommandLine words, bool last) {
  for (const Piece& piece : piecesOf(line)) {
    const bool stays = piece.option.empty() || has(optionsOfTheCut(), piece.option) ||
                       (!last && has(optionsOfTheWhole(), piece.option));
    if (!stays && takes(words.at(1), piece.option))
      words.insert(words.end(), piece.words.begin(), piece.words.end());
  }
  return words;
}

std::string keptByNone(const CommandLine& line, const std::vector<std::string>& commands) {
  for (const Piece& piece : piecesOf(line))
    if (!piece.option.empty() && !has(optionsOfTheCut(), piece.option) &&
        std::none_of(commands.begin(), commands.end(),
                     [&](const std::string& command) { return takes(command, piece.option); }))
      return piece.option;
  return "";
}

}  // namespace innermap::tool
