#include "conclusion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "innermap/core/memory.h"

namespace innermap::tool {

std::string titleOf(const std::string& name) {
  std::string out = name;
  std::replace(out.begin(), out.end(), '_', ' ');
  return out;
}

std::vector<std::string> writtenLines(const std::vector<ReportOutput>& outputs) {
  constexpr std::size_t kMany = 8;
  std::vector<std::pair<std::string, std::vector<const ReportOutput*>>> folders;
  for (const ReportOutput& o : outputs) {
    const std::string folder = std::filesystem::path(o.path).parent_path().string();
    if (folders.empty() || folders.back().first != folder) folders.push_back({folder, {}});
    folders.back().second.push_back(&o);
  }
  std::vector<std::string> lines;
  for (const auto& [folder, files] : folders) {
    std::string text = "wrote " + (folder.empty() ? "" : folder + "/: ");
    std::uint64_t bytes = 0;
    const auto nameOf = [](const ReportOutput* o) {
      return std::filesystem::path(o->path).filename().string();
    };
    std::vector<std::string> names;
    for (const ReportOutput* o : files) {
      bytes += o->bytes;
      names.push_back(nameOf(o) + " (" + formatBytes(o->bytes) + ")");
    }
    lines.push_back(
        text + (files.size() > kMany
                    ? fmt::format("{} files, {} to {} ({})", files.size(), nameOf(files.front()),
                                  nameOf(files.back()), formatBytes(bytes))
                    : fmt::format("{}", fmt::join(names, ", "))));
  }
  return lines;
}

std::string verdictText(const std::vector<ReportFinding>& verdict, std::size_t unmet,
                        const TerminalText& style) {
  constexpr std::size_t kHang = 10;
  std::string text =
      unmet == 0 ? style.good(fmt::format("verdict: all {} met", verdict.size()))
                 : style.bad(fmt::format("verdict: {} of {} not met", unmet, verdict.size()));
  text += '\n';
  for (const ReportFinding& f : verdict) {
    const std::string mark = f.met ? "met" : "NOT MET";
    std::string line =
        style.wrapped(fmt::format("  {:<7} {}: {}\n", mark, titleOf(f.name), f.statement), kHang);
    text += line.replace(2, mark.size(), f.met ? style.good(mark) : style.bad(mark));
    if (!f.advice.empty()) text += style.wrapped("          try: " + f.advice + "\n", kHang + 5);
  }
  return text;
}

}  // namespace innermap::tool
