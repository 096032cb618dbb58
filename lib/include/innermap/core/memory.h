// How much memory a task needs, asked before it begins.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace innermap {

// Bytes that the process may hold, of the run that was entered (core/run.h); the largest number
// where that has no limit.
std::uint64_t memoryLimit();
bool limitsMemory();

// For work that alone takes `bytes`: throws MemoryError when they exceed memoryLimit(). The message
// names `what`, the need, the limit, and ends with `advice`: settings that would fit. What a job
// takes in all, beside what the process holds, is for its caller to ask for: processMemory().
void requireMemory(const std::string& what, std::uint64_t bytes, const std::string& advice);

// The same for another limit, in bytes.
void requireMemory(const std::string& what, std::uint64_t bytes, std::uint64_t limit,
                   const std::string& advice);

// A whole number that a setting gives, and the bytes that it needs: more for more.
struct SizeOption {
  std::string setting;  // as messages call it
  std::uint64_t least = 1, most = 1;
  std::function<std::uint64_t(std::uint64_t)> need;
};

// Throws MemoryError when `bytes` are over `limit`, with the largest size that would fit, or
// `otherwise` (what else would help). doing: "fitting 2000 charges".
void requireMemoryFor(const std::string& doing, std::uint64_t bytes, std::uint64_t limit,
                      const SizeOption& size, const std::string& otherwise);

// Physical memory of the machine, or of the control group the process runs in, or what the limit on
// address space (ulimit -v) leaves: the least, in bytes.
std::uint64_t availableMemory();

// What the limit on address space leaves, in bytes; the largest number without a limit.
std::uint64_t addressSpaceLeft();

// The largest resident size this process has had, in bytes.
std::uint64_t peakMemory();

// What the libraries take once they work, in bytes, measured: buffers of BLAS and of the readers
// and writers, stacks of threads, code that was not touched before.
constexpr std::uint64_t kLibrariesAtWork = 24'000'000;

// The peak of this process if work takes `bytes` beyond what it holds now: the program, its
// libraries and all that was read. All functions ...Memory() of the library give such bytes; a
// program's limit is on the sum.
std::uint64_t processMemory(std::uint64_t bytes);

// The most bytes that processMemory() puts within memoryLimit(), at least 1; the largest number
// where there is no limit.
std::uint64_t memoryLeft();

// "1.5 GB": three significant digits, powers of 1000.
std::string formatBytes(std::uint64_t bytes);

// Reads "500M", "1.5GB", "2GiB", "800000000" (units of bytes). Throws SettingError naming
// `setting` when the text is not such a size or does not fit 64 bits.
std::uint64_t parseBytes(const std::string& setting, const std::string& text);

}  // namespace innermap
