// Files appear whole or not at all.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

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

// Async-signal-safe; for the last moments of a process.
void removeUnfinishedFiles() noexcept;

// Writes through `write` into a PendingFile and commits. Throws FileError when the stream fails (a
// full disk, say), naming the path.
void writeWholeFile(const std::string& path, const std::function<void(std::ostream&)>& write);

// Throws FileError unless a file could be created at `path` now. For early refusal, before long
// computations.
void requireWritable(const std::string& path);

// Creates the folder and its parents when missing. Throws FileError.
void makeFolder(const std::string& path);

}  // namespace innermap
