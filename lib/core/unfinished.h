// The files and folders that must go when the process ends at once.
#pragma once

#include <cstdint>
#include <string>

namespace innermap {

// A folder goes when it is empty, a tree with all that is in it.
enum class UnfinishedKind { file, folder, tree };

// Remembers `path` for removeUnfinished(). To be called before it is made; forgetUnfinished()
// when it is finished or removed.
void rememberUnfinished(UnfinishedKind kind, const std::string& path);
void forgetUnfinished(const std::string& path) noexcept;

// While it lives files are put in place: isCommitting() is true.
class CommitGuard {
 public:
  CommitGuard() noexcept;
  ~CommitGuard();
  CommitGuard(const CommitGuard&) = delete;
  CommitGuard& operator=(const CommitGuard&) = delete;
};

// Removes a folder of ours and what is in it; allocates nothing.
void removeTree(const std::string& path) noexcept;

void countInPlace() noexcept;

// While it lives, what this thread puts in place is no output but work kept for the next run.
class KeptWork {
 public:
  KeptWork() noexcept;
  ~KeptWork();
  KeptWork(const KeptWork&) = delete;
  KeptWork& operator=(const KeptWork&) = delete;
};

// What file.h calls removeUnfinishedFiles(), commitUnderWay(), outputsInPlace().
void removeUnfinished() noexcept;
bool isCommitting() noexcept;
std::uint64_t countOfInPlace() noexcept;

}  // namespace innermap
