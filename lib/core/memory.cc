#include "innermap/core/memory.h"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {

namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

}  // namespace

std::uint64_t memoryLimit() {
  RunContext* const run = currentRun();
  return run && run->maxMemory() > 0 ? run->maxMemory() : kNoLimit;
}

bool limitsMemory() { return memoryLimit() < kNoLimit; }

void requireMemory(const std::string& what, std::uint64_t bytes, const std::string& advice) {
  requireMemory(what, bytes, memoryLimit(), advice);
}

void requireMemory(const std::string& what, std::uint64_t bytes, std::uint64_t limit,
                   const std::string& advice) {
  if (bytes <= limit) return;
  throw MemoryError(fmt::format("{} needs {} of memory, more than the limit of {}; {}", what,
                                formatBytes(bytes), formatBytes(limit), advice));
}

std::uint64_t availableMemory() {
  std::uint64_t bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                        static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
  for (const char* path :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::ifstream file(path);
    std::uint64_t limit = 0;
    if (file >> limit && limit > 0) bytes = std::min(bytes, limit);
  }
  return std::min(bytes, addressSpaceLeft());
}

std::uint64_t addressSpaceLeft() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return std::numeric_limits<std::uint64_t>::max();
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const std::uint64_t used = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
  return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

std::uint64_t peakMemory() {
  // The system's resource usage also counts the process that this one was started from.
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmHWM:", 0) == 0) return 1024 * std::stoull(line.substr(6));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::uint64_t processMemory(std::uint64_t bytes) {
  std::uint64_t pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  resident *= static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
  // What was freed is taken first.
  const std::uint64_t held = resident - std::min<std::uint64_t>(resident, mallinfo2().fordblks);
  const std::uint64_t before = held + kLibrariesAtWork;
  const std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  return std::max(peakMemory() + kLibrariesAtWork, bytes > most - before ? most : before + bytes);
}

std::uint64_t memoryLeft() {
  if (!limitsMemory()) return kNoLimit;
  const std::uint64_t limit = memoryLimit();
  // So many bytes are above any peak so far.
  const std::uint64_t many = std::uint64_t(1) << 62, held = processMemory(many) - many;
  return limit > held ? limit - held : 1;
}

std::string formatBytes(std::uint64_t bytes) {
  static const char* const units[] = {"B", "kB", "MB", "GB", "TB", "PB", "EB"};
  double value = static_cast<double>(bytes);
  int unit = 0;
  for (; value >= 999.5 && unit < 6; ++unit) value /= 1000;
  return fmt::format("{:.3g} {}", value, units[unit]);
}

std::uint64_t parseBytes(const std::string& setting, const std::string& text) {
  const auto fail = [&]() -> std::uint64_t {
    throw SettingError(setting, "'" + text + "' is not a size; write for example 800M or 1.5GB");
  };
  if (text.empty() || !(std::isdigit(static_cast<unsigned char>(text[0])) || text[0] == '.'))
    return fail();
  // Not strtod, which reads 0x10.
  double value = 0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (error != std::errc()) return fail();
  std::string unit(end, last);
  std::transform(unit.begin(), unit.end(), unit.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (unit == "e") return fail();  // an exponent forgotten, rather than an exabyte
  if (!unit.empty() && unit.back() == 'b') unit.pop_back();
  const bool binary = unit.size() == 2 && unit[1] == 'i';
  const double base = binary ? 1024 : 1000;
  if (binary) unit.pop_back();
  static const std::string prefixes = "kmgtpe";
  double scale = 1;
  if (unit.size() == 1 && prefixes.find(unit[0]) != std::string::npos)
    scale = std::pow(base, static_cast<double>(prefixes.find(unit[0]) + 1));
  else if (!unit.empty())
    return fail();
  const double bytes = value * scale;
  if (!(bytes >= 0) || bytes >= 1.8e19) return fail();
  return static_cast<std::uint64_t>(bytes);
}

void requireMemoryFor(const std::string& doing, std::uint64_t bytes, std::uint64_t limit,
                      const SizeOption& size, const std::string& otherwise) {
  std::uint64_t lower = size.least, upper = size.most;
  while (lower < upper) {
    const std::uint64_t middle = lower + (upper - lower + 1) / 2;
    if (size.need(middle) <= limit)
      lower = middle;
    else
      upper = middle - 1;
  }
  const bool fits = size.need(lower) <= limit;
  requireMemory(doing, bytes, limit,
                fits ? fmt::format("use {} {} or {}", size.setting, lower, otherwise) : otherwise);
}

}  // namespace innermap
