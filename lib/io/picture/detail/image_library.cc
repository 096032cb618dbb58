#include "io/picture/detail/image_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "innermap/core/error.h"

namespace innermap {
namespace {

// The sanitizer would find another type: a module has descriptions of types of its own.
#ifdef __clang__
__attribute__((no_sanitize("function")))
#endif
const ImageLibrary&
load() {
  // The name holds the version, so another version's module is not found. It is looked for where
  // the binary that holds this code says (its run path), then where the system's libraries are.
  void* const module = dlopen(INNERMAP_IMAGE_MODULE, RTLD_LAZY | RTLD_LOCAL);
  const char* const why = module ? "" : dlerror();
  void* const entry = module ? dlsym(module, "innermapImageLibrary") : nullptr;
  if (!entry)
    throw Error(
        fmt::format("pictures need the module {}, which cannot be loaded ({}); install innermap "
                    "anew, or name its folder in LD_LIBRARY_PATH",
                    INNERMAP_IMAGE_MODULE, why ? why : "unknown reason"));
  return *reinterpret_cast<const ImageLibrary* (*)()>(entry)();
}

}  // namespace

const ImageLibrary& imageLibrary() {
  static const ImageLibrary& library = load();
  return library;
}

}  // namespace innermap
