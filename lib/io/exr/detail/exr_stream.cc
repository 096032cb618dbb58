#include "io/exr/detail/exr_stream.h"

#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "io/exr/detail/exr_verify.h"

namespace innermap {

void ExrOutputStream::write(const char data[], int count) {
  throwIfCancelled();
  errno = 0;
  stream_.write(data, count);
  if (!stream_)
    throw FileError(path_, fmt::format("cannot be written ({}); free some space",
                                       errno ? std::strerror(errno) : "write error"));
  // A place is a number of 8 bytes, 0 for none.
  if (back_ && count == 8 && std::all_of(data, data + count, [](char c) { return c == 0; }))
    missing_ = true;
  end_ = std::max(end_, tellp());
}

void ExrOutputStream::seekp(std::uint64_t position) {
  stream_.seekp(static_cast<std::streamoff>(position));
  back_ = position < end_;
}

void ExrOutputStream::requireComplete() const {
  if (missing_) throw FileError(path_, "cannot be written whole: OpenEXR ran out of memory");
}

ExrInputStream::ExrInputStream(const std::string& path)
    : IStream(path.c_str()), buffer_(path), stream_(&buffer_) {
  // Exceptions of the buffer come through the stream.
  stream_.exceptions(std::ios::badbit | std::ios::failbit);
  verifyExr(path, stream_, buffer_.size());
  stream_.seekg(0);
}

bool ExrInputStream::read(char data[], int count) {
  stream_.read(data, count);
  return static_cast<std::uint64_t>(stream_.tellg()) < buffer_.size();
}

void withExrErrors(const std::string& path, const std::string& done, const std::string& hint,
                   const std::function<void()>& body) {
  try {
    body();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throwIfCancelled();
    throw FileError(path, fmt::format("cannot be {} ({}){}", done, error.what(), hint));
  }
}

ExrThreads::ExrThreads() : before_(Imf::globalThreadCount()) {
  Imf::setGlobalThreadCount(static_cast<int>(allowed()));
}

std::size_t ExrThreads::allowed() {
  const std::size_t most = 64, active = tbb::global_control::active_value(
                                   tbb::global_control::max_allowed_parallelism);
  return std::min(most, active);
}

ExrThreads::~ExrThreads() {
  try {
    Imf::setGlobalThreadCount(before_);
  } catch (const std::exception&) {
    // Without memory it keeps its threads, which wait.
  }
}

}  // namespace innermap
