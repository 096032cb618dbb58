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

// Wide enough for "12 min 30 s left", and a blank.
constexpr int kClockWidth = 17;

std::string durationText(double seconds) {
  if (seconds < 59.5) return fmt::format("{:.0f} s", std::max(1.0, std::ceil(seconds)));
  const int tens = static_cast<int>(std::lround(seconds / 10));
  if (tens < 60) return fmt::format("{} min {:02d} s", tens / 6, tens % 6 * 10);
  const int minutes = static_cast<int>(std::lround(seconds / 60));
  if (minutes < 60) return fmt::format("{} min", minutes);
  return fmt::format("{} h {:02d} min", minutes / 60, minutes % 60);
}

}  // namespace

TerminalProgress::Style TerminalProgress::styleFor(bool quiet, bool verbose) {
  if (quiet) return Style::none;
  if (verbose) return Style::lines;
  const char* terminal = std::getenv("TERM");
  const bool dumb = !terminal || std::string_view(terminal) == "dumb";
  return isatty(STDERR_FILENO) && !dumb ? Style::bar : Style::rare;
}

void TerminalProgress::expect(std::vector<JobPhase> phases) {
  const std::lock_guard<std::mutex> lock(mutex_);
  job_.expect(std::move(phases), now());
}

void TerminalProgress::report(std::string_view stage, double fraction) {
  // Whoever comes while another thread writes has nothing new to say.
  std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
  if (!lock) return;
  const double share = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
  job_.report(stage, share, now());
  if (style_ == Style::bar)
    drawBar(stage, share);
  else if (style_ != Style::none)
    writeLine(stage, share);
}

std::vector<JobPhaseTaken> TerminalProgress::taken() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return job_.taken(now());
}

void TerminalProgress::sayLongest() const {
  constexpr std::size_t kShown = 3;
  std::vector<JobPhaseTaken> stages = taken();
  if (style_ != Style::lines || stages.empty()) return;
  std::stable_sort(stages.begin(), stages.end(),
                   [](const auto& a, const auto& b) { return a.seconds > b.seconds; });
  stages.resize(std::min(stages.size(), kShown));
  std::string text;
  for (const JobPhaseTaken& t : stages)
    text += fmt::format("{} {} {:.1f} s ({:.1f} s expected)", text.empty() ? "" : ",",
                        t.phase.stage, t.seconds, t.phase.seconds);
  std::fprintf(stderr, "%6.1f s  longest:%s\n", now(), text.c_str());
}

void TerminalProgress::setPart(const std::string& part) {
  const std::lock_guard<std::mutex> lock(mutex_);
  part_ = part;
}

// The part, the job's phase, or else the stage.
std::string TerminalProgress::label(std::string_view stage) const {
  if (job_.known())
    return !part_.empty() ? part_ : job_.title().empty() ? std::string(stage) : job_.title();
  return part_.empty() ? std::string(stage) : part_ + ": " + std::string(stage);
}

void TerminalProgress::drawBar(std::string_view stage, double fraction) {
  const auto time = Clock::now();
  if (drawn_ && time - last_ < kRedraw) return;
  last_ = time;
  drawn_ = true;
  const JobClock::State job = job_.at(now());
  if (!job_.known()) {
    // Stages come and go: a bar of theirs would run backwards.
    const std::string line =
        fmt::format("\r{}: {:.0f}%, {:.0f} s\x1b[K", label(stage), 100 * fraction, now());
    std::fwrite(line.data(), 1, line.size(), stderr);
    std::fflush(stderr);
    return;
  }
  const double share = job.fraction;
  const std::string clock = job.tellsTime ? durationText(job.secondsLeft) + " left" : "";
  const int room = terminalWidth() - 1;
  const int names = part_.empty() ? std::clamp(room / 3, 8, 32) : std::clamp(room / 2, 8, 56);
  const int width = std::max(4, room - names - 9 - kClockWidth);
  const int full = static_cast<int>(std::lround(share * width));
  const std::string line =
      fmt::format("\r{:<{}.{}} [{}{}] {:3.0f}% {:>{}.{}}\x1b[K", label(stage), names, names,
                  std::string(full, '='), std::string(width - full, ' '), 100 * share, clock,
                  kClockWidth - 1, kClockWidth - 1);
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fflush(stderr);
}

void TerminalProgress::writeLine(std::string_view stage, double fraction) {
  const auto time = Clock::now();
  const std::string text = job_.known() || part_.empty() ? label(stage) : part_;
  const bool first = seen_.insert(text).second;
  const bool due = time - std::max(last_, start_) >= kLineEvery;
  if (!due && (!first || style_ == Style::rare)) return;
  last_ = time;
  const JobClock::State job = job_.at(now());
  std::string line = fmt::format("{:6.1f} s  {}", now(), text);
  if (job_.known() && job.tellsTime)
    line += fmt::format(": {:.0f}%, {} left", 100 * job.fraction, durationText(job.secondsLeft));
  else if (!first && !job_.known())
    line +=
        fmt::format(": {}{:.0f}%", part_.empty() ? "" : std::string(stage) + ", ", 100 * fraction);
  std::fprintf(stderr, "%s\n", line.c_str());
}

void TerminalProgress::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace innermap::tool
