# cmake -DOUTPUT=assets.cc "-DFILES=a.js;b.css" -P EmbedAssets.cmake
# Writes innermap::pageAsset(), which has the files' bytes by their names.
set(arrays "")
set(table "")
set(number 0)
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  file(READ ${file} hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(APPEND arrays "const unsigned char kAsset${number}[] = {${bytes}0};\n")
  string(APPEND table "      {\"${name}\", text(kAsset${number}, sizeof kAsset${number})},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUTPUT} "// Made by cmake/EmbedAssets.cmake.
#include \"report/page/assets.h\"

#include <map>

namespace innermap {
namespace {

${arrays}
// Less the 0 at the end.
std::string_view text(const unsigned char* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size - 1};
}

}  // namespace

std::string_view pageAsset(const std::string& name) {
  static const std::map<std::string, std::string_view> assets{
${table}  };
  const auto found = assets.find(name);
  return found == assets.end() ? std::string_view() : found->second;
}

}  // namespace innermap
")
