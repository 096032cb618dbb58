// `innermap help`, and the texts of --help and of docs/commands.md.
#include <fmt/format.h>

#include "commands.h"
#include "innermap/core/version.h"

namespace innermap::tool {
namespace {

constexpr std::size_t kWidth = 96, kColumn = 30;

// Breaks `text` into lines of at most kWidth that start at `indent`; the first starts at `at`.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t at) {
  std::string result;
  std::size_t column = at;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t space = std::min(text.find(' ', from), text.size());
    const std::string word = text.substr(from, space - from);
    if (column + word.size() > kWidth && column > indent) {
      if (!result.empty()) result.pop_back();
      result += "\n" + std::string(indent, ' ');
      column = indent;
    }
    result += word + " ";
    column += word.size() + 1;
    from = space + 1;
  }
  if (!result.empty()) result.pop_back();
  return result;
}

std::string leftOf(const Option& o) {
  std::string left = o.shortName.empty() ? o.name : o.shortName + ", " + o.name;
  if (!o.impliedValue.empty()) return left + "[=" + o.placeholder + "]";
  if (!o.placeholder.empty() && !o.isPositional()) left += " " + o.placeholder;
  return left;
}

std::string valueText(const Option& o) {
  std::vector<std::string> parts;
  if (!o.choices.empty()) parts.push_back(fmt::format("{}", fmt::join(o.choices, ", ")));
  if (!o.unit.empty()) parts.push_back(o.unit);
  if (o.hasRange()) parts.push_back(rangeText(o));
  if (o.required && !o.isPositional()) parts.push_back("required");
  if (!o.defaultText.empty()) parts.push_back("default: " + o.defaultText);
  return fmt::format("{}", fmt::join(parts, "; "));
}

std::string optionLine(const Option& o) {
  const std::string values = valueText(o);
  const std::string text = o.help + (values.empty() ? "" : " [" + values + "]");
  std::string line = "  " + leftOf(o);
  if (line.size() + 2 > kColumn)
    line += "\n" + std::string(kColumn, ' ');
  else
    line.resize(kColumn, ' ');
  return line + wrapped(text, kColumn, kColumn) + "\n";
}

std::string usageLine(const Command& command) {
  std::string line = "innermap " + command.name();
  for (const Option& o : command.options())
    if (o.isPositional())
      line += (o.required ? " " + o.name : " [" + o.name + "]") + (o.isList() ? "..." : "");
  for (const Option& o : command.options())
    if (o.required && !o.isPositional())
      line += " " + (o.shortName.empty() ? o.name : o.shortName) + " " + o.placeholder;
  return line + " [options]";
}

std::string optionSection(const std::vector<Option>& options, const std::string& title,
                          bool positional) {
  std::string text;
  for (const Option& o : options)
    if (o.isPositional() == positional) text += optionLine(o);
  return text.empty() ? "" : "\n" + title + ":\n" + text;
}

std::string markdownRow(const Option& o) {
  std::string help = o.help, values = valueText(o);
  for (std::string* text : {&help, &values})
    for (std::size_t at = 0; (at = text->find('|', at)) != std::string::npos; at += 2)
      text->insert(at, "\\");
  return fmt::format("| `{}` | {} | {} |\n", leftOf(o), help, values);
}

std::string markdownTable(const std::vector<Option>& options) {
  std::string text = "| option | what it does | values |\n|---|---|---|\n";
  for (const Option& o : options) text += markdownRow(o);
  return text;
}

struct HelpOptions {
  std::string command;
  bool markdown = false;
};

void run(const HelpOptions& options, Context& context) {
  if (options.markdown) return context.print(markdownHelp());
  context.print(options.command.empty() ? generalHelp()
                                        : commandHelp(findCommand(options.command)));
}

}  // namespace

std::string generalHelp() {
  std::string text = fmt::format(
      "innermap {}: harmonic maps of solids, into OpenVDB and EXR\n\n"
      "usage: innermap COMMAND [options]\n\ncommands:\n",
      versionText());
  for (const Command& c : allCommands())
    text += fmt::format("  {:<19}{}\n", c.name(), wrapped(c.summary(), 21, 21));
  CommonOptions common;
  text += "\noptions of every command:\n";
  for (const Option& o : commonOptionTable(common)) text += optionLine(o);
  text +=
      "\nexit codes: 0 done, 1 failed, 2 wrong usage, 130 cancelled\n"
      "more: innermap COMMAND --help, innermap --version\n";
  return text;
}

std::string commandHelp(const Command& command) {
  CommonOptions common;
  std::string text = command.summary() + "\n\nusage: " + usageLine(command) + "\n";
  if (!command.description().empty()) text += "\n" + wrapped(command.description(), 0, 0) + "\n";
  text += optionSection(command.options(), "arguments", true);
  text += optionSection(command.options(), "options", false);
  text += optionSection(commonOptionTable(common), "options of every command", false);
  if (!command.examples().empty()) text += "\nexample:\n";
  for (const std::string& line : command.examples()) text += "  " + line + "\n";
  return text;
}

std::string markdownHelp() {
  std::string text;
  for (const Command& c : allCommands()) {
    text += fmt::format("### innermap {}\n\n{}.", c.name(), c.summary());
    if (!c.description().empty()) text += " " + c.description();
    text += fmt::format("\n\n```\n{}\n```\n\n", usageLine(c));
    if (!c.options().empty()) text += markdownTable(c.options()) + "\n";
    if (!c.examples().empty()) text += "```sh\n";
    for (const std::string& line : c.examples()) text += line + "\n";
    if (!c.examples().empty()) text += "```\n\n";
  }
  CommonOptions common;
  text += "### Options of every command\n\n" + markdownTable(commonOptionTable(common));
  return text;
}

Command makeHelpCommand() {
  auto o = std::make_shared<HelpOptions>();
  Command c("help", "Show the help of a command, or the commands");
  c.positional("COMMAND", &o->command, "the command to explain").optional();
  c.flag("--markdown", &o->markdown, "the reference of all commands, as docs/commands.md has it");
  c.example("innermap help voxelize");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
