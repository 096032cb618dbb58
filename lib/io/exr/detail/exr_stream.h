// OpenEXR over our own files: a full disk and a truncated file are noticed, cancelling works.
#pragma once

#include <OpenEXR/ImfIO.h>

#include <cstdint>
#include <functional>
#include <istream>
#include <ostream>
#include <string>

#include "io/vdb/detail/vdb_stream.h"

namespace innermap {

// OpenEXR's own file stream does not notice a disk that is full when it is closed; and a chunk that
// it has no memory to compress it leaves out without a word (3.1). Throws FileError naming `path`,
// Cancelled.
class ExrOutputStream : public Imf::OStream {
 public:
  ExrOutputStream(const std::string& path, std::ostream& stream)
      : OStream(path.c_str()), path_(path), stream_(stream) {}

  void write(const char data[], int count) override;
  std::uint64_t tellp() override { return static_cast<std::uint64_t>(stream_.tellp()); }
  void seekp(std::uint64_t position) override;

  // To be called when OpenEXR is done with it. Throws FileError when a chunk is missing.
  void requireComplete() const;

 private:
  std::string path_;
  std::ostream& stream_;
  std::uint64_t end_ = 0;  // of what is written
  bool back_ = false;      // in what was written before: the tables of the chunks' places, at last
  bool missing_ = false;
};

// Every access beyond the file's end is a FileError; polls for Cancelled.
class ExrInputStream : public Imf::IStream {
 public:
  // Throws FileError when the file cannot be opened or is no EXR file, or when a size in its
  // headers is beyond the file's: OpenEXR allocates by them.
  explicit ExrInputStream(const std::string& path);

  bool read(char data[], int count) override;
  std::uint64_t tellg() override { return static_cast<std::uint64_t>(stream_.tellg()); }
  void seekg(std::uint64_t position) override {
    stream_.seekg(static_cast<std::streamoff>(position));
  }
  void clear() override { stream_.clear(); }
  std::uint64_t size() const { return buffer_.size(); }

 private:
  CheckedInputBuffer buffer_;
  std::istream stream_;
};

// Runs `body`; what OpenEXR throws becomes a FileError: "PATH: cannot be DONE (...)HINT".
void withExrErrors(const std::string& path, const std::string& done, const std::string& hint,
                   const std::function<void()>& body);

// OpenEXR compresses on as many threads as the process may use while this lives; by itself it uses
// one. What is written does not depend on it.
class ExrThreads {
 public:
  ExrThreads();
  ~ExrThreads();

  static std::size_t allowed();  // their number

  ExrThreads(const ExrThreads&) = delete;
  ExrThreads& operator=(const ExrThreads&) = delete;

 private:
  int before_;
};

}  // namespace innermap
