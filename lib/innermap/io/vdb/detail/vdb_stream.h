// Stream buffers between OpenVDB and files: they poll for cancellation, and the reading one refuses
// every access beyond the file's end before a byte is copied.
#pragma once

#include <cstdint>
#include <fstream>
#include <streambuf>
#include <string>

namespace innermap {

// Hands everything to `to`, throwing Cancelled as the run is polled. A stream over it
// passes exceptions on when its exception mask has badbit.
class PollingOutputBuffer : public std::streambuf {
 public:
  explicit PollingOutputBuffer(std::streambuf& to) : to_(to) {}

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* data, std::streamsize count) override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir from,
                   std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;
  int sync() override { return to_.pubsync(); }

 private:
  std::streambuf& to_;
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
