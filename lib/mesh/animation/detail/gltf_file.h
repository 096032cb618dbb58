// glTF 2.0 files (Khronos, "glTF 2.0 Specification", 2021; ISO/IEC 12113): their JSON, and the
// numbers that it describes.
//
// The reader is our own, on the packaged JSON parser: the packaged tinygltf reads nested `extras`
// by recursion, so that a file of 120 kB overflows the stack, reads files beside it wherever their
// names point, and leaves accessors unchecked.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace innermap {

class GltfFile {
 public:
  using Json = nlohmann::json;

  // .gltf or .glb by the content. Reads the buffers too, from the file, `data:` texts, or files of
  // its folder. Throws FileError for what is no such file, other versions, compressed meshes, and
  // buffers that are not there, elsewhere, or too short; MemoryError; Cancelled.
  explicit GltfFile(const std::string& path);

  const std::string& path() const { return path_; }
  // That were read beside it.
  const std::vector<std::string>& filesBeside() const { return filesBeside_; }
  const Json& root() const { return json_; }

  [[noreturn]] void fail(const std::string& what) const;  // FileError

  // The elements of an array of objects of the root or an object; none where it is missing.
  const Json& list(const Json& of, const char* key) const;
  // An index below `count`, or `missing` where there is none. Throws FileError.
  int index(const Json& of, const char* key, std::size_t count, int missing = -1) const;
  int index(const Json& value, std::size_t count, const std::string& what) const;
  std::string text(const Json& of, const char* key) const;  // "" where there is none
  // So many finite numbers; empty where there are none. count 0: any number of them.
  std::vector<double> numbers(const Json& of, const char* key, std::size_t count) const;

  struct Numbers {
    std::vector<double> values;  // #count x #width
    std::size_t count = 0, width = 0;
    const double* at(std::size_t i) const { return values.data() + i * width; }
  };
  // What an accessor describes, sparse ones too, integers that are marked so as shares of 1. count:
  // how many are wanted; 0: as many as there are. All are finite.
  Numbers read(int accessor, const char* type, std::size_t count = 0) const;

 private:
  void readContainer(std::string bytes);
  void refuseCompression() const;
  void readBuffers(std::string binary);
  std::string bufferAt(const std::string& uri);
  std::uint64_t size(const Json& of, const char* key, std::uint64_t missing) const;
  // The bytes of a view from `offset` on.
  std::string_view view(int index, std::uint64_t offset, std::uint64_t* stride) const;
  void readSparse(const Json& sparse, int component, Numbers& out) const;

  std::string path_;
  Json json_;
  std::vector<std::string> buffers_, filesBeside_;
};

}  // namespace innermap
