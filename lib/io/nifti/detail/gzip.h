// Bytes packed by gzip (RFC 1952), out and in.
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>

namespace innermap {

bool isGzip(std::string_view bytes);

// The first `count` bytes of what is packed, fewer where there are fewer. Throws FileError naming
// `path` for damaged data, Cancelled.
std::string unpacked(const std::string& path, std::string_view packed, std::uint64_t count);

// Deflate makes at most so many bytes of `packed` ones.
inline std::uint64_t mostUnpacked(std::uint64_t packed) { return 1032 * packed + 1024; }

// Packs what it is given into a stream, with no time and no name: the same bytes each time.
class GzipWriter {
 public:
  explicit GzipWriter(std::ostream& stream);
  ~GzipWriter();
  GzipWriter(const GzipWriter&) = delete;
  GzipWriter& operator=(const GzipWriter&) = delete;

  void add(std::string_view bytes);
  void finish();  // once, after all

 private:
  void run(std::string_view bytes, int flush);
  struct State;
  std::ostream& stream_;
  std::unique_ptr<State> state_;
};

}  // namespace innermap
