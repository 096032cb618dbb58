#include "terminal_progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace innermap::tool {
namespace {

constexpr auto kRedraw = std::chrono::milliseconds(80);
constexpr auto kLineEvery = std::chrono::seconds(10);

int terminalWidth() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col < 20) return 80;
  return size.ws_col;
}

}  // namespace

TerminalProgress::Style TerminalProgress::styleFor(bool quiet) {
  if (quiet) return Style::none;
  const char* terminal = std::getenv("TERM");
  const bool dumb = !terminal || std::string_view(terminal) == "dumb";
  return isatty(STDERR_FILENO) && !dumb ? Style::bar : Style::lines;
}

void TerminalProgress::report(std::string_view stage, double fraction) {
  if (style_ == Style::none) return;
  // Whoever comes while another thread writes has nothing new to say.
  std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
  if (!lock) return;
  const double share = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
  if (style_ == Style::bar)
    drawBar(stage, share);
  else
    writeLine(stage, share);
}

void TerminalProgress::setPart(const std::string& part) {
  const std::lock_guard<std::mutex> lock(mutex_);
  part_ = part;
}

void TerminalProgress::drawBar(std::string_view stage, double fraction) {
  const auto now = Clock::now();
  if (drawn_ && stage == stage_ && now - last_ < kRedraw) return;
  last_ = now;
  stage_ = stage;
  drawn_ = true;
  const int room = terminalWidth() - 1;
  const int label = part_.empty() ? std::clamp(room / 3, 8, 32) : std::clamp(room / 2, 8, 56);
  const std::string text = part_.empty() ? std::string(stage) : part_ + ": " + stage_;
  const int width = std::max(4, room - label - 9);
  const int full = static_cast<int>(std::lround(fraction * width));
  const std::string line =
      fmt::format("\r{:<{}.{}} [{}{}] {:3.0f}%\x1b[K", text, label, label, std::string(full, '='),
                  std::string(width - full, ' '), 100 * fraction);
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fflush(stderr);
}

void TerminalProgress::writeLine(std::string_view stage, double fraction) {
  const auto now = Clock::now();
  const std::string text = part_.empty() ? std::string(stage) : part_;
  const bool first = seen_.insert(text).second;
  if (!first && now - last_ < kLineEvery) return;
  last_ = now;
  if (first)
    std::fprintf(stderr, "%s\n", text.c_str());
  else
    std::fprintf(stderr, "%s: %s%.0f%%\n", text.c_str(),
                 part_.empty() ? "" : (std::string(stage) + ", ").c_str(), 100 * fraction);
}

void TerminalProgress::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace innermap::tool
