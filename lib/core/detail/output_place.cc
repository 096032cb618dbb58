#include "core/detail/output_place.h"

#include <fcntl.h>
#include <limits.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "innermap/core/error.h"

namespace innermap {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLinks = 40;  // as the kernel's

bool isOpenFile(const fs::path& link) {
  // Links of /proc name open files, whose own names may be gone or taken by others.
  std::error_code ignored;
  const fs::path folder = fs::weakly_canonical(link.parent_path(), ignored);
  return folder.string().rfind("/proc/", 0) == 0;
}

fs::path folderOf(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

// Puts the new files of a folder whose commit was cut off in place; the folder is then empty.
void finishCommit(const fs::path& left, const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator at(left / kWritten, error), end; !error && at != end;
       at.increment(error)) {
    std::error_code ignored;
    fs::rename(at->path(), folder / at->path().filename(), ignored);
  }
}

void clear(const fs::path& left, const fs::path& folder) {
  const int file = open(left.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return;
  struct stat status {};
  const bool own = fstat(file, &status) == 0 && status.st_uid == geteuid();
  if (own && lockTemporary(file)) {
    std::error_code ignored;
    if (fs::is_directory(left / kReplaced, ignored)) finishCommit(left, folder);
    fs::remove_all(left, ignored);
  }
  close(file);
}

}  // namespace

OutputPlace outputPlace(const std::string& path) {
  if (path.empty()) throw FileError("output", "the path is empty; give a file name");
  OutputPlace place{path, false};
  for (int links = 0;; ++links) {
    struct stat status {};
    const fs::path at(place.path);
    if (lstat(place.path.c_str(), &status) != 0) {
      if (errno != ENOENT) throw FileError(path, whyNotWritable(place.path, errno));
      break;
    }
    if (S_ISDIR(status.st_mode)) throw FileError(path, "is a folder; give a file name");
    if (!S_ISLNK(status.st_mode)) {
      place.through = !S_ISREG(status.st_mode);
      break;
    }
    if (links == kMostLinks)
      throw FileError(path, "is a link that leads round in a circle; give another name");
    if (isOpenFile(at)) {
      place.through = true;
      break;
    }
    std::error_code error;
    const fs::path target = fs::read_symlink(at, error);
    if (error) throw FileError(path, whyNotWritable(place.path, error.value()));
    place.path = target.is_absolute() ? target.string() : (at.parent_path() / target).string();
  }
  if (fs::path(place.path).filename().empty())
    throw FileError(path, "names a folder, not a file; give a file name");
  return place;
}

std::string whyNotWritable(const std::string& path, int error) {
  const std::string why = std::strerror(error);
  const fs::path folder = folderOf(path);
  const auto cannot = [&](const std::string& advice) {
    return "cannot be written (" + why + "); " + advice;
  };
  std::error_code ignored;
  switch (error) {
    case ENAMETOOLONG:
      return "cannot be written: its name has " +
             std::to_string(fs::path(path).filename().string().size()) + " bytes (at most " +
             std::to_string(NAME_MAX) + " are allowed, and " + std::to_string(PATH_MAX) +
             " of the whole path); give a shorter one";
    case ENOENT:
    case ENOTDIR:
      if (fs::exists(folder, ignored) && !fs::is_directory(folder, ignored))
        return "cannot be written: " + folder.string() + " is a file, not a folder";
      if (!fs::exists(folder, ignored))
        return "cannot be written: the folder " + folder.string() +
               " does not exist; make it or choose another";
      return cannot("choose another folder");
    case EACCES:
    case EPERM:
    case EROFS:
      return cannot("choose a folder that is writable");
    case ENOSPC:
    case EDQUOT:
      return cannot("free some space");
    default:
      return cannot("choose another place");
  }
}

bool lockTemporary(int descriptor) noexcept { return flock(descriptor, LOCK_EX | LOCK_NB) == 0; }

void clearLeftBehind(const std::string& folder, const std::string& prefix) {
  std::vector<fs::path> left;
  std::error_code error;
  for (fs::directory_iterator at(folder.empty() ? "." : folder, error), end; !error && at != end;
       at.increment(error))
    if (at->path().filename().string().rfind(prefix, 0) == 0) left.push_back(at->path());
  for (const fs::path& path : left) clear(path, folder.empty() ? fs::path(".") : fs::path(folder));
}

}  // namespace innermap
