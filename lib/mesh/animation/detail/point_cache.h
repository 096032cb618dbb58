// Point caches: the vertices of a mesh at every sample of an animation, in one file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/file_bytes.h"
#include "innermap/core/vec3.h"

namespace innermap {

enum class PointCacheFormat {
  mdd,  // LightWave's: big endian: int32 frames, int32 points, float32 seconds[frames], then
        // float32 x y z of each point, frame by frame
  pc2   // 3ds Max's: little endian: "POINTCACHE2\0", int32 version 1, int32 points, float32 start,
        // float32 frames a sample, int32 samples, then float32 x y z as above
};

constexpr char kPc2Signature[] = "POINTCACHE2";  // with the zero behind it
constexpr std::uint64_t kPc2Header = 32;         // bytes
constexpr std::uint64_t kPointBytes = 12;

// By the ending of such a path.
PointCacheFormat pointCacheFormat(const std::string& path);

class PointCache {
 public:
  // Reads the header. Throws FileError for what is no such file, has no frames or points, or has
  // another size than its counts say.
  explicit PointCache(const std::string& path);

  const std::string& path() const { return file_.path(); }
  PointCacheFormat format() const { return format_; }
  std::size_t frames() const { return frames_; }
  std::size_t points() const { return points_; }
  float start() const { return start_; }  // PC2: number of the first frame
  float step() const { return step_; }    // PC2: frames a sample
  std::vector<float> seconds() const;     // MDD: of each frame

  // As in the file: 12 bytes a point.
  std::string bytes(std::size_t frame) const;
  // Throws FileError for a place that is not finite.
  Points read(std::size_t frame) const;

 private:
  void readMdd();
  void readPc2();
  void requireSize(std::uint64_t header, std::uint64_t ofFrame) const;

  OpenFile file_;
  PointCacheFormat format_;
  std::size_t frames_ = 0, points_ = 0;
  std::uint64_t begin_ = 0;  // byte of the first frame
  float start_ = 0, step_ = 1;
};

}  // namespace innermap
