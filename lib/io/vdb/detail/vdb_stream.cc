#include "io/vdb/detail/vdb_stream.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "core/file.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {

PollingOutputBuffer::int_type PollingOutputBuffer::overflow(int_type c) {
  throwIfCancelled();
  if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
  const char letter = traits_type::to_char_type(c);
  hash(&letter, 1);
  return to_.sputc(letter);
}

std::streamsize PollingOutputBuffer::xsputn(const char* data, std::streamsize count) {
  throwIfCancelled();
  hash(data, count);
  return to_.sputn(data, count);
}

// All in front of the UUID's end is the same in every file, but for that.
void PollingOutputBuffer::hash(const char* data, std::streamsize count) {
  if (position_ >= kUuidPlace + kUuidSize) {
    const std::uint64_t chunk = hashOf({data, static_cast<std::size_t>(count)});
    for (std::uint64_t& h : hash_) {
      const std::array<std::uint64_t, 3> all{h, static_cast<std::uint64_t>(position_), chunk};
      h = hashOf({reinterpret_cast<const char*>(all.data()), sizeof(all)});
    }
  }
  position_ += count;
}

std::string PollingOutputBuffer::contentUuid() const {
  std::string hex = fmt::format("{:016x}{:016x}", hash_[0], hash_[1]);
  hex[12] = '8';  // the version
  hex[16] = 'a';  // the variant
  return fmt::format("{}-{}-{}-{}-{}", hex.substr(0, 8), hex.substr(8, 4), hex.substr(12, 4),
                     hex.substr(16, 4), hex.substr(20));
}

PollingOutputBuffer::pos_type PollingOutputBuffer::seekoff(off_type offset,
                                                           std::ios_base::seekdir from,
                                                           std::ios_base::openmode which) {
  const pos_type at = to_.pubseekoff(offset, from, which);
  if (at != pos_type(off_type(-1))) position_ = at;
  return at;
}

PollingOutputBuffer::pos_type PollingOutputBuffer::seekpos(pos_type position,
                                                           std::ios_base::openmode which) {
  const pos_type at = to_.pubseekpos(position, which);
  if (at != pos_type(off_type(-1))) position_ = at;
  return at;
}

CheckedInputBuffer::CheckedInputBuffer(const std::string& path) : path_(path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    throw FileError(path, "does not exist; give the path of a .vdb file");
  if (!std::filesystem::is_regular_file(status))
    throw FileError(path, "is not a file; give the path of a .vdb file");
  errno = 0;
  if (!file_.open(path, std::ios::in | std::ios::binary))
    throw FileError(path, std::string("cannot be opened (") + std::strerror(errno) +
                              "); check its permissions");
  size_ = file_.pubseekoff(0, std::ios::end);
  file_.pubseekoff(0, std::ios::beg);
}

void CheckedInputBuffer::fail() const {
  throw FileError(path_, "is truncated or damaged; write it again");
}

void CheckedInputBuffer::require(std::streamoff position, std::streamoff count) const {
  throwIfCancelled();
  if (count < 0 || position < 0 || position > size_ || count > size_ - position) fail();
}

CheckedInputBuffer::int_type CheckedInputBuffer::underflow() {
  require(position_, 1);
  return file_.sgetc();
}

CheckedInputBuffer::int_type CheckedInputBuffer::uflow() {
  require(position_, 1);
  ++position_;
  return file_.sbumpc();
}

std::streamsize CheckedInputBuffer::xsgetn(char* data, std::streamsize count) {
  require(position_, count);
  const std::streamsize got = file_.sgetn(data, count);
  position_ += got;
  if (got != count) fail();
  return got;
}

CheckedInputBuffer::pos_type CheckedInputBuffer::seekoff(off_type offset,
                                                         std::ios_base::seekdir from,
                                                         std::ios_base::openmode) {
  if (from == std::ios_base::cur && offset == 0) return position_;
  const std::streamoff base = from == std::ios_base::cur   ? position_
                              : from == std::ios_base::end ? size_
                                                           : 0;
  if (offset > size_ || offset < -size_) fail();
  require(base + offset, 0);
  position_ = base + offset;
  return file_.pubseekoff(position_, std::ios_base::beg, std::ios_base::in);
}

CheckedInputBuffer::pos_type CheckedInputBuffer::seekpos(pos_type position,
                                                         std::ios_base::openmode which) {
  return seekoff(position, std::ios_base::beg, which);
}

}  // namespace innermap
