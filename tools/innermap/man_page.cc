// Pages for man, from the tables of the commands.
#include <fmt/format.h>

#include <algorithm>

#include "commands.h"
#include "innermap/core/version.h"

namespace innermap::tool {
namespace {

// Letters that roff takes for something else.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else if (c == '`')
      out += "\\(ga";
    else if (c == '^')
      out += "\\(ha";
    else if (c == '~')
      out += "\\(ti";
    else
      out += c;
  }
  return out;
}

// Running text, in lines that stay short in the page's source.
std::string flowed(const std::string& text) {
  std::string out, line;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t space = std::min(text.find(' ', from), text.size());
    std::string word = roff(text.substr(from, space - from));
    from = space + 1;
    if (!line.empty() && line.size() + 1 + word.size() > 78) {
      out += line + "\n";
      line.clear();
    }
    // A point at a line's start would be a request.
    if (line.empty() && word[0] == '.') word = "\\&" + word;
    line += (line.empty() ? "" : " ") + word;
  }
  return out + line + "\n";
}

std::string head(const std::string& name, const std::string& summary) {
  std::string title = name;
  for (char& c : title) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return fmt::format(".TH {} 1 \"\" \"innermap {}\" \"innermap\"\n.SH NAME\n{}", roff(title),
                     roff(versionText()), flowed(name + " - " + summary));
}

std::string entry(const Option& o) {
  const std::string values = valueText(o);
  return fmt::format(".TP\n\\fB{}\\fR\n{}", roff(leftOf(o)),
                     flowed(o.help + (values.empty() ? "" : " [" + values + "]")));
}

// Options of one group after another, each under its title.
std::string entries(const std::vector<Option>& options) {
  std::vector<std::string> titles;
  for (const Option& o : options) {
    bool known = o.isPositional();
    for (const std::string& title : titles) known = known || title == o.group;
    if (!known) titles.push_back(o.group);
  }
  std::string text;
  for (const std::string& title : titles) {
    if (!title.empty()) text += ".SS " + roff(title) + "\n";
    for (const bool advanced : {false, true})
      for (const Option& o : options)
        if (!o.isPositional() && o.group == title && o.advanced == advanced) text += entry(o);
  }
  return text;
}

std::string commonEntries() {
  CommonOptions common;
  std::vector<Option> options = commonOptionTable(common);
  for (Option& o : options) o.group = "Options of every command";
  return entries(options);
}

const char kExit[] =
    ".SH EXIT STATUS\n.TP\n0\ndone\n.TP\n1\nfailed\n.TP\n2\nwrong usage\n.TP\n130\ncancelled\n";

}  // namespace

std::string manPage(const Command& command) {
  std::string text = head("innermap-" + command.name(), command.summary());
  text += ".SH SYNOPSIS\n.B " + roff(usageLine(command)) + "\n";
  text += ".SH DESCRIPTION\n" + flowed(command.summary() + ". " + command.description());
  for (const Option& o : command.options())
    if (o.isPositional()) text += entry(o);
  text += ".SH OPTIONS\n" + entries(command.options()) + commonEntries() + kExit;
  if (!command.examples().empty()) text += ".SH EXAMPLES\n.EX\n";
  for (const std::string& line : command.examples()) text += roff(line) + "\n";
  if (!command.examples().empty()) text += ".EE\n";
  return text + ".SH SEE ALSO\n.BR innermap (1)\n";
}

std::string generalManPage() {
  std::string text = head("innermap", "harmonic maps of solids, into OpenVDB and EXR");
  text += ".SH SYNOPSIS\n.B innermap\n.I COMMAND\n[options]\n.SH DESCRIPTION\n";
  text += flowed(
              "innermap maps the inside of one solid smoothly onto the inside of another. It "
              "writes the map, and the volumes and geometry that go through it, in files for "
              "renderers and simulators.") +
          "\n";
  for (const Topic& topic : commandTopics()) {
    if (!topic.commands.empty()) text += ".SS " + roff(topic.title) + "\n";
    for (const std::string& name : topic.commands)
      text += fmt::format(".TP\n.BR innermap\\-{} (1)\n{}", roff(name),
                          flowed(findCommand(name).summary()));
  }
  return text + ".SH OPTIONS\n" + commonEntries() + kExit;
}

}  // namespace innermap::tool
