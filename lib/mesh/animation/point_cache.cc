#include "mesh/animation/detail/point_cache.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "core/byte_order.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/mesh/mesh_file.h"

namespace innermap {
namespace {

bool endsAs(const std::string& path, const char* ending) {
  return equalsIgnoringCase(extensionOf(path), ending);
}

std::uint64_t countOf(const std::string& path, const char* bytes, bool big, const char* what) {
  const auto count = numberAt<std::int32_t>(bytes, big);
  if (count < 1)
    throw FileError(
        path,
        fmt::format("claims {} {}: not a point cache of this kind, or damaged; export it again",
                    count, what));
  return static_cast<std::uint64_t>(count);
}

}  // namespace

bool isPointCache(const std::string& path) { return endsAs(path, ".mdd") || endsAs(path, ".pc2"); }

PointCacheFormat pointCacheFormat(const std::string& path) {
  return endsAs(path, ".mdd") ? PointCacheFormat::mdd : PointCacheFormat::pc2;
}

PointCache::PointCache(const std::string& path)
    : file_(path, "a point cache"), format_(pointCacheFormat(path)) {
  if (format_ == PointCacheFormat::mdd)
    readMdd();
  else
    readPc2();
}

void PointCache::readMdd() {
  char head[8];
  if (file_.size() < sizeof(head)) throw FileError(path(), "is cut short; export it again");
  file_.read(0, head, sizeof(head));
  const std::uint64_t frames = countOf(path(), head, true, "frames");
  const std::uint64_t points = countOf(path(), head + 4, true, "points");
  frames_ = frames;
  points_ = points;
  begin_ = sizeof(head) + 4 * frames;
  requireSize(sizeof(head), 4 + kPointBytes * points);
}

void PointCache::readPc2() {
  char head[kPc2Header];
  if (file_.size() < sizeof(head)) throw FileError(path(), "is cut short; export it again");
  file_.read(0, head, sizeof(head));
  if (std::memcmp(head, kPc2Signature, sizeof(kPc2Signature)) != 0)
    throw FileError(path(), "does not begin with POINTCACHE2: no .pc2 point cache");
  if (const auto version = numberAt<std::int32_t>(head + 12, false); version != 1)
    throw FileError(path(),
                    fmt::format("is of version {} of the format; version 1 is read", version));
  points_ = countOf(path(), head + 16, false, "points");
  start_ = numberAt<float>(head + 20, false);
  step_ = numberAt<float>(head + 24, false);
  frames_ = countOf(path(), head + 28, false, "frames");
  constexpr float kMost = 1e9f;
  if (!(std::abs(start_) <= kMost) || !(step_ > 0 && step_ <= kMost))
    throw FileError(path(), "has no sensible start or rate in its header; export it again");
  begin_ = kPc2Header;
  requireSize(kPc2Header, kPointBytes * points_);
}

void PointCache::requireSize(std::uint64_t header, std::uint64_t ofFrame) const {
  // By division, as the product of two wrong counts may be over 64 bits.
  const std::uint64_t rest = file_.size() - header;
  if (rest / ofFrame < frames_)
    throw FileError(path(), fmt::format("is cut short, or its header is damaged: it claims {} "
                                        "frames of {} points, but holds {}; export it again",
                                        frames_, points_, rest / ofFrame));
  if (rest != frames_ * ofFrame)
    throw FileError(path(), fmt::format("has {} bytes more than its header claims; export it again",
                                        rest - frames_ * ofFrame));
}

std::vector<float> PointCache::seconds() const {
  if (format_ != PointCacheFormat::mdd) return {};
  std::string bytes(4 * frames_, '\0');
  file_.read(8, bytes.data(), bytes.size());
  std::vector<float> seconds(frames_);
  for (std::size_t i = 0; i < frames_; ++i) seconds[i] = numberAt<float>(&bytes[4 * i], true);
  return seconds;
}

std::string PointCache::bytes(std::size_t frame) const {
  const std::uint64_t size = kPointBytes * points_;
  requireMemory("reading a frame of " + path(), 3 * size, availableMemory(), "use a coarser mesh");
  std::string bytes(size, '\0');
  file_.read(begin_ + frame * size, bytes.data(), bytes.size());
  return bytes;
}

Points PointCache::read(std::size_t frame) const {
  const std::string all = bytes(frame);
  const bool big = format_ == PointCacheFormat::mdd;
  Points out(points_);
  for (std::size_t i = 0; i < points_; ++i) {
    const char* at = all.data() + kPointBytes * i;
    out[i] = {numberAt<float>(at, big), numberAt<float>(at + 4, big), numberAt<float>(at + 8, big)};
    if (!std::isfinite(out[i].x) || !std::isfinite(out[i].y) || !std::isfinite(out[i].z))
      throw FileError(path(), fmt::format("frame {} of {}: point {} (counted from 0) is not "
                                          "finite; export it again",
                                          frame + 1, frames_, i));
  }
  return out;
}

}  // namespace innermap
