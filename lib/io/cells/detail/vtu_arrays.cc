#include "io/cells/detail/vtu_arrays.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string_view>

#include "core/base64.h"
#include "core/byte_order.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

constexpr char kCutShort[] = "is cut short or says more than is there; export the file again";

[[noreturn]] void fail(const FileBytes& file, const VtuArray& array, const std::string& what) {
  throw FileError(file.path, array.label() + " " + what);
}

// Bytes from raw or base64 text. Parts that were encoded one by one (VTK pads a compressed array's
// header) follow one another without a seam.
class ByteSource {
 public:
  ByteSource(std::string_view text, bool base64) : text_(text), base64_(base64) {}

  // At most as many bytes are there.
  std::uint64_t most() const {
    const std::uint64_t left = text_.size() - position_;
    return base64_ ? held_ + left / 4 * 3 + 3 : left;
  }

  // False when there are not so many.
  bool read(char* out, std::size_t size) {
    if (!base64_) {
      if (size > text_.size() - position_) return false;
      std::memcpy(out, text_.data() + position_, size);
      position_ += size;
      return true;
    }
    while (size > 0) {
      if (held_ == 0 && !refill()) return false;
      const std::size_t take = std::min<std::size_t>(size, held_);
      std::memcpy(out, three_ + taken_, take);
      taken_ += static_cast<int>(take);
      held_ -= static_cast<int>(take);
      out += take;
      size -= take;
    }
    return true;
  }

 private:
  bool refill() {
    int digits[4] = {}, count = 0, padding = 0;
    for (; count < 4 && position_ < text_.size(); ++position_) {
      const char c = text_[position_];
      if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
      const int digit = c == '=' ? 0 : base64Digit(c);
      if (digit < 0 || (padding > 0 && c != '=')) return false;
      padding += c == '=';
      digits[count++] = digit;
    }
    if (count < 4 || padding > 2) return false;
    const int bits = digits[0] << 18 | digits[1] << 12 | digits[2] << 6 | digits[3];
    for (int k = 0; k < 3; ++k) three_[k] = static_cast<char>(bits >> (16 - 8 * k));
    held_ = 3 - padding;
    taken_ = 0;
    return true;
  }

  std::string_view text_;
  bool base64_;
  std::size_t position_ = 0;
  char three_[3] = {};
  int held_ = 0, taken_ = 0;
};

// The bytes of a binary array.
class BinaryArray {
 public:
  BinaryArray(const FileBytes& file, const VtuEncoding& encoding, const VtuArray& array,
              CellCollector& collector)
      : file_(file), encoding_(encoding), array_(array), collector_(collector), source_(open()) {}

  std::string read() {
    const std::uint64_t first = header();
    if (!encoding_.compressed) {
      if (first > source_.most()) fail(file_, array_, kCutShort);
      std::string bytes(first, '\0');
      if (!source_.read(bytes.data(), bytes.size())) fail(file_, array_, kCutShort);
      return bytes;
    }
    return first == 0 ? std::string() : inflateBlocks(first);
  }

 private:
  ByteSource open() const {
    const std::string_view all(file_.bytes);
    if (array_.format == "binary")
      return ByteSource(all.substr(array_.begin, array_.end - array_.begin), true);
    if (encoding_.appended == 0) fail(file_, array_, "is in appended data, the file has none");
    if (array_.offset >= encoding_.appendedEnd - encoding_.appended) fail(file_, array_, kCutShort);
    const std::size_t begin = encoding_.appended + array_.offset;
    return ByteSource(all.substr(begin, encoding_.appendedEnd - begin), !encoding_.appendedRaw);
  }

  std::uint64_t header() {
    char bytes[8];
    const std::size_t size = encoding_.longHeader ? 8 : 4;
    if (!source_.read(bytes, size)) fail(file_, array_, kCutShort);
    if (encoding_.longHeader) return numberAt<std::uint64_t>(bytes, encoding_.bigEndian);
    return numberAt<std::uint32_t>(bytes, encoding_.bigEndian);
  }

  std::string inflateBlocks(std::uint64_t blocks) {
    const std::uint64_t blockSize = header(), lastSize = header();
    if (blocks > source_.most() / (encoding_.longHeader ? 8 : 4)) fail(file_, array_, kCutShort);
    std::vector<std::uint64_t> sizes(blocks);
    for (std::uint64_t& size : sizes) size = header();
    // Deflate makes at most 1032 bytes of one.
    const std::uint64_t most = 1032 * source_.most();
    const std::uint64_t full = lastSize == 0 ? blocks : blocks - 1;
    if (lastSize > blockSize || lastSize > most || (full > 0 && blockSize > most / full))
      fail(file_, array_, kCutShort);
    const std::uint64_t total = full * blockSize + lastSize;
    collector_.claim(total);
    std::string out(total, '\0');
    std::string packed;
    for (std::uint64_t b = 0, at = 0; b < blocks; ++b) {
      collector_.poll(0);
      if (sizes[b] > source_.most()) fail(file_, array_, kCutShort);
      packed.resize(sizes[b]);
      if (!source_.read(packed.data(), packed.size())) fail(file_, array_, kCutShort);
      const std::uint64_t want = b < full ? blockSize : lastSize;
      uLongf got = want;
      const int status = uncompress(reinterpret_cast<Bytef*>(&out[at]), &got,
                                    reinterpret_cast<const Bytef*>(packed.data()), packed.size());
      if (status != Z_OK || got != want) fail(file_, array_, "holds damaged zlib data");
      at += want;
    }
    return out;
  }

  const FileBytes& file_;
  const VtuEncoding& encoding_;
  const VtuArray& array_;
  CellCollector& collector_;
  ByteSource source_;
};

template <class From, class To>
std::vector<To> converted(const std::string& bytes, bool bigEndian) {
  std::vector<To> out(bytes.size() / sizeof(From));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const From value = numberAt<From>(bytes.data() + i * sizeof(From), bigEndian);
    if constexpr (std::is_floating_point_v<From> && !std::is_floating_point_v<To>)
      out[i] = value >= -9e18 && value <= 9e18 ? static_cast<To>(value) : -1;
    else
      out[i] = static_cast<To>(value);
  }
  return out;
}

template <class To>
using Convert = std::vector<To> (*)(const std::string&, bool);

template <class To>
struct Type {
  const char* name;
  std::size_t size;
  Convert<To> convert;
};

template <class To>
constexpr Type<To> kTypes[] = {
    {"Int8", 1, converted<std::int8_t, To>},   {"UInt8", 1, converted<std::uint8_t, To>},
    {"Int16", 2, converted<std::int16_t, To>}, {"UInt16", 2, converted<std::uint16_t, To>},
    {"Int32", 4, converted<std::int32_t, To>}, {"UInt32", 4, converted<std::uint32_t, To>},
    {"Int64", 8, converted<std::int64_t, To>}, {"UInt64", 8, converted<std::uint64_t, To>},
    {"Float32", 4, converted<float, To>},      {"Float64", 8, converted<double, To>}};

template <class To>
const Type<To>* findType(const std::string& name) {
  for (const Type<To>& type : kTypes<To>)
    if (name == type.name) return &type;
  return nullptr;
}

template <class To>
std::vector<To> readAscii(const FileBytes& file, const VtuArray& array, CellCollector& collector) {
  std::vector<To> out;
  const char* at = file.bytes.data() + array.begin;
  const char* const end = file.bytes.data() + array.end;
  for (;;) {
    while (at < end && (*at == ' ' || *at == '\n' || *at == '\r' || *at == '\t')) ++at;
    if (at == end) return out;
    collector.poll(out.size());
    if (*at == '+') ++at;
    To value{};
    const auto [stop, error] = std::from_chars(at, end, value);
    const bool small = error == std::errc::result_out_of_range && std::is_floating_point_v<To>;
    if ((error != std::errc() && !small) ||
        (stop < end && *stop != ' ' && *stop != '\n' && *stop != '\r' && *stop != '\t'))
      failAt(file, static_cast<std::size_t>(at - file.bytes.data()),
             array.label() + " has something that is no number: " +
                 inQuotes(std::string_view(
                     at, static_cast<std::size_t>(std::min<std::ptrdiff_t>(20, end - at)))));
    out.push_back(value);
    at = stop;
  }
}

template <class To>
std::vector<To> readNumbers(const FileBytes& file, const VtuEncoding& encoding,
                            const VtuArray& array, CellCollector& collector) {
  const Type<To>* type = findType<To>(array.type);
  if (!type) fail(file, array, "is of the unknown type " + inQuotes(array.type));
  if (array.format == "ascii") return readAscii<To>(file, array, collector);
  if (array.format != "binary" && array.format != "appended")
    fail(file, array, "has the unknown format " + inQuotes(array.format));
  const std::string bytes = BinaryArray(file, encoding, array, collector).read();
  if (bytes.size() % type->size != 0) fail(file, array, kCutShort);
  return type->convert(bytes, encoding.bigEndian);
}

template <class To>
std::vector<To> readCounted(const FileBytes& file, const VtuEncoding& encoding,
                            const VtuArray& array, std::uint64_t count, CellCollector& collector) {
  std::vector<To> numbers = readNumbers<To>(file, encoding, array, collector);
  if (numbers.size() != count)
    fail(file, array,
         fmt::format("has {} numbers, the file's counts ask for {}; export the file again",
                     numbers.size(), count));
  return numbers;
}

}  // namespace

bool isWholeType(const VtuArray& array) { return array.type.compare(0, 5, "Float") != 0; }

bool isNumberType(const VtuArray& array) { return findType<double>(array.type) != nullptr; }

std::vector<double> vtuReals(const FileBytes& file, const VtuEncoding& encoding,
                             const VtuArray& array, std::uint64_t count, CellCollector& collector) {
  return readCounted<double>(file, encoding, array, count, collector);
}

std::vector<std::int64_t> vtuIntegers(const FileBytes& file, const VtuEncoding& encoding,
                                      const VtuArray& array, std::uint64_t count,
                                      CellCollector& collector) {
  return readCounted<std::int64_t>(file, encoding, array, count, collector);
}

std::vector<std::int64_t> vtuIntegers(const FileBytes& file, const VtuEncoding& encoding,
                                      const VtuArray& array, CellCollector& collector) {
  return readNumbers<std::int64_t>(file, encoding, array, collector);
}

}  // namespace innermap
