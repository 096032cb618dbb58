#include "core/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/detail/output_place.h"
#include "core/unfinished.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

namespace fs = std::filesystem;

constexpr char kFolderKey[] = "";  // of the temporaries of PendingFolder

std::string systemMessage() { return std::strerror(errno); }

std::string folderOf(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

// Names of the temporaries of what is called `key` begin so.
std::string temporaryPrefix(std::string_view key) {
  char hash[32];
  std::snprintf(hash, sizeof hash, ".innermap-%016llx-",
                static_cast<unsigned long long>(hashOf(key)));
  return hash;
}

std::string temporaryName(const std::string& folder, std::string_view key) {
  static std::atomic<unsigned> counter{0};
  return (fs::path(folder) / (temporaryPrefix(key) + std::to_string(getpid()) + "-" +
                              std::to_string(counter++) + ".part"))
      .string();
}

// A temporary made by `make` (which returns a descriptor, or -1 with errno set), locked. `path` is
// what errors name.
int makeLocked(const std::string& path, UnfinishedKind kind, const std::string& folder,
               std::string_view key, std::string& temporary, int (*make)(const char*)) {
  for (;;) {
    temporary = temporaryName(folder, key);
    rememberUnfinished(kind, temporary);
    const int file = make(temporary.c_str());
    if (file < 0) {
      const int error = errno;
      forgetUnfinished(temporary);
      if (error == EEXIST) continue;
      throw FileError(path, whyNotWritable(temporary, error));
    }
    // Between the two, another process may have taken it for one that was left behind.
    struct stat status {};
    lockTemporary(file);
    if (fstat(file, &status) != 0 || status.st_nlink > 0) return file;
    close(file);
    forgetUnfinished(temporary);
  }
}

int makeFile(const char* path) { return open(path, O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666); }

int makeLockedFolder(const char* path) {
  if (mkdir(path, 0777) != 0) return -1;
  const int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) rmdir(path);
  return folder;
}

std::string temporaryFolder() {
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  return error ? "/tmp" : folder.string();
}

// Whether a file is one of a PendingFolder, which counts them together.
bool isStaged(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.filename() == kWritten &&
         folder.parent_path().filename().string().rfind(temporaryPrefix(kFolderKey), 0) == 0;
}

void requireOpenable(const std::string& path, const std::string& place) {
  if (access(place.c_str(), W_OK) != 0) throw FileError(path, whyNotWritable(place, errno));
}

// Appends what stands in `from` to the device or pipe.
void copyInto(const std::string& path, const std::string& place, const std::string& from) {
  const auto fail = [&] { throw FileError(path, "cannot be written (" + systemMessage() + ")"); };
  std::ifstream in(from, std::ios::binary);
  const int out = open(place.c_str(), O_WRONLY | O_APPEND | O_NOCTTY | O_CLOEXEC);
  if (out < 0) fail();
  std::vector<char> buffer(1 << 16);
  while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), in.gcount() > 0)
    for (std::streamsize at = 0; at < in.gcount();) {
      const ssize_t size =
          ::write(out, buffer.data() + at, static_cast<std::size_t>(in.gcount() - at));
      if (size < 0 && errno == EINTR) continue;
      if (size < 0) {
        const int error = errno;
        close(out);
        errno = error;
        fail();
      }
      at += size;
    }
  if (close(out) != 0) fail();
}

// The file's permissions stay as they were.
void keepMode(int temporary, const std::string& place) {
  struct stat old {};
  if (stat(place.c_str(), &old) == 0 && fchmod(temporary, old.st_mode & 0777) != 0) errno = 0;
}

void removeFolders(const std::vector<std::string>& made) noexcept {
  for (auto folder = made.rbegin(); folder != made.rend(); ++folder) {
    rmdir(folder->c_str());
    forgetUnfinished(*folder);
  }
}

// Those that were made, outermost first.
std::vector<std::string> makeFolders(const std::string& path) {
  if (path.empty()) throw FileError("output", "the folder's path is empty; give a folder");
  std::vector<std::string> made;
  fs::path at;
  try {
    for (const fs::path& part : fs::path(path)) {
      at /= part;
      made.push_back(at.string());
      rememberUnfinished(UnfinishedKind::folder, made.back());
      if (mkdir(at.c_str(), 0777) == 0) continue;
      const int error = errno;
      forgetUnfinished(made.back());
      made.pop_back();
      std::error_code ignored;
      if (fs::is_directory(at, ignored)) continue;
      const std::string why = error == EEXIST ? "a file has that name" : std::strerror(error);
      throw FileError(path, "cannot be made a folder (" +
                                (at == fs::path(path) ? why : at.string() + ": " + why) +
                                "); choose another place");
    }
  } catch (...) {
    removeFolders(made);
    throw;
  }
  return made;
}

}  // namespace

PendingFile::PendingFile(const std::string& path) : path_(path) {
  const OutputPlace place = outputPlace(path);
  place_ = place.path;
  through_ = place.through;
  if (through_) requireOpenable(path, place_);
  const std::string folder = through_ ? temporaryFolder() : folderOf(place_);
  const std::string key = fs::path(place_).filename().string();
  clearLeftBehind(folder, temporaryPrefix(key));
  lock_ = makeLocked(path, UnfinishedKind::file, folder, key, temporary_, makeFile);
}

PendingFile::~PendingFile() {
  if (!committed_) unlink(temporary_.c_str());
  forgetUnfinished(temporary_);
  close(lock_);
}

void PendingFile::commit() {
  if (through_) {
    copyInto(path_, place_, temporary_);
    countInPlace();
    return;
  }
  if (fsync(lock_) != 0)
    throw FileError(path_, "cannot be written to disk (" + systemMessage() + "); free some space");
  keepMode(lock_, place_);
  const CommitGuard guard;
  if (rename(temporary_.c_str(), place_.c_str()) != 0)
    throw FileError(path_, "cannot be put in place (" + systemMessage() + ")");
  committed_ = true;
  if (!isStaged(place_)) countInPlace();
}

// The temporary folder beside files that appear together: what is new, and what that replaces.
struct PendingFolder::Staging {
  std::string parent, path;
  int lock = -1;

  // Of what goes into devices and pipes (`folder` is empty) the machine's temporary folder.
  Staging(const std::string& folder, const std::string& named) : parent(folder) {
    const std::string place = folder.empty() ? temporaryFolder() : folder;
    clearLeftBehind(place, temporaryPrefix(kFolderKey));
    lock = makeLocked(named, UnfinishedKind::tree, place, kFolderKey, path, makeLockedFolder);
    try {
      if (mkdir(at(kWritten).c_str(), 0777) != 0) {
        const int error = errno;
        throw FileError(named, whyNotWritable(at(kWritten), error));
      }
    } catch (...) {
      remove();
      throw;
    }
  }
  ~Staging() { remove(); }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  std::string at(const char* what) const { return path + "/" + what; }
  void remove() noexcept {
    removeTree(path);
    forgetUnfinished(path);
    close(lock);
  }
};

PendingFolder::PendingFolder(const std::string& folder)
    : folder_(folder), made_(makeFolders(folder)) {
  try {
    clearLeftBehind(folder, temporaryPrefix(kFolderKey));
    requireWritable((fs::path(folder) / "innermap").string());
  } catch (...) {
    removeFolders(made_);
    throw;
  }
}

PendingFolder::~PendingFolder() {
  stagings_.clear();
  removeFolders(made_);
}

PendingFolder::Staging& PendingFolder::stagingFor(const std::string& folder) {
  for (const auto& staging : stagings_)
    if (staging->parent == folder) return *staging;
  stagings_.push_back(std::make_unique<Staging>(folder, folder_));
  return *stagings_.back();
}

void PendingFolder::write(const std::string& name,
                          const std::function<void(const std::string&)>& body) {
  File file;
  file.path = (fs::path(folder_) / name).string();
  const OutputPlace place = outputPlace(file.path);
  file.place = place.path;
  file.through = place.through;
  if (place.through) requireOpenable(file.path, file.place);
  const Staging& staging = stagingFor(place.through ? "" : folderOf(place.path));
  // Writers go by the ending, which a link's target may not have.
  const fs::path placed = fs::path(place.path).filename();
  const std::string written =
      placed.extension() == fs::path(name).extension() ? placed.string() : name;
  file.temporary = staging.at(kWritten) + "/" + written;
  file.replaced = staging.at(kReplaced) + "/" + written;
  try {
    body(file.temporary);
  } catch (const FileError& error) {
    const std::string what = error.what(), prefix = file.temporary + ": ";
    if (what.rfind(prefix, 0) != 0) throw;
    throw FileError(file.path, what.substr(prefix.size()));
  }
  files_.push_back(std::move(file));
}

void PendingFolder::remove(const std::string& name) {
  File file;
  file.path = (fs::path(folder_) / name).string();
  std::error_code unknown;  // links stay, and what they lead to
  if (!fs::is_regular_file(fs::symlink_status(file.path, unknown))) return;
  file.place = file.path;
  file.replaced = stagingFor(folderOf(file.path)).at(kReplaced) + "/" + name;
  files_.push_back(std::move(file));
}

std::vector<std::pair<std::string, std::uint64_t>> PendingFolder::written() const {
  std::vector<std::pair<std::string, std::uint64_t>> out;
  for (const File& file : files_) {
    if (file.temporary.empty()) continue;
    std::error_code unknown;
    const std::uintmax_t bytes = fs::file_size(file.temporary, unknown);
    out.emplace_back(file.path, unknown ? 0 : bytes);
  }
  return out;
}

void PendingFolder::putInPlace(const File& file) {
  const auto fail = [&] {
    throw FileError(file.path, "cannot be put in place (" + systemMessage() + ")");
  };
  if (file.through) return copyInto(file.path, file.place, file.temporary);
  if (file.temporary.empty()) {
    if (rename(file.place.c_str(), file.replaced.c_str()) != 0 && errno != ENOENT) fail();
    return;
  }
  // A second name for the old file, where the disk has such: there is no moment without one then.
  if (link(file.place.c_str(), file.replaced.c_str()) != 0 && errno != ENOENT &&
      rename(file.place.c_str(), file.replaced.c_str()) != 0)
    fail();
  if (rename(file.temporary.c_str(), file.place.c_str()) != 0) {
    const int error = errno;
    rename(file.replaced.c_str(), file.place.c_str());
    errno = error;
    fail();
  }
}

void PendingFolder::putBack(const File& file) noexcept {
  if (file.through) return;
  // There was none before.
  if (rename(file.replaced.c_str(), file.place.c_str()) != 0 && errno == ENOENT)
    unlink(file.place.c_str());
}

void PendingFolder::commit() {
  for (const File& file : files_) outputPlace(file.path);  // no folder has taken its name
  const CommitGuard guard;
  for (const auto& staging : stagings_)
    if (!staging->parent.empty() && mkdir(staging->at(kReplaced).c_str(), 0777) != 0)
      throw FileError(folder_, "cannot be written (" + systemMessage() + "); free some space");
  // What cannot be put back comes last.
  std::stable_partition(files_.begin(), files_.end(), [](const File& f) { return !f.through; });
  std::size_t placed = 0;
  try {
    for (; placed < files_.size(); ++placed) putInPlace(files_[placed]);
  } catch (...) {
    while (placed > 0) putBack(files_[--placed]);
    throw;
  }
  files_.clear();
  stagings_.clear();
  for (const std::string& folder : made_) forgetUnfinished(folder);
  made_.clear();
  countInPlace();
}

void removeUnfinishedFiles() noexcept { removeUnfinished(); }
bool commitUnderWay() noexcept { return isCommitting(); }
std::uint64_t outputsInPlace() noexcept { return countOfInPlace(); }

std::string fileKey(const std::string& path) {
  const auto numbers = [](const struct stat& status) {
    return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
  };
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) return S_ISREG(status.st_mode) ? numbers(status) : "";
  try {
    const fs::path place = outputPlace(path).path;
    const std::string folder = folderOf(place.string());
    if (stat(folder.c_str(), &status) == 0)
      return numbers(status) + "/" + place.filename().string();
    return fs::weakly_canonical(fs::absolute(place)).string();
  } catch (const std::exception&) {
    return "";
  }
}

bool isSameFile(const std::string& a, const std::string& b) {
  const std::string key = fileKey(a);
  return !key.empty() && key == fileKey(b);
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

void requireWritable(const std::string& path) {
  // To open a pipe and close it would be the end of the file to who reads it.
  const OutputPlace place = outputPlace(path);
  if (place.through) return requireOpenable(path, place.path);
  const PendingFile probe(path);
}

bool makeFolder(const std::string& path) {
  const std::vector<std::string> made = makeFolders(path);
  for (const std::string& folder : made) forgetUnfinished(folder);
  return !made.empty();
}

}  // namespace innermap
