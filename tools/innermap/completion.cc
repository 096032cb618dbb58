// Completion of the command line in shells, from the tables of the commands.
#include <fmt/format.h>

#include "commands.h"

namespace innermap::tool {
namespace {

enum class Takes { nothing, choice, command, file, folder, other };

Takes takenBy(const Command& command, const Option& o) {
  if (o.isFlag()) return Takes::nothing;
  if (!o.choices.empty()) return Takes::choice;
  if (o.isPositional() && command.name() == "help") return Takes::command;
  if (o.placeholder == "FOLDER") return Takes::folder;
  const bool file = o.isInput || o.placeholder == "FILE" || o.placeholder == "FILES";
  return file ? Takes::file : Takes::other;
}

std::vector<Option> optionsOf(const Command& command) {
  static CommonOptions common;
  return allOptions(command, common);
}

std::vector<std::string> commandNames() {
  std::vector<std::string> names;
  for (const Command& c : allCommands()) names.push_back(c.name());
  return names;
}

// `text` with a backslash before each of `special`.
std::string escaped(const std::string& text, const std::string& special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string::npos) out += '\\';
    out += c;
  }
  return out;
}

// For an apostrophe in a text between apostrophes, in bash and zsh.
std::string apostrophes(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string bashNames(const Option& o) {
  return o.shortName.empty() ? o.name : o.shortName + "|" + o.name;
}

std::string bashValues(const Command& command, const Option& o) {
  switch (takenBy(command, o)) {
    case Takes::choice:
      return fmt::format("compgen -W {} -- \"$cur\"",
                         apostrophes(fmt::format("{}", fmt::join(o.choices, " "))));
    case Takes::file:
      return "compgen -f -- \"$cur\"";
    case Takes::folder:
      return "compgen -d -- \"$cur\"";
    default:
      return ":";
  }
}

std::string bashCase(const Command& command) {
  std::string names, values;
  for (const Option& o : optionsOf(command)) {
    if (o.isPositional()) continue;
    names += (names.empty() ? "" : " ") + o.name;
    if (o.isFlag()) continue;
    values += fmt::format("        {}) mapfile -t COMPREPLY < <({}); return ;;\n", bashNames(o),
                          bashValues(command, o));
  }
  const std::string words =
      command.name() == "help" ? fmt::format("{}", fmt::join(commandNames(), " ")) : "";
  return fmt::format("    {})\n      options={} words={}\n      case $prev in\n{}      esac ;;\n",
                     command.name(), apostrophes(names), apostrophes(words), values);
}

std::string bashScript() {
  std::string cases;
  for (const Command& c : allCommands()) cases += bashCase(c);
  return fmt::format(R"(# bash completion of innermap; made by `innermap help --completion bash`
_innermap() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}}
  local options='--help --help-all --version' words={0}
  COMPREPLY=()
  if ((COMP_CWORD > 1)); then
    compopt -o filenames 2> /dev/null
    case ${{COMP_WORDS[1]}} in
{1}    esac
  fi
  if [[ $cur == -* ]]; then
    compopt +o filenames 2> /dev/null
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$cur")
  elif [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$cur")
  fi
}}
complete -F _innermap innermap
)",
                     apostrophes(fmt::format("{}", fmt::join(commandNames(), " "))), cases);
}

std::string zshAction(const Command& command, const Option& o) {
  switch (takenBy(command, o)) {
    case Takes::choice:
      return fmt::format("({})", fmt::join(o.choices, " "));
    case Takes::command:
      return fmt::format("({})", fmt::join(commandNames(), " "));
    case Takes::file:
      return "_files";
    case Takes::folder:
      return "_files -/";
    default:
      return " ";
  }
}

std::string zshLine(const Command& command, const Option& o) {
  const std::string help = escaped(o.help, "[]:\\");
  const std::string value =
      o.isFlag() ? "" : fmt::format(":{}:{}", escaped(o.placeholder, ":"), zshAction(command, o));
  if (o.isPositional())
    return apostrophes((o.isList()   ? "*"
                        : o.required ? ""
                                     : ":") +
                       (o.required || o.isList() ? ":" : std::string()) + escaped(o.name, ":") +
                       ":" + zshAction(command, o));
  if (o.shortName.empty()) return apostrophes(fmt::format("{}[{}]{}", o.name, help, value));
  return fmt::format("{}{{{},{}}}{}", apostrophes(fmt::format("({} {})", o.shortName, o.name)),
                     o.shortName, o.name, apostrophes(fmt::format("[{}]{}", help, value)));
}

std::string zshScript() {
  std::string names, cases;
  for (const Command& c : allCommands()) {
    names += "      " + apostrophes(c.name() + ":" + c.summary()) + "\n";
    cases += fmt::format("    {})\n      _arguments -s", c.name());
    for (const Option& o : optionsOf(c)) cases += " \\\n        " + zshLine(c, o);
    cases += " ;;\n";
  }
  return fmt::format(R"(#compdef innermap
# zsh completion of innermap; made by `innermap help --completion zsh`
_innermap() {{
  if (( CURRENT == 2 )); then
    local -a names=(
{}    )
    _describe command names
    return
  fi
  local name=$words[2]
  shift words
  (( CURRENT-- ))
  case $name in
{}  esac
}}
if [[ $funcstack[1] == _innermap ]]; then
  _innermap "$@"
else
  compdef _innermap innermap
fi
)",
                     names, cases);
}

std::string fishText(const std::string& text) { return "'" + escaped(text, "'\\") + "'"; }

std::string fishValues(const Command& command, const Option& o) {
  switch (takenBy(command, o)) {
    case Takes::nothing:
      return "";
    case Takes::choice:
      return fmt::format(" -x -a '{}'", fmt::join(o.choices, " "));
    case Takes::file:
      return " -r -F";
    case Takes::folder:
      return " -x -a '(__fish_complete_directories)'";
    default:
      return " -x";
  }
}

std::string fishScript() {
  std::string text =
      "# fish completion of innermap; made by `innermap help --completion fish`\n"
      "complete -c innermap -f\n";
  for (const Command& c : allCommands()) {
    text += fmt::format("complete -c innermap -n __fish_use_subcommand -a {} -d {}\n", c.name(),
                        fishText(c.summary()));
    const std::string head =
        fmt::format("complete -c innermap -n '__fish_seen_subcommand_from {}'", c.name());
    for (const Option& o : optionsOf(c)) {
      if (o.isPositional()) continue;
      text += fmt::format("{} -l {}", head, o.name.substr(2));
      if (!o.shortName.empty()) text += " -s " + o.shortName.substr(1);
      text += fishValues(c, o) + " -d " + fishText(o.help) + "\n";
    }
    if (c.name() == "help")
      text += fmt::format("{} -a '{}'\n", head, fmt::join(commandNames(), " "));
    else
      text += head + " -F\n";
  }
  return text;
}

}  // namespace

std::string completionScript(const std::string& shell) {
  return shell == "bash" ? bashScript() : shell == "zsh" ? zshScript() : fishScript();
}

}  // namespace innermap::tool
