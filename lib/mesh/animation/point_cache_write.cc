#include <fmt/format.h>

#include <cmath>
#include <ostream>

#include "core/byte_order.h"
#include "core/file.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/animation/detail/point_cache.h"

namespace innermap {
namespace {

// Frames a sample.
std::int64_t stepOf(const std::string& path, const std::vector<std::int64_t>& numbers) {
  if (numbers.size() < 2) return 1;
  const std::int64_t step = numbers[1] - numbers[0];
  for (std::size_t i = 1; i < numbers.size(); ++i)
    if (numbers[i] - numbers[i - 1] != step)
      throw FileError(path,
                      fmt::format("holds frames at even steps only, and {} does not follow {} "
                                  "as {} does {}; choose others, or write .mdd",
                                  numbers[i], numbers[i - 1], numbers[1], numbers[0]));
  return step;
}

std::int32_t countFor(const std::string& path, std::uint64_t count) {
  requireCountable(path, count);
  return static_cast<std::int32_t>(count);
}

std::string header(const std::string& path, const PointCacheLayout& layout) {
  const std::int32_t points = countFor(path, layout.points);
  const std::int32_t frames = countFor(path, layout.numbers.size());
  std::string out;
  if (pointCacheFormat(path) == PointCacheFormat::mdd) {
    appendNumber(out, frames, true);
    appendNumber(out, points, true);
    for (const std::int64_t number : layout.numbers)
      appendNumber(out,
                   static_cast<float>(static_cast<double>(number - layout.numbers.front()) /
                                      layout.framesPerSecond),
                   true);
    return out;
  }
  out.append(kPc2Signature, sizeof(kPc2Signature));
  appendNumber(out, std::int32_t(1), false);
  appendNumber(out, points, false);
  appendNumber(out, static_cast<float>(layout.numbers.front()), false);
  appendNumber(out, static_cast<float>(stepOf(path, layout.numbers)), false);
  appendNumber(out, frames, false);
  return out;
}

std::string bytesOf(const std::string& path, const Points& points) {
  const bool big = pointCacheFormat(path) == PointCacheFormat::mdd;
  std::string out;
  out.reserve(kPointBytes * points.size());
  for (const Vec3& p : points)
    for (int a = 0; a < 3; ++a) {
      const auto place = static_cast<float>(p[a]);
      if (!std::isfinite(place))
        throw DataError(path + ": a point has no place that a float can hold");
      appendNumber(out, place, big);
    }
  return out;
}

}  // namespace

void writePointCache(const std::string& path, const PointCacheLayout& layout,
                     const std::function<void(const std::function<void(const Points&)>&)>& frames) {
  if (layout.numbers.empty() || layout.points == 0)
    throw DataError(path + ": a point cache needs a frame and a point at least");
  const std::string head = header(path, layout);
  writeWholeFile(path, [&](std::ostream& file) {
    std::size_t written = 0;
    file << head;
    frames([&](const Points& points) {
      if (points.size() != layout.points)
        throw DataError(
            fmt::format("{}: a frame has {} points, not {}", path, points.size(), layout.points));
      file << bytesOf(path, points);
      if (!file) throw FileError(path, "cannot be written; free some space");
      ++written;
    });
    if (written != layout.numbers.size())
      throw DataError(
          fmt::format("{}: is not written, as it needs all {} frames, and {} could be "
                      "made",
                      path, layout.numbers.size(), written));
  });
}

}  // namespace innermap
