// `innermap help`, and the texts of --help and of docs/commands.md.
#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "commands.h"
#include "core/file.h"
#include "innermap/core/version.h"
#include "lists.h"
#include "report/report_sections.h"
#include "terminal_text.h"

namespace innermap::tool {
namespace {

constexpr std::size_t kColumn = 30;

// In lines of a page, which go on at column `hang`.
std::string wrapped(const std::string& lines, std::size_t hang) {
  TerminalText page;
  page.width = 96;
  return page.wrapped(lines, hang);
}

}  // namespace

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
  if (o.range.bounded()) parts.push_back(o.range.text());
  if (o.required && !o.isPositional()) parts.push_back("required");
  if (!o.defaultText.empty()) parts.push_back("default: " + o.defaultText);
  return fmt::format("{}", fmt::join(parts, "; "));
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

namespace {

std::string optionLine(const Option& o) {
  const std::string values = valueText(o);
  const std::string text = o.help + (values.empty() ? "" : " [" + values + "]");
  std::string line = "  " + leftOf(o);
  if (line.size() + 2 > kColumn)
    line += "\n" + std::string(kColumn, ' ');
  else
    line.resize(kColumn, ' ');
  return wrapped(line + text, kColumn) + "\n";
}

// Groups in the order in which they begin, the usual options of each first.
std::string optionGroups(const std::vector<Option>& options, bool all) {
  std::vector<std::string> titles;
  for (const Option& o : options)
    if (!o.isPositional() && std::find(titles.begin(), titles.end(), o.group) == titles.end())
      titles.push_back(o.group);
  std::string text;
  for (const std::string& title : titles) {
    std::string usual, advanced;
    for (const Option& o : options)
      if (!o.isPositional() && o.group == title) (o.advanced ? advanced : usual) += optionLine(o);
    if (all) usual += advanced;
    if (!usual.empty()) text += "\n" + (title.empty() ? "options" : title) + ":\n" + usual;
  }
  return text;
}

std::string argumentSection(const std::vector<Option>& options) {
  std::string text;
  for (const Option& o : options)
    if (o.isPositional()) text += optionLine(o);
  return text.empty() ? "" : "\narguments:\n" + text;
}

std::string markdownRow(const Option& o) {
  std::string help = o.help, values = valueText(o);
  if (!o.formerName.empty())
    values += fmt::format("{}formerly {}", values.empty() ? "" : "; ",
                          fmt::join(commaList(o.formerName), ", "));
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
  std::string command, completion, pages;
  bool markdown = false, schema = false, all = false, man = false;
};

std::string titleAndUsage() {
  return fmt::format(
      "innermap {}: harmonic maps of solids, into OpenVDB and EXR\n\n"
      "usage: innermap COMMAND [options]\n",
      versionText());
}

std::string commandLine(const std::string& name) {
  return wrapped(fmt::format("  {:<19}{}\n", name, findCommand(name).summary()), 21);
}

// "options of every command: --threads, ..."
std::string namesOnly(const std::vector<Option>& options) {
  std::vector<std::string> names;
  for (const Option& o : options) names.push_back(o.name);
  return "\n" + wrapped(fmt::format("{}: {}", options.front().group, fmt::join(names, ", ")), 4) +
         "\n";
}

// What an installation takes.
void writePages(const std::string& path, Context& context) {
  std::vector<std::pair<std::string, std::string>> files = {{"innermap.1", generalManPage()}};
  for (const Command& c : allCommands())
    files.emplace_back("innermap-" + c.name() + ".1", manPage(c));
  files.emplace_back("innermap.bash", completionScript("bash"));
  files.emplace_back("_innermap", completionScript("zsh"));
  files.emplace_back("innermap.fish", completionScript("fish"));
  std::vector<std::string> names;
  for (const auto& [name, text] : files) names.push_back(name);
  const auto folder = context.outputFolder(path, names);
  if (!folder) return context.plan({"write man pages and completions to " + path}, 0);
  for (const auto& [name, text] : files)
    folder->write(name, [&, &content = text](const std::string& place) {
      writeWholeFile(place, [&](std::ostream& out) { out << content; });
    });
  folder->commit();
}

void run(const HelpOptions& o, Context& context) {
  if (!o.pages.empty()) return writePages(o.pages, context);
  if (o.markdown) return context.print(markdownHelp());
  if (o.schema) return context.print(reportSchema(reportSections()));
  if (!o.completion.empty()) return context.print(completionScript(o.completion));
  if (o.man)
    return context.print(o.command.empty() ? generalManPage() : manPage(findCommand(o.command)));
  context.print(o.command.empty() ? generalHelp() : commandHelp(findCommand(o.command), o.all));
}

}  // namespace

std::string shortHelp() {
  std::string text = titleAndUsage() + "\n";
  for (const char* name : {"map", "deform", "push", "voxelize", "check", "info"})
    text += commandLine(name);
  return text +
         "\nmore: innermap --help lists all commands, innermap COMMAND --help explains one\n";
}

std::string generalHelp() {
  std::string text = titleAndUsage();
  for (const Topic& topic : commandTopics()) {
    text += "\n" + topic.title + ":\n";
    for (const std::string& name : topic.commands) text += commandLine(name);
  }
  CommonOptions common;
  text += "\noptions of every command:\n";
  for (const Option& o : commonOptionTable(common)) text += optionLine(o);
  text +=
      "\nexit codes: 0 done, 1 failed, 2 wrong usage, 130 cancelled\n"
      "more: innermap COMMAND --help, innermap --version\n";
  return text;
}

std::string commandHelp(const Command& command, bool all) {
  CommonOptions common;
  std::string text = command.summary() + "\n\nusage: " + usageLine(command) + "\n";
  if (!command.description().empty()) text += "\n" + wrapped(command.description(), 0) + "\n";
  text += argumentSection(command.options());
  text += optionGroups(command.options(), all);
  const std::vector<Option> every = allOptions(command, common);
  std::vector<Option> shared(every.begin() + static_cast<std::ptrdiff_t>(command.options().size()),
                             every.end());
  for (Option& o : shared) o.group = "options of every command";
  text += all ? optionGroups(shared, true) : namesOnly(shared);
  if (!command.examples().empty()) text += "\nexample:\n";
  for (const std::string& line : command.examples()) text += "  " + line + "\n";
  const auto hidden = std::count_if(command.options().begin(), command.options().end(),
                                    [](const Option& o) { return o.advanced; });
  if (!all && hidden > 0)
    text += fmt::format("\n{} more option{}, and those of every command: innermap {} --help-all\n",
                        hidden, hidden == 1 ? "" : "s", command.name());
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
  c.positional("COMMAND", &o->command, "command to explain").optional();
  c.flag("--all", &o->all, "show every option of the command, as its --help-all");
  c.flag("--man", &o->man, "as a page for man: innermap help map --man | man -l -");
  c.option("--completion", "SHELL", &o->completion,
           "a script that completes the command line: . <(innermap help --completion bash)")
      .choices({"bash", "zsh", "fish"});
  c.flag("--markdown", &o->markdown, "the reference of all commands, as docs/commands.md has it")
      .advanced();
  c.flag("--schema", &o->schema,
         "the JSON Schema of report.json, as docs/report.schema.json has it")
      .advanced();
  c.option("--pages", "FOLDER", &o->pages,
           "write what an installation takes: all pages for man and completion scripts")
      .advanced();
  c.example("innermap help voxelize");
  return c.running(o, run);
}

}  // namespace innermap::tool
