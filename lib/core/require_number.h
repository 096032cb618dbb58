// Checks of numbers that have no Setting of their own.
#pragma once

#include <limits>
#include <string>

#include "innermap/core/setting.h"

namespace innermap {

// Throws SettingError unless `range` holds `value`. unit: what an error calls it, may be empty.
void requireNumber(const std::string& name, double value, const NumberRange& range,
                   const std::string& unit = "");

inline NumberRange above(double lower) {
  return {lower, std::numeric_limits<double>::infinity(), true};
}

}  // namespace innermap
