#include <algorithm>
#include <cmath>

#include "innermap/study/study.h"

namespace innermap {

std::size_t collocationOf(const StudyRun& run) {
  const double wanted = std::round(run.collocation * static_cast<double>(run.sources));
  return std::max(static_cast<std::size_t>(wanted), run.sources + 4);
}

bool sameRun(const StudyRun& a, const StudyRun& b) {
  constexpr double kSame = 1e-9;
  return a.sources == b.sources && a.placement == b.placement &&
         std::abs(a.at - b.at) <= kSame * b.at && collocationOf(a) == collocationOf(b);
}

}  // namespace innermap
