// Files appear whole or not at all.
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "innermap/core/progress.h"

namespace innermap {

// A file being written: it has a temporary name beside the final one until commit() renames it.
// Destruction without commit() removes it. When the process must end at once (second Ctrl-C, time
// limit on cancelling), removeUnfinishedFiles() removes all that exist.
class PendingFile {
 public:
  // Throws FileError when the folder does not exist or is not writable, or when `path` is a folder.
  explicit PendingFile(const std::string& path);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::string& temporaryPath() const { return temporary_; }

  // Flushes to disk and renames. Throws FileError when either fails.
  void commit();

 private:
  std::string path_, temporary_;
  bool committed_ = false;
};

// Files that appear in a folder together or not at all. The folder is made when missing, and
// removed again on destruction without commit() when it was made here.
class PendingFolder {
 public:
  // Throws FileError when the folder cannot be made or not be written to.
  explicit PendingFolder(const std::string& folder);
  ~PendingFolder();
  PendingFolder(const PendingFolder&) = delete;
  PendingFolder& operator=(const PendingFolder&) = delete;

  // Calls `body` with the path where to write the file that will be called `name`: another name
  // with the same extension. FileErrors of it name the final path.
  void write(const std::string& name, const std::function<void(const std::string&)>& body);

  // Renames all files written. Throws FileError.
  void commit();

 private:
  std::string folder_;
  bool made_ = false;
  std::vector<std::pair<std::string, std::string>> files_;  // temporary, final
};

// Async-signal-safe; for the last moments of a process.
void removeUnfinishedFiles() noexcept;

// Writes through `write` into a PendingFile and commits. Throws FileError when the stream fails (a
// full disk, say), naming the path.
void writeWholeFile(const std::string& path, const std::function<void(std::ostream&)>& write);

// Throws FileError unless a file could be created at `path` now. For early refusal, before long
// computations.
void requireWritable(const std::string& path);

// Creates the folder and its parents when missing; true when it was. Throws FileError.
bool makeFolder(const std::string& path);

// 64 bits, the same on every machine: FNV-1a over words of eight bytes with a shift after each
// (Fowler, Noll, Vo, "The FNV Non-Cryptographic Hash Algorithm", 1991), finished as SplitMix64.
std::uint64_t hashOf(std::string_view bytes);

struct FingerprintSettings {
  Progress* progress = nullptr;
};

// Tells whether a file is still the one that a result was made from; not cryptographic.
// "558589-9f86d081884c7d65": its size and the hash of its content. Throws FileError when it cannot
// be read, Cancelled.
std::string fingerprintOf(const std::string& path, const FingerprintSettings& settings = {});

}  // namespace innermap
