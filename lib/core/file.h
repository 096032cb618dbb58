// Files appear whole or not at all.
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace innermap {

// A file being written: it has a temporary name beside the final one until commit() renames it.
// Links are followed: what they name is replaced. Into a device, a pipe or an open file
// (/dev/stdout) commit() copies what was written. Destruction without commit() removes it. When the
// process must end at once (second Ctrl-C, time limit on cancelling), removeUnfinishedFiles()
// removes all that exist; what a killed process left behind, the next PendingFile of the same path
// removes.
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
  std::string path_, place_, temporary_;
  int lock_ = -1;  // the temporary, open
  bool through_ = false, committed_ = false;
};

// Files that appear in a folder together or not at all. The folder and its parents are made when
// missing, and removed again on destruction without commit() when they were made here and are
// empty.
class PendingFolder {
 public:
  // Throws FileError when the folder cannot be made or not be written to.
  explicit PendingFolder(const std::string& folder);
  ~PendingFolder();
  PendingFolder(const PendingFolder&) = delete;
  PendingFolder& operator=(const PendingFolder&) = delete;

  // Calls `body` with the path where to write the file that will be called `name`: another folder,
  // the same name. FileErrors of it name the final path.
  void write(const std::string& name, const std::function<void(const std::string&)>& body);

  // A file of this name that stands there goes when the others come. Links and folders stay.
  void remove(const std::string& name);

  // The files written so far: their final paths, and their sizes in bytes.
  std::vector<std::pair<std::string, std::uint64_t>> written() const;

  // Puts all files written in place, or throws FileError and none is. A process that is killed in
  // the middle leaves the rest for the next PendingFolder of the same folder to put in place.
  void commit();

 private:
  struct Staging;
  struct File {
    std::string temporary, path, place, replaced;  // temporary: empty of what is to go
    bool through = false;
  };
  Staging& stagingFor(const std::string& folder);
  void putInPlace(const File& file);
  void putBack(const File& file) noexcept;

  std::string folder_;
  std::vector<std::string> made_;  // outermost first
  std::vector<std::unique_ptr<Staging>> stagings_;
  std::vector<File> files_;
};

// All three async-signal-safe. The first is for the last moments of a process.
void removeUnfinishedFiles() noexcept;
// While files are put in place; the process should not end then.
bool commitUnderWay() noexcept;
// How many files, and folders of files, this process has put in place.
std::uint64_t outputsInPlace() noexcept;

// The same for all paths of one regular file, through links; also of one that is not there yet.
// Empty for devices, pipes, folders, and where no file can be.
std::string fileKey(const std::string& path);
bool isSameFile(const std::string& a, const std::string& b);

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

// Tells whether a file is still the one that a result was made from; not cryptographic.
// "558589-9f86d081884c7d65": its size and the hash of its content. Throws FileError when it cannot
// be read, Cancelled.
std::string fingerprintOf(const std::string& path);

}  // namespace innermap
