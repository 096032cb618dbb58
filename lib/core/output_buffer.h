// Text that is written in large pieces.
#pragma once

#include <fmt/format.h>

#include <iterator>
#include <ostream>
#include <string_view>
#include <utility>

namespace innermap {

// Bytes on their way to a file.
class OutputBuffer {
 public:
  explicit OutputBuffer(std::ostream& stream) : stream_(stream) {}
  ~OutputBuffer() { flush(); }
  OutputBuffer(const OutputBuffer&) = delete;
  OutputBuffer& operator=(const OutputBuffer&) = delete;

  void raw(std::string_view bytes) {
    text_.append(bytes.data(), bytes.data() + bytes.size());
    if (text_.size() > (1u << 20)) flush();
  }
  // Its bytes, the least first, as on all machines that innermap runs on.
  template <class Number>
  void number(Number value) {
    raw({reinterpret_cast<const char*>(&value), sizeof value});
  }
  template <class... Args>
  void print(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    if (text_.size() > (1u << 20)) flush();
  }

 private:
  void flush() {
    stream_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
    text_.clear();
  }
  std::ostream& stream_;
  fmt::memory_buffer text_;
};

}  // namespace innermap
