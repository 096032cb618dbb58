// Stream buffers between OpenVDB and files: they poll for cancellation, and the reading one refuses
// every access beyond the file's end before a byte is copied.
#pragma once

#include <cstdint>
#include <fstream>
#include <streambuf>
#include <string>

#include "innermap/core/progress.h"

namespace innermap {

// Hands everything to `to`, throwing Cancelled when `progress` was cancelled. A stream over it
// passes exceptions on when its exception mask has badbit.
class PollingOutputBuffer : public std::streambuf {
 public:
  PollingOutputBuffer(std::streambuf& to, const Progress* progress)
      : to_(to), progress_(progress) {}

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* data, std::streamsize count) override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir from,
                   std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;
  int sync() override { return to_.pubsync(); }

 private:
  std::streambuf& to_;
  const Progress* progress_;
};

// Reads a file. Throws FileError ("is truncated or damaged") for reads and seeks beyond the end,
// Cancelled when `progress` was cancelled.
class CheckedInputBuffer : public std::streambuf {
 public:
  CheckedInputBuffer(const std::string& path, const Progress* progress);

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
  const Progress* progress_;
  std::filebuf file_;
  std::streamoff size_ = 0, position_ = 0;
};

}  // namespace innermap
