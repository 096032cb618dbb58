#include "core/share.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "core/text_scanner.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

// The numbers of an engine's tasks, and the one of this process.
struct Tasks {
  std::int64_t own = 0, first = 1, last = 1, step = 1;
};

// Refuses what is no such row of numbers; `told` says where they come from.
Share shareOf(const std::string& setting, const Tasks& t, const std::string& told) {
  const bool sensible = t.step >= 1 && t.first >= 0 && t.last >= t.first && t.own >= t.first &&
                        t.own <= t.last && (t.own - t.first) % t.step == 0;
  if (!sensible)
    throw SettingError(setting, "'auto' makes no sense of " + told + "; write 3/40, say");
  const auto of = static_cast<std::uint64_t>((t.last - t.first) / t.step) + 1;
  if (of > Share::kMost)
    throw SettingError(setting,
                       fmt::format("'auto': {} are more than {} tasks", told, Share::kMost));
  return {static_cast<std::uint64_t>((t.own - t.first) / t.step) + 1, of};
}

std::optional<Share> slurmShare(const std::string& setting, const Environment& environment) {
  const auto own = environment("SLURM_ARRAY_TASK_ID");
  if (!own) return {};
  const auto number = [&](const char* name) {
    const auto text = environment(name);
    const auto value = text ? parseInteger(*text) : std::nullopt;
    if (!value)
      throw SettingError(setting, fmt::format("'auto': {} is {}; write 3/40, say", name,
                                              text ? "'" + *text + "'" : "not set"));
    return *value;
  };
  const Tasks tasks{number("SLURM_ARRAY_TASK_ID"), number("SLURM_ARRAY_TASK_MIN"),
                    number("SLURM_ARRAY_TASK_MAX"), number("SLURM_ARRAY_TASK_STEP")};
  const std::string told = fmt::format("Slurm's array from {} to {} in steps of {} with task {}",
                                       tasks.first, tasks.last, tasks.step, tasks.own);
  const Share share = shareOf(setting, tasks, told);
  // An array with gaps, say --array=3,7 for two tasks that failed.
  if (number("SLURM_ARRAY_TASK_COUNT") != static_cast<std::int64_t>(share.of))
    throw SettingError(setting, fmt::format("'auto': {} has gaps; write the share out, such as "
                                            "$SLURM_ARRAY_TASK_ID/40",
                                            told));
  return share;
}

std::optional<Share> cueShare(const std::string& setting, const Environment& environment) {
  const auto own = environment("CUE_IFRAME"), range = environment("CUE_RANGE");
  if (!own || !range) return {};
  const std::string told = fmt::format("OpenCue's range '{}' with frame '{}'", *range, *own);
  const std::size_t cross = range->find('x'), dash = range->find('-', 1);
  const std::string_view text(*range);
  const auto part = [&](std::size_t from, std::size_t to) {
    return parseInteger(text.substr(from, to == std::string::npos ? to : to - from)).value_or(-1);
  };
  Tasks tasks;
  tasks.own = parseInteger(*own).value_or(-1);
  tasks.first = part(0, std::min(dash, cross));
  tasks.last = dash == std::string::npos ? tasks.first : part(dash + 1, cross);
  tasks.step = cross == std::string::npos ? 1 : part(cross + 1, std::string::npos);
  return shareOf(setting, tasks, told);
}

}  // namespace

std::pair<std::size_t, std::size_t> Share::range(const std::vector<std::uint64_t>& weights) const {
  // Sums times kMost may be over 64 bits.
  __extension__ using Wide = unsigned __int128;
  Wide total = 0, until = 0;
  for (const std::uint64_t weight : weights) total += weight;
  std::pair<std::size_t, std::size_t> out{0, 0};
  for (const std::uint64_t weight : weights) {
    until += weight;
    if (until * of <= total * (number - 1)) ++out.first;
    if (until * of <= total * number) ++out.second;
  }
  return out;
}

std::optional<std::string> environmentVariable(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  if (!value) return {};
  return std::string(value);
}

Share parseShare(const std::string& setting, const std::string& text,
                 const Environment& environment) {
  if (text == "auto") {
    if (const auto share = slurmShare(setting, environment)) return *share;
    if (const auto share = cueShare(setting, environment)) return *share;
    throw SettingError(setting,
                       "'auto': neither Slurm's SLURM_ARRAY_TASK_ID nor OpenCue's CUE_IFRAME and "
                       "CUE_RANGE are set; write 3/40, say");
  }
  const std::size_t slash = text.find('/');
  const std::string_view all(text);
  const auto number = parseInteger(all.substr(0, slash));
  const auto of = slash == std::string::npos ? std::nullopt : parseInteger(all.substr(slash + 1));
  if (!number || !of)
    throw SettingError(setting,
                       "'" + text + "' is no share; write 3/40, the third of forty, or auto");
  if (*of < 1 || *of > static_cast<std::int64_t>(Share::kMost))
    throw SettingError(
        setting, fmt::format("'{}' has {} shares; 1 to {} are possible", text, *of, Share::kMost));
  if (*number < 1 || *number > *of)
    throw SettingError(setting, fmt::format("'{}' is no share of {}: they are 1/{} to {}/{}", text,
                                            *of, *of, *of, *of));
  return {static_cast<std::uint64_t>(*number), static_cast<std::uint64_t>(*of)};
}

std::uint64_t taskRestarts(const Environment& environment) {
  const auto count = parseInteger(environment("SLURM_RESTART_COUNT").value_or("0"));
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, count.value_or(0)));
}

}  // namespace innermap
