#include "frame_velocity.h"

#include <fmt/format.h>

namespace innermap::tool {
namespace {

constexpr std::size_t kKept = 3;  // frames before the one asked for

}  // namespace

std::shared_ptr<const FrameFit> FrameFits::at(std::size_t index) {
  while (!kept_.empty() && kept_.begin()->first + kKept < index) kept_.erase(kept_.begin());
  const auto known = kept_.find(index);
  if (known != kept_.end() && known->second) return known->second;
  kept_[index] = nullptr;
  auto fit = std::make_shared<const FrameFit>(solver_.solve(frames_.all[index], context_));
  kept_[index] = fit;
  return fit;
}

std::shared_ptr<const FrameFit> FrameFits::tryAt(std::size_t index) {
  const auto known = kept_.find(index);
  if (known != kept_.end()) return known->second;
  try {
    return kept_[index] =
               std::make_shared<const FrameFit>(solver_.solve(frames_.all[index], context_));
  } catch (const FileError&) {
  } catch (const DataError&) {
  }
  kept_[index] = nullptr;
  return nullptr;
}

std::optional<std::size_t> FrameFits::neighbour(std::size_t index, int step) {
  const auto count = static_cast<std::ptrdiff_t>(frames_.all.size());
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(index) + step; i >= 0 && i < count; i += step)
    if (tryAt(static_cast<std::size_t>(i))) return static_cast<std::size_t>(i);
  return {};
}

HarmonicField FrameFits::velocity(std::size_t index, double framesPerSecond) {
  const std::shared_ptr<const FrameFit> here = at(index);
  const std::optional<std::size_t> before = neighbour(index, -1), after = neighbour(index, 1);
  const auto seconds = [&](std::size_t from, std::size_t to) {
    return static_cast<double>(frames_.all[to].number - frames_.all[from].number) / framesPerSecond;
  };
  if (!before && !after)
    throw DataError(
        fmt::format("{}: has no other frame to take its velocity from", frames_.all[index].path));
  if (!before || !after) {
    const std::size_t other = before ? *before : *after;
    const double t = seconds(index, other);
    return solver_.combined({{kept_[other].get(), 1 / t}, {here.get(), -1 / t}});
  }
  const double a = seconds(*before, index), b = seconds(index, *after);
  return solver_.combined({{kept_[*after].get(), a / (b * (a + b))},
                           {here.get(), (b - a) / (a * b)},
                           {kept_[*before].get(), -b / (a * (a + b))}});
}

}  // namespace innermap::tool
