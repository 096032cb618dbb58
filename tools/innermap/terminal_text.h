// Text for whoever reads it: wrapped and coloured on a terminal, as it is in files and pipes.
#pragma once

#include <cstdio>
#include <string>

namespace innermap::tool {

struct TerminalText {
  int width = 0;         // columns; 0: lines are not wrapped
  bool colours = false;  // NO_COLOR (no-color.org) and TERM=dumb turn them off

  // Of stdout or stderr as it is now.
  static TerminalText of(std::FILE* stream);

  // Lines that are too long go on below at column `hang`. Words are never cut.
  std::string wrapped(const std::string& lines, std::size_t hang) const;

  std::string good(const std::string& text) const { return coloured(text, "32"); }
  std::string bad(const std::string& text) const { return coloured(text, "1;31"); }
  std::string doubtful(const std::string& text) const { return coloured(text, "33"); }

 private:
  std::string coloured(const std::string& text, const char* code) const;
};

}  // namespace innermap::tool
