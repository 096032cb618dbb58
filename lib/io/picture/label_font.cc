#include <filesystem>
#include <system_error>

#include "innermap/io/pictures.h"
#include "io/picture/detail/image_library.h"

namespace innermap {

// OpenImageIO searches the whole system for a font when the usual place has none; that takes half
// a second, so only the usual places are asked.
const std::string& labelFont() {
  static const std::string path = [] {
    for (const char* candidate :
         {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf",
          "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
          "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"}) {
      std::error_code ignored;
      if (std::filesystem::is_regular_file(candidate, ignored) &&
          imageLibrary().textWidth("0", 16, candidate) >= 0)
        return std::string(candidate);
    }
    return std::string();
  }();
  return path;
}

}  // namespace innermap
