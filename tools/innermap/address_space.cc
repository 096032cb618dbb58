// Starting under a limit on address space (ulimit -v).
//
// OpenBLAS maps 128 MB for each of its threads when it is loaded, and where a limit forbids that it
// waits for ever. It is called by one thread at a time of ours or by many that use one each, so
// under a limit the program starts anew with no more than that. The C library would reserve another
// 64 MB for what each thread allocates: there all share what one has. Both must be settled before
// the libraries set themselves up, hence before main. They start threads of their own there and end
// the program where there is no room for them, so a limit too tight for that is refused here.
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <string_view>

namespace {

bool has(char** variables, std::string_view name) {
  for (; *variables; ++variables) {
    const std::string_view variable = *variables;
    if (variable.size() > name.size() && variable.substr(0, name.size()) == name &&
        variable[name.size()] == '=')
      return true;
  }
  return false;
}

bool hasRoomToStart() {
  constexpr std::size_t kNeeded = 224u << 20;  // the buffer of OpenBLAS, and stacks
  void* const room = mmap(nullptr, kNeeded, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return room != MAP_FAILED && munmap(room, kNeeded) == 0;
}

// Uses nothing that a library's own start prepares: not even the environment is there by name yet.
void startFrugally(int, char** argv, char** variables) {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  static char blas[] = "OPENBLAS_NUM_THREADS=1", arenas[] = "MALLOC_ARENA_MAX=1";
  static std::array<char*, 4096> all{};
  std::size_t count = 0;
  for (char** variable = variables; *variable; ++variable) {
    if (count + 3 >= all.size()) return;
    all[count++] = *variable;
  }
  const std::size_t before = count;
  if (!has(variables, "OPENBLAS_NUM_THREADS")) all[count++] = blas;
  if (!has(variables, "MALLOC_ARENA_MAX")) all[count++] = arenas;
  if (count > before) execve("/proc/self/exe", argv, all.data());
  if (hasRoomToStart()) return;
  constexpr std::string_view kRefusal =
      "innermap: the limit on address space is too low to start; raise it (ulimit -v)\n";
  const auto written = write(STDERR_FILENO, kRefusal.data(), kRefusal.size());
  _exit(written < 0 ? 2 : 1);
}

[[gnu::section(".preinit_array"), gnu::used]] void (*const kStart)(int, char**,
                                                                   char**) = startFrugally;

}  // namespace
