// Stream buffers between OpenVDB and files: they poll for cancellation, and the reading one refuses
// every access beyond the file's end before a byte is copied.
#pragma once

#include <array>
#include <cstdint>
#include <fstream>
#include <streambuf>
#include <string>

namespace innermap {

// Where a .vdb file has the UUID that OpenVDB makes at random: 36 letters, after the magic number,
// the versions and the flag for offsets.
constexpr std::streamoff kUuidPlace = 21, kUuidSize = 36;

// Hands everything to `to`, throwing Cancelled as the run is polled. A stream over it
// passes exceptions on when its exception mask has badbit.
class PollingOutputBuffer : public std::streambuf {
 public:
  explicit PollingOutputBuffer(std::streambuf& to) : to_(to) {}

  // Of all that was written behind the UUID, and where to, as a UUID of version 8 (RFC 9562): the
  // same for the same grids. Not cryptographic.
  std::string contentUuid() const;

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* data, std::streamsize count) override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir from,
                   std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;
  int sync() override { return to_.pubsync(); }

 private:
  void hash(const char* data, std::streamsize count);

  std::streambuf& to_;
  std::streamoff position_ = 0;
  std::array<std::uint64_t, 2> hash_{1, 2};
};

// Reads a file. Throws FileError ("is truncated or damaged") for reads and seeks beyond the end,
// Cancelled.
class CheckedInputBuffer : public std::streambuf {
 public:
  explicit CheckedInputBuffer(const std::string& path);

  std::uint64_t size() const { return static_cast<std::uint64_t>(size_); }

 protected:
  int_type underflow() override;
  int_type uflow() override;
  std::streamsize xsgetn(char* data, std::streamsize count) override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir from,
                   std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
  void require(std::streamoff position, std::streamoff count) const;
  [[noreturn]] void fail() const;

  std::string path_;
  std::filebuf file_;
  std::streamoff size_ = 0, position_ = 0;
};

}  // namespace innermap
