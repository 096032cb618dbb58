// Loaded before a program's own libraries (LD_PRELOAD), makes calls of it fail:
//   INNERMAP_FAULT=new:N[:on]       the N-th operator new since main, or all from it on
//   INNERMAP_FAULT=malloc:N[:on]    the N-th allocation by C functions that operator new did not
//   call INNERMAP_FAULT=memory:N[:on]    of both INNERMAP_FAULT=write:N[:on[:E]] the N-th call that
//   changes files, with the error number E; from
//                                   it on, files cannot be made or written, but still renamed
// INNERMAP_FAULT_LOG=FILE gets what failed, and how many calls of each kind there were.
// INNERMAP_FAULT_TRACE=1 says on stderr where.
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <stdarg.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

// NOLINTBEGIN(readability-identifier-naming): glibc's names
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}
// NOLINTEND(readability-identifier-naming)

namespace {

enum Kind { kNew = 0, kMalloc, kMemory, kWrite, kKinds };
constexpr const char* kNames[kKinds] = {"new", "malloc", "memory", "write"};

std::atomic<bool> armed{false};
std::atomic<long> counts[kKinds];
int wantedKind = -1, errorNumber = ENOSPC;
long wantedCall = 0;
bool fromThenOn = false, trace = false;
int logFile = -1;

// In a call that is counted already.
__attribute__((tls_model("initial-exec"))) __thread int depth = 0;
struct Inside {
  Inside() { ++depth; }
  ~Inside() { --depth; }
};

void report(const char* text) {
  if (logFile >= 0) syscall(SYS_write, logFile, text, std::strlen(text));
}

bool isDlopen(const Dl_info& info) {
  return info.dli_sname && std::strcmp(info.dli_sname, "dlopen") == 0;
}

// Opening a library is glibc's and that library's own work, and both end the program where it fails
// (glibc 2.36's second dlopen in want of memory ends in its own dlerror).
bool isInDlopen() {
  const Inside inside;
  void* frames[60];
  const int count = backtrace(frames, 60);
  Dl_info info{};
  for (int i = 0; i < count; ++i)
    if (dladdr(frames[i], &info) && isDlopen(info)) return true;
  return false;
}

// The library that asked for it: the innermost that is not this one or the C++ library.
const char* callerOf(void** frames, int count) {
  Dl_info own{}, info{};
  dladdr(reinterpret_cast<void*>(&report), &own);
  const char* found = nullptr;
  for (int i = 0; i < count; ++i) {
    if (!dladdr(frames[i], &info) || !info.dli_fname || info.dli_fbase == own.dli_fbase) continue;
    const char* slash = std::strrchr(info.dli_fname, '/');
    const char* name = slash ? slash + 1 : info.dli_fname;
    if (!found && std::strncmp(name, "libstdc++", 9) != 0) found = name;
  }
  return found ? found : "?";
}

void hit(const char* what) {
  const Inside inside;
  static std::atomic<int> lines{0};
  if (++lines > 1000) return;
  void* callers[20];
  char line[200];
  std::snprintf(line, sizeof line, "failed %s in %s\n", what,
                callerOf(callers, backtrace(callers, 20)));
  report(line);
  if (!trace || lines > 1) return;
  void* frames[60];
  backtrace_symbols_fd(frames, backtrace(frames, 60), STDERR_FILENO);
}

bool fails(Kind kind, const char* what) {
  if (!armed || depth > 0) return false;
  const long call = ++counts[kind];
  if (kind != wantedKind || call < wantedCall) return false;
  if (call > wantedCall && !fromThenOn) return false;
  if (isInDlopen()) return false;
  hit(what);
  return true;
}

bool allocationFails(Kind kind, const char* what) {
  const bool own = fails(kind, what), any = fails(kMemory, what);
  return own || any;
}

// once: not of those that fail from a call on.
bool writeFails(const char* what, bool once = false) {
  if (!armed || depth > 0) return false;
  const bool failed = fails(kWrite, what);
  if (!failed || (once && counts[kWrite] > wantedCall && fromThenOn)) return false;
  errno = errorNumber;
  return true;
}

bool isFile(int descriptor) {
  struct stat status {};
  return descriptor > STDERR_FILENO && descriptor != logFile && fstat(descriptor, &status) == 0 &&
         S_ISREG(status.st_mode);
}

template <class Function>
Function* next(const char* name, Function*) {
  const Inside inside;
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}
#define NEXT(name) static decltype(&::name) const real = next(#name, &::name)

void setUp() {
  const Inside inside;
  if (const char* path = std::getenv("INNERMAP_FAULT_LOG"))
    logFile = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  trace = std::getenv("INNERMAP_FAULT_TRACE") != nullptr;
  void* frame[1];
  backtrace(frame, 1);  // loads what it needs
  const char* text = std::getenv("INNERMAP_FAULT");
  if (!text) return;
  for (int kind = 0; kind < kKinds; ++kind) {
    const std::size_t size = std::strlen(kNames[kind]);
    if (std::strncmp(text, kNames[kind], size) != 0 || text[size] != ':') continue;
    char* rest = nullptr;
    wantedKind = kind;
    wantedCall = std::strtol(text + size + 1, &rest, 10);
    fromThenOn = std::strncmp(rest, ":on", 3) == 0;
    if (const char* number = std::strrchr(rest, ':');
        number && number[1] >= '0' && number[1] <= '9')
      errorNumber = std::atoi(number + 1);
  }
}

int (*realMain)(int, char**, char**) = nullptr;

int countedMain(int argc, char** argv, char** variables) {
  setUp();
  armed = true;
  const int code = realMain(argc, argv, variables);
  armed = false;
  char line[200];
  std::snprintf(line, sizeof line, "calls %ld %ld %ld %ld\n", counts[kNew].load(),
                counts[kMalloc].load(), counts[kMemory].load(), counts[kWrite].load());
  report(line);
  return code;
}

void* allocateNew(std::size_t size, std::size_t alignment) {
  if (allocationFails(kNew, "operator new")) return nullptr;
  return alignment ? __libc_memalign(alignment, size ? size : 1) : __libc_malloc(size ? size : 1);
}
void* throwingNew(std::size_t size, std::size_t alignment = 0) {
  void* const made = allocateNew(size, alignment);
  if (!made) throw std::bad_alloc();
  return made;
}

}  // namespace

void* operator new(std::size_t n) { return throwingNew(n); }
void* operator new[](std::size_t n) { return throwingNew(n); }
void* operator new(std::size_t n, std::align_val_t a) { return throwingNew(n, std::size_t(a)); }
void* operator new[](std::size_t n, std::align_val_t a) { return throwingNew(n, std::size_t(a)); }
void* operator new(std::size_t n, const std::nothrow_t&) noexcept { return allocateNew(n, 0); }
void* operator new[](std::size_t n, const std::nothrow_t&) noexcept { return allocateNew(n, 0); }

extern "C" {

// NOLINTNEXTLINE(readability-identifier-naming)
int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(),
                      void (*fini)(), void (*rtldFini)(), void* stackEnd) {
  using Start =
      int(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*);
  realMain = main;
  return reinterpret_cast<Start*>(dlsym(RTLD_NEXT, "__libc_start_main"))(
      countedMain, argc, argv, init, fini, rtldFini, stackEnd);
}

void* malloc(std::size_t size) {
  if (!allocationFails(kMalloc, "malloc")) return __libc_malloc(size);
  errno = ENOMEM;
  return nullptr;
}
void* calloc(std::size_t count, std::size_t size) {
  if (!allocationFails(kMalloc, "calloc")) return __libc_calloc(count, size);
  errno = ENOMEM;
  return nullptr;
}
void* realloc(void* old, std::size_t size) {
  if (!allocationFails(kMalloc, "realloc")) return __libc_realloc(old, size);
  errno = ENOMEM;
  return nullptr;
}
void* memalign(std::size_t alignment, std::size_t size) {
  if (!allocationFails(kMalloc, "memalign")) return __libc_memalign(alignment, size);
  errno = ENOMEM;
  return nullptr;
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** made, std::size_t alignment, std::size_t size) {
  if (allocationFails(kMalloc, "posix_memalign")) return ENOMEM;
  *made = __libc_memalign(alignment, size);
  return *made ? 0 : ENOMEM;
}

ssize_t write(int file, const void* bytes, std::size_t size) {
  if (isFile(file) && writeFails("write")) return -1;
  return syscall(SYS_write, file, bytes, size);
}
ssize_t writev(int file, const iovec* parts, int count) {
  if (isFile(file) && writeFails("writev")) return -1;
  return syscall(SYS_writev, file, parts, count);
}
ssize_t pwrite64(int file, const void* bytes, std::size_t size, off_t at) {
  if (isFile(file) && writeFails("pwrite")) return -1;
  return syscall(SYS_pwrite64, file, bytes, size, at);
}
ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t at) {
  return pwrite64(file, bytes, size, at);
}
int ftruncate64(int file, off_t size) {
  if (isFile(file) && writeFails("ftruncate")) return -1;
  return static_cast<int>(syscall(SYS_ftruncate, file, size));
}
int ftruncate(int file, off_t size) { return ftruncate64(file, size); }
int fsync(int file) {
  if (isFile(file) && writeFails("fsync")) return -1;
  return static_cast<int>(syscall(SYS_fsync, file));
}
int fdatasync(int file) {
  if (isFile(file) && writeFails("fdatasync")) return -1;
  return static_cast<int>(syscall(SYS_fdatasync, file));
}
int mkdir(const char* path, mode_t mode) noexcept {
  if (writeFails("mkdir")) return -1;
  return static_cast<int>(syscall(SYS_mkdir, path, mode));
}
int rename(const char* from, const char* to) noexcept {
  if (writeFails("rename", true)) return -1;
  return static_cast<int>(syscall(SYS_rename, from, to));
}
int link(const char* from, const char* to) noexcept {
  if (writeFails("link", true)) return -1;
  return static_cast<int>(syscall(SYS_link, from, to));
}
int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = va_arg(more, mode_t);
  va_end(more);
  const bool writes = (flags & O_ACCMODE) != O_RDONLY && std::strncmp(path, "/dev/", 5) != 0;
  if (writes && writeFails("open")) return -1;
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}
int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = va_arg(more, mode_t);
  va_end(more);
  return open64(path, flags, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  NEXT(fopen64);
  if (std::strpbrk(mode, "wa+") && writeFails("fopen")) return nullptr;
  return real(path, mode);
}
FILE* fopen(const char* path, const char* mode) { return fopen64(path, mode); }
std::size_t fwrite(const void* bytes, std::size_t size, std::size_t count, FILE* file) {
  NEXT(fwrite);
  if (isFile(fileno(file)) && writeFails("fwrite")) return 0;
  return real(bytes, size, count, file);
}
int fclose(FILE* file) {
  NEXT(fclose);
  const bool failed = file && isFile(fileno(file)) &&
                      (fcntl(fileno(file), F_GETFL) & O_ACCMODE) != O_RDONLY &&
                      writeFails("fclose");
  const int result = real(file);
  if (!failed) return result;
  errno = errorNumber;
  return EOF;
}

}  // extern "C"
