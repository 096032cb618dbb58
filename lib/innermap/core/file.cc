#include "innermap/core/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "innermap/core/error.h"

namespace innermap {
namespace {

// Names of the files now unfinished, in fixed storage: removeUnfinishedFiles may run in a signal
// handler, where no lock may be taken and nothing allocated.
constexpr int kSlots = 1024;
constexpr std::size_t kLongestPath = 4096;
struct Slot {
  std::atomic<bool> used{false};
  std::atomic<bool> ready{false};
  char path[kLongestPath];
};
Slot slots[kSlots];

void remember(const std::string& path) {
  if (path.size() >= kLongestPath) return;
  for (Slot& slot : slots) {
    bool expected = false;
    if (!slot.used.compare_exchange_strong(expected, true)) continue;
    std::memcpy(slot.path, path.c_str(), path.size() + 1);
    slot.ready = true;
    return;
  }
}

void forget(const std::string& path) {
  for (Slot& slot : slots) {
    if (!slot.ready || path != slot.path) continue;
    slot.ready = false;
    slot.used = false;
    return;
  }
}

std::string systemMessage() { return std::strerror(errno); }

std::string temporaryName(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  const std::filesystem::path p(path);
  return (p.parent_path() / ("." + p.filename().string() + "." + std::to_string(getpid()) + "-" +
                             std::to_string(counter++) + ".part"))
      .string();
}

}  // namespace

PendingFile::PendingFile(const std::string& path) : path_(path) {
  if (path.empty()) throw FileError("output", "the path is empty; give a file name");
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw FileError(path, "is a folder; give a file name");
  temporary_ = temporaryName(path);
  remember(temporary_);
  const int file = open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
  if (file < 0) {
    const std::string why = systemMessage();
    forget(temporary_);
    throw FileError(path, "cannot be written (" + why + "); choose a folder that is writable");
  }
  close(file);
}

PendingFile::~PendingFile() {
  if (!committed_) unlink(temporary_.c_str());
  forget(temporary_);
}

void PendingFile::commit() {
  const int file = open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && fsync(file) == 0;
  const std::string why = synced ? "" : systemMessage();
  if (file >= 0) close(file);
  if (!synced) throw FileError(path_, "cannot be written to disk (" + why + "); free some space");
  if (rename(temporary_.c_str(), path_.c_str()) != 0)
    throw FileError(path_, "cannot be put in place (" + systemMessage() + ")");
  committed_ = true;
}

PendingFolder::PendingFolder(const std::string& folder)
    : folder_(folder), made_(makeFolder(folder)) {
  try {
    requireWritable((std::filesystem::path(folder) / "innermap").string());
  } catch (...) {
    if (made_) rmdir(folder_.c_str());
    throw;
  }
}

PendingFolder::~PendingFolder() {
  for (const auto& [temporary, final] : files_) {
    unlink(temporary.c_str());
    forget(temporary);
  }
  if (made_) rmdir(folder_.c_str());
}

void PendingFolder::write(const std::string& name,
                          const std::function<void(const std::string&)>& body) {
  const std::filesystem::path folder(folder_);
  const std::string temporary =
                        (folder / (".part-" + std::to_string(getpid()) + "-" + name)).string(),
                    final = (folder / name).string();
  remember(temporary);
  files_.emplace_back(temporary, final);
  try {
    body(temporary);
  } catch (const FileError& error) {
    const std::string what = error.what(), prefix = temporary + ": ";
    if (what.rfind(prefix, 0) != 0) throw;
    throw FileError(final, what.substr(prefix.size()));
  }
}

void PendingFolder::commit() {
  for (const auto& [temporary, final] : files_)
    if (rename(temporary.c_str(), final.c_str()) != 0)
      throw FileError(final, "cannot be put in place (" + systemMessage() + ")");
  for (const auto& [temporary, final] : files_) forget(temporary);
  files_.clear();
  made_ = false;
}

void removeUnfinishedFiles() noexcept {
  for (Slot& slot : slots)
    if (slot.ready) unlink(slot.path);
}

void writeWholeFile(const std::string& path, const std::function<void(std::ostream&)>& write) {
  PendingFile pending(path);
  std::ofstream file(pending.temporaryPath(), std::ios::binary | std::ios::trunc);
  if (!file) throw FileError(path, "cannot be opened for writing (" + systemMessage() + ")");
  errno = 0;
  write(file);
  file.flush();
  const std::string why = errno ? systemMessage() : "write error";
  if (!file) throw FileError(path, "cannot be written (" + why + "); free some space");
  file.close();
  if (!file) throw FileError(path, "cannot be closed (" + systemMessage() + ")");
  pending.commit();
}

void requireWritable(const std::string& path) { PendingFile probe(path); }

bool makeFolder(const std::string& path) {
  if (path.empty()) throw FileError("output", "the folder's path is empty; give a folder");
  std::error_code error;
  const bool made = std::filesystem::create_directories(path, error);
  if (error || !std::filesystem::is_directory(path))
    throw FileError(path, "cannot be made a folder (" +
                              (error ? error.message() : std::string("a file has that name")) +
                              "); choose another place");
  return made;
}

}  // namespace innermap
