#include "mesh/animation/detail/gltf_file.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "core/base64.h"
#include "core/byte_order.h"
#include "core/file_bytes.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

using Json = GltfFile::Json;

const Json* member(const Json& of, const char* key) {
  if (!of.is_object()) return nullptr;
  const auto found = of.find(key);
  return found == of.end() ? nullptr : &*found;
}

std::uint32_t wordAt(const std::string& bytes, std::size_t at) {
  return numberAt<std::uint32_t>(bytes.data() + at);
}

// "%20" is a blank.
std::string decodedUri(const std::string& uri) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i)
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      out += static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2]));
      i += 2;
    } else {
      out += uri[i];
    }
  return out;
}

std::string decodedBase64(std::string_view text) {
  std::string out;
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int held = 0;
  for (const char letter : text) {
    const int digit = base64Digit(letter);
    if (digit < 0) continue;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    out += static_cast<char>(bits >> held & 0xff);
  }
  return out;
}

// Names of numbers in the format.
struct Component {
  int number;
  std::size_t bytes;
  double most;  // what stands for 1 in integers that are shares
};
constexpr Component kComponents[] = {{5120, 1, 127},   {5121, 1, 255},        {5122, 2, 32767},
                                     {5123, 2, 65535}, {5125, 4, 4294967295}, {5126, 4, 1}};

template <class Number>
double as(const char* bytes) {
  return static_cast<double>(numberAt<Number>(bytes));
}

double numberOf(int component, const char* bytes) {
  switch (component) {
    case 5120:
      return as<std::int8_t>(bytes);
    case 5121:
      return as<std::uint8_t>(bytes);
    case 5122:
      return as<std::int16_t>(bytes);
    case 5123:
      return as<std::uint16_t>(bytes);
    case 5125:
      return as<std::uint32_t>(bytes);
    default:
      return as<float>(bytes);
  }
}

std::size_t widthOf(const std::string& type) {
  constexpr std::pair<const char*, std::size_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  for (const auto& [name, width] : kTypes)
    if (type == name) return width;
  return 0;
}

}  // namespace

GltfFile::GltfFile(const std::string& path) : path_(path) {
  readContainer(readFileBytes(path, "a glTF file").bytes);
}

void GltfFile::fail(const std::string& what) const { throw FileError(path_, what); }

void GltfFile::readContainer(std::string bytes) {
  constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
  std::string json, binary;
  if (bytes.compare(0, 4, "glTF") == 0) {
    if (bytes.size() < 20) fail("is cut short; export it again");
    if (wordAt(bytes, 4) != 2) fail(fmt::format("is glTF {}; version 2 is read", wordAt(bytes, 4)));
    for (std::size_t at = 12; at + 8 <= bytes.size();) {
      const std::size_t size = wordAt(bytes, at), kind = wordAt(bytes, at + 4);
      if (size > bytes.size() - at - 8) fail("is cut short; export it again");
      if (kind == kJson && json.empty()) json = bytes.substr(at + 8, size);
      if (kind == kBinary && binary.empty()) binary = bytes.substr(at + 8, size);
      at += 8 + size;
    }
  } else {
    json = std::move(bytes);
  }
  requireMemory("reading " + path_, 4 * json.size(), availableMemory(), "export it as .glb");
  json_ = Json::parse(json, nullptr, false);
  if (!json_.is_object()) fail("is no glTF file, or a damaged one; export it again");
  const std::string version = text(json_.value("asset", Json::object()), "version");
  if (version.compare(0, 2, "2.") != 0)
    fail("is glTF of version " + inQuotes(version) + "; version 2 is read");
  refuseCompression();
  readBuffers(std::move(binary));
}

void GltfFile::refuseCompression() const {
  for (const Json& name : list(json_, "extensionsRequired"))
    for (const char* known : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"})
      if (name == known)
        fail(std::string("has its meshes compressed (") + known +
             "); export it without compression, as 'gltf-transform copy' and Blender with "
             "Compression off do");
}

const Json& GltfFile::list(const Json& of, const char* key) const {
  static const Json none = Json::array();
  const Json* found = member(of, key);
  if (!found) return none;
  if (!found->is_array()) fail(std::string(key) + " is no list");
  return *found;
}

int GltfFile::index(const Json& value, std::size_t count, const std::string& what) const {
  if (!value.is_number_integer() || value < 0 || value >= count)
    fail(fmt::format("{} is not one of 0 to {}: damaged; export it again", what,
                     static_cast<std::int64_t>(count) - 1));
  return value.get<int>();
}

int GltfFile::index(const Json& of, const char* key, std::size_t count, int missing) const {
  const Json* found = member(of, key);
  return found ? index(*found, count, key) : missing;
}

std::string GltfFile::text(const Json& of, const char* key) const {
  const Json* found = member(of, key);
  return found && found->is_string() ? found->get<std::string>() : "";
}

std::vector<double> GltfFile::numbers(const Json& of, const char* key, std::size_t count) const {
  const Json& all = list(of, key);
  if (all.empty()) return {};
  if (count > 0 && all.size() != count)
    fail(fmt::format("{} has {} numbers, not {}", key, all.size(), count));
  std::vector<double> out;
  for (const Json& value : all) {
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      fail(std::string(key) + " is not all numbers");
    out.push_back(value.get<double>());
  }
  return out;
}

std::uint64_t GltfFile::size(const Json& of, const char* key, std::uint64_t missing) const {
  const Json* found = member(of, key);
  if (!found) return missing;
  if (!found->is_number_integer() || *found < 0 || *found > (std::int64_t(1) << 40))
    fail(std::string(key) + " is out of range: damaged; export it again");
  return found->get<std::uint64_t>();
}

std::string GltfFile::bufferAt(const std::string& uri) {
  if (uri.compare(0, 5, "data:") == 0) {
    const std::size_t comma = uri.find(";base64,");
    if (comma == uri.npos) fail("has a buffer in another text than base64");
    return decodedBase64(std::string_view(uri).substr(comma + 8));
  }
  const std::string name = decodedUri(uri);
  const std::filesystem::path file(name);
  bool leaves = file.is_absolute() || name.find(':') != name.npos || name.find('\0') != name.npos;
  for (const auto& part : file) leaves = leaves || part == "..";
  if (leaves)
    fail("has a buffer outside its folder, " + inQuotes(uri) +
         ", which is not read; export it as .glb");
  filesBeside_.push_back((std::filesystem::path(path_).parent_path() / file).string());
  return readFileBytes(filesBeside_.back(), "a buffer of " + path_).bytes;
}

void GltfFile::readBuffers(std::string binary) {
  for (const Json& buffer : list(json_, "buffers")) {
    throwIfCancelled();
    const std::string uri = text(buffer, "uri");
    if (uri.empty() && !buffers_.empty()) fail("has a buffer without a file");
    buffers_.push_back(uri.empty() ? std::exchange(binary, {}) : bufferAt(uri));
    const std::uint64_t length = size(buffer, "byteLength", 0);
    if (buffers_.back().size() < length)
      fail(fmt::format("has a buffer of {} bytes, of which {} are there; export it again", length,
                       buffers_.back().size()));
    buffers_.back().resize(length);
  }
}

std::string_view GltfFile::view(int index, std::uint64_t offset, std::uint64_t* stride) const {
  const Json& view = list(json_, "bufferViews").at(static_cast<std::size_t>(index));
  const int which = this->index(view, "buffer", buffers_.size());
  if (which < 0) fail("has a view of no buffer");
  const std::string_view buffer = buffers_[static_cast<std::size_t>(which)];
  const std::uint64_t begin = size(view, "byteOffset", 0), length = size(view, "byteLength", 0);
  if (begin > buffer.size() || length > buffer.size() - begin || offset > length)
    fail("has a view beyond its buffer: damaged; export it again");
  if (stride) *stride = size(view, "byteStride", 0);
  return buffer.substr(begin + offset, length - offset);
}

GltfFile::Numbers GltfFile::read(int number, const char* type, std::size_t wanted) const {
  throwIfCancelled();
  const Json& accessor = list(json_, "accessors").at(static_cast<std::size_t>(number));
  const int component = static_cast<int>(size(accessor, "componentType", 0));
  Numbers out;
  out.count = size(accessor, "count", 0);
  out.width = widthOf(type);
  if (text(accessor, "type") != type)
    fail(fmt::format("accessor {} is {}, not {}", number, inQuotes(text(accessor, "type")), type));
  if (out.count == 0 || (wanted > 0 && out.count != wanted))
    fail(fmt::format("accessor {} has {} elements, not {}", number, out.count,
                     wanted > 0 ? std::to_string(wanted) : "some"));
  const Component* kind = nullptr;
  for (const Component& c : kComponents)
    if (c.number == component) kind = &c;
  if (!kind) fail(fmt::format("accessor {} has numbers of no known kind", number));
  const bool normalized = accessor.value("normalized", Json(false)) == true;
  const int viewIndex = index(accessor, "bufferView", list(json_, "bufferViews").size());
  // Without a view all are 0, and their count is no one's but the caller's.
  if (viewIndex < 0 && wanted == 0) fail(fmt::format("accessor {} has no numbers", number));
  std::uint64_t stride = 0;
  std::string_view bytes;
  if (viewIndex >= 0) {
    bytes = view(viewIndex, size(accessor, "byteOffset", 0), &stride);
    const std::uint64_t element = kind->bytes * out.width;
    if (stride == 0) stride = element;
    if (bytes.size() < element || (bytes.size() - element) / stride < out.count - 1)
      fail(fmt::format("accessor {} goes beyond its view: damaged; export it again", number));
  }
  requireMemory("reading " + path_, 8 * out.count * out.width, memoryLimit(), "use a coarser mesh");
  out.values.assign(out.count * out.width, 0.0);
  for (std::size_t i = 0; i < out.count && !bytes.empty(); ++i)
    for (std::size_t k = 0; k < out.width; ++k)
      out.values[i * out.width + k] =
          numberOf(component, bytes.data() + i * stride + k * kind->bytes);
  if (const Json* sparse = member(accessor, "sparse")) readSparse(*sparse, component, out);
  for (double& value : out.values) {
    if (!std::isfinite(value))
      fail(fmt::format("accessor {} has a number that is not finite", number));
    if (normalized && component != 5126) value = std::max(value / kind->most, -1.0);
  }
  return out;
}

void GltfFile::readSparse(const Json& sparse, int component, Numbers& out) const {
  const std::uint64_t count = size(sparse, "count", 0);
  const Json indices = sparse.value("indices", Json::object());
  const Json values = sparse.value("values", Json::object());
  const std::size_t views = list(json_, "bufferViews").size();
  const int indexView = index(indices, "bufferView", views);
  const int valueView = index(values, "bufferView", views);
  const int indexKind = static_cast<int>(size(indices, "componentType", 0));
  const auto bytesOf = [](int kind) {
    for (const Component& c : kComponents)
      if (c.number == kind) return c.bytes;
    return std::size_t(0);
  };
  const std::size_t indexBytes = bytesOf(indexKind), valueBytes = bytesOf(component) * out.width;
  if (indexView < 0 || valueView < 0 || indexBytes == 0 || indexKind == 5126)
    fail("has a sparse accessor without numbers");
  const std::string_view where = view(indexView, size(indices, "byteOffset", 0), nullptr);
  const std::string_view what = view(valueView, size(values, "byteOffset", 0), nullptr);
  if (where.size() / indexBytes < count || what.size() / valueBytes < count)
    fail("has a sparse accessor beyond its view: damaged; export it again");
  for (std::uint64_t i = 0; i < count; ++i) {
    const double at = numberOf(indexKind, where.data() + i * indexBytes);
    if (at < 0 || at >= static_cast<double>(out.count))
      fail("has a sparse accessor out of range: damaged; export it again");
    for (std::size_t k = 0; k < out.width; ++k)
      out.values[static_cast<std::size_t>(at) * out.width + k] =
          numberOf(component, what.data() + i * valueBytes + k * valueBytes / out.width);
  }
}

}  // namespace innermap
