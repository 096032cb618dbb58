#include "terminal_text.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace innermap::tool {
namespace {

constexpr int kUsualWidth = 80, kLeastWidth = 40;

bool isSet(const char* variable) {
  const char* const value = std::getenv(variable);
  return value && *value;
}

std::string wrappedLine(const std::string& line, std::size_t hang, std::size_t width) {
  std::string out;
  std::size_t column = 0;
  for (std::size_t from = 0; from < line.size();) {
    // A word with the blanks before it, which stay where the line is not broken.
    const std::size_t word = std::min(line.find_first_not_of(' ', from), line.size());
    const std::size_t end = std::min(line.find(' ', word), line.size());
    if (column > hang && column + end - from > width) {
      out += '\n' + std::string(hang, ' ');
      column = hang;
      from = word;
    }
    out.append(line, from, end - from);
    column += end - from;
    from = end;
  }
  return out;
}

}  // namespace

TerminalText TerminalText::of(std::FILE* stream) {
  TerminalText style;
  const int file = fileno(stream);
  if (!isatty(file)) return style;
  winsize size{};
  const bool known = ioctl(file, TIOCGWINSZ, &size) == 0 && size.ws_col >= kLeastWidth;
  style.width = known ? size.ws_col : kUsualWidth;
  const char* const terminal = std::getenv("TERM");
  style.colours = terminal && std::string_view(terminal) != "dumb" && !isSet("NO_COLOR");
  return style;
}

std::string TerminalText::wrapped(const std::string& lines, std::size_t hang) const {
  if (width == 0) return lines;
  std::string out;
  for (std::size_t from = 0; from < lines.size();) {
    const std::size_t end = std::min(lines.find('\n', from), lines.size());
    out += wrappedLine(lines.substr(from, end - from), hang, static_cast<std::size_t>(width));
    if (end < lines.size()) out += '\n';
    from = end + 1;
  }
  return out;
}

std::string TerminalText::coloured(const std::string& text, const char* code) const {
  return colours ? std::string("\x1b[") + code + "m" + text + "\x1b[0m" : text;
}

}  // namespace innermap::tool
