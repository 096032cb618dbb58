// A share of a run that is cut over several processes or machines: "3/40" is the third of forty.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace innermap {

struct Share {
  static constexpr std::uint64_t kMost = 1'000'000;

  std::uint64_t number = 1, of = 1;  // 1 to `of`, which is at most kMost

  // Of things in a row that take so long each, above 0, this share has [first, second), which may
  // be empty. The shares of one `of` have each thing once, and take as long as each other but for
  // one thing at most.
  std::pair<std::size_t, std::size_t> range(const std::vector<std::uint64_t>& weights) const;
};

// The value of an environment variable, none where it is not set.
using Environment = std::function<std::optional<std::string>(const std::string&)>;
std::optional<std::string> environmentVariable(const std::string& name);

// "3/40", or "auto": as the engine that started this process says.
// - Slurm's job arrays: SLURM_ARRAY_TASK_ID, _MIN, _MAX, _STEP, _COUNT
// (https://slurm.schedmd.com/job_array.html), whose numbers must be evenly spaced.
// - OpenCue: CUE_IFRAME in the layer's CUE_RANGE, "1-40" or "1-79x2".
// OpenJD and others that set no variables put both numbers into the command.
// Throws SettingError naming `setting` for other texts, for numbers out of range, and when no
// engine's variables are set or they make no sense.
Share parseShare(const std::string& setting, const std::string& text,
                 const Environment& environment = environmentVariable);

// How often the engine has started this process's task again, by Slurm's SLURM_RESTART_COUNT; 0
// where nothing tells.
std::uint64_t taskRestarts(const Environment& environment = environmentVariable);

}  // namespace innermap
