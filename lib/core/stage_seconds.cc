#include <algorithm>

#include "innermap/core/run.h"

namespace innermap {

void addSeconds(StageSeconds& stages, const std::string& stage, double seconds) {
  const auto known = std::find_if(stages.begin(), stages.end(),
                                  [&](const auto& entry) { return entry.first == stage; });
  if (known == stages.end())
    stages.emplace_back(stage, seconds);
  else
    known->second += seconds;
}

void addSeconds(StageSeconds& stages, const StageSeconds& more) {
  for (const auto& [stage, seconds] : more) addSeconds(stages, stage, seconds);
}

}  // namespace innermap
