#include "context.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "innermap/core/memory.h"
#include "innermap/io/picture/label_font.h"
#include "terminal_progress.h"

namespace innermap::tool {

Context::Context(const CommonOptions& options, TerminalProgress& progress)
    : options_(options), progress_(progress) {
  maxMemory_ = options.maxMemory.empty() ? availableMemory() / 10 * 8
                                         : parseBytes("--max-memory", options.maxMemory);
  if (maxMemory_ == 0) throw SettingError("--max-memory", "must be above 0; write for example 4GB");
}

Progress* Context::progress() const { return &progress_; }

void Context::setPart(const std::string& part) { progress_.setPart(part); }

void Context::plan(const std::vector<std::string>& lines, std::uint64_t bytes) {
  for (const std::string& line : lines) print(line + "\n");
  print(fmt::format("memory: about {} of at most {}{}\n", formatBytes(bytes),
                    formatBytes(maxMemory_),
                    bytes > maxMemory_ ? ", so this would be refused" : ""));
  report_.set("dry_run", true);
  report_.set("memory_needed_bytes", bytes);
}

void Context::output(const std::string& path) {
  if (dryRun()) return;
  requireWritable(path);
  if (std::filesystem::path(path).extension() == ".png") notePictures();
}

PendingFolder Context::outputFolder(const std::string& path) { return PendingFolder(path); }

void Context::notePictures() {
  if (labelFont().empty())
    note(
        "no font is installed, so pictures have no labels; install DejaVu Sans (on Debian the "
        "package fonts-dejavu-core)");
}

void Context::say(const std::string& kind, const std::string& text) {
  if (options_.quiet) return;
  progress_.clear();
  std::fprintf(stderr, "innermap: %s%s\n", kind.c_str(), text.c_str());
}

void Context::note(const std::string& text) {
  report_.notes.push_back(text);
  say("", text);
}

void Context::warning(const std::string& text) {
  report_.warnings.push_back(text);
  say("warning: ", text);
}

void Context::print(const std::string& text) {
  progress_.clear();
  std::fwrite(text.data(), 1, text.size(), stdout);
}

const Report& Context::finishedReport() {
  report_.peakMemory = peakMemory();
  return report_;
}

void Context::finish(PendingFolder& folder) {
  folder.write("report.json",
               [&](const std::string& path) { writeReport(path, finishedReport()); });
  folder.commit();
}

}  // namespace innermap::tool
