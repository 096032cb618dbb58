#include "core/unfinished.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstring>

namespace innermap {
namespace {

// In fixed storage: removeUnfinished may run in a signal handler, where no lock may be taken
// and nothing allocated.
constexpr int kSlots = 1024;
constexpr std::size_t kLongestPath = 4096;
struct Slot {
  std::atomic<bool> used{false};
  std::atomic<bool> ready{false};
  std::atomic<UnfinishedKind> kind{UnfinishedKind::file};
  char path[kLongestPath];
};
Slot slots[kSlots];
std::atomic<int> commits{0};
std::atomic<std::uint64_t> inPlace{0};
std::atomic<bool> ending{false};

void sleepMilliseconds(long milliseconds) noexcept {
  const timespec time{milliseconds / 1000, milliseconds % 1000 * 1000000};
  nanosleep(&time, nullptr);
}

// What is in the open folder, which it closes; opendir() would allocate.
void removeContents(int folder, int depth) noexcept {
  alignas(dirent64) char buffer[4096];
  for (bool removed = true; removed;) {
    removed = false;
    lseek(folder, 0, SEEK_SET);
    for (long size; (size = syscall(SYS_getdents64, folder, buffer, sizeof buffer)) > 0;)
      for (long at = 0; at < size;) {
        const auto* entry = reinterpret_cast<const dirent64*>(buffer + at);
        at += entry->d_reclen;
        const char* name = entry->d_name;
        if (std::strcmp(name, ".") == 0 || std::strcmp(name, "..") == 0) continue;
        if (unlinkat(folder, name, 0) == 0) {
          removed = true;
          continue;
        }
        const int inner =
            depth > 0 ? openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC) : -1;
        if (inner >= 0) removeContents(inner, depth - 1);
        removed |= unlinkat(folder, name, AT_REMOVEDIR) == 0;
      }
  }
  close(folder);
}

void removeTreeAt(const char* path) noexcept {
  const int folder = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder >= 0) removeContents(folder, 2);
  rmdir(path);
}

}  // namespace

void rememberUnfinished(UnfinishedKind kind, const std::string& path) {
  // Nothing new may be made any more.
  while (ending) sleepMilliseconds(1000);
  if (path.size() >= kLongestPath) return;
  for (Slot& slot : slots) {
    bool expected = false;
    if (!slot.used.compare_exchange_strong(expected, true)) continue;
    slot.kind = kind;
    std::memcpy(slot.path, path.c_str(), path.size() + 1);
    slot.ready = true;
    return;
  }
}

void forgetUnfinished(const std::string& path) noexcept {
  for (Slot& slot : slots) {
    if (!slot.ready || path != slot.path) continue;
    slot.ready = false;
    slot.used = false;
    return;
  }
}

void removeTree(const std::string& path) noexcept { removeTreeAt(path.c_str()); }

CommitGuard::CommitGuard() noexcept { ++commits; }
CommitGuard::~CommitGuard() { --commits; }

namespace {
thread_local int keptWork = 0;
}  // namespace

KeptWork::KeptWork() noexcept { ++keptWork; }
KeptWork::~KeptWork() { --keptWork; }

void countInPlace() noexcept {
  if (keptWork == 0) ++inPlace;
}
bool isCommitting() noexcept { return commits > 0; }
std::uint64_t countOfInPlace() noexcept { return inPlace; }

void removeUnfinished() noexcept {
  ending = true;
  // Twice: another thread may have been about to make a file that it had remembered.
  for (int pass = 0; pass < 2; ++pass) {
    if (pass > 0) sleepMilliseconds(2);
    for (Slot& slot : slots) {
      if (!slot.ready) continue;
      if (slot.kind == UnfinishedKind::file) unlink(slot.path);
      if (slot.kind == UnfinishedKind::tree) removeTreeAt(slot.path);
    }
    // Folders lie in one another, in no order.
    for (bool removed = true; removed;) {
      removed = false;
      for (Slot& slot : slots)
        if (slot.ready && slot.kind == UnfinishedKind::folder) removed |= rmdir(slot.path) == 0;
    }
  }
  ending = false;
}

}  // namespace innermap
