#include "io/geometry/detail/ply_body.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/text_scanner.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

const char kTruncated[] = "the file is cut short or its header promises too much; export it again";

bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

// body(T{}) for the C++ type.
template <class Body>
auto withType(PlyType type, const Body& body) {
  switch (type) {
    case PlyType::int8:
      return body(std::int8_t{});
    case PlyType::uint8:
      return body(std::uint8_t{});
    case PlyType::int16:
      return body(std::int16_t{});
    case PlyType::uint16:
      return body(std::uint16_t{});
    case PlyType::int32:
      return body(std::int32_t{});
    case PlyType::uint32:
      return body(std::uint32_t{});
    case PlyType::float32:
      return body(float{});
    case PlyType::float64:
      break;
  }
  return body(double{});
}

void swapIf(bool swap, char* bytes, std::size_t size) {
  if (swap) std::reverse(bytes, bytes + size);
}

}  // namespace

void PlyBody::fail(const std::string& what) const {
  throw FileError(file_.path, fmt::format("byte {}: {}", position_, what));
}

std::string_view PlyBody::next(PlyType type) {
  const std::string& bytes = file_.bytes;
  if (!ascii_) {
    const std::size_t size = plySize(type);
    if (size > bytes.size() - position_) fail(kTruncated);
    position_ += size;
    return std::string_view(bytes).substr(position_ - size, size);
  }
  while (position_ < bytes.size() && isSpace(bytes[position_])) ++position_;
  const std::size_t begin = position_;
  while (position_ < bytes.size() && !isSpace(bytes[position_])) ++position_;
  if (begin == position_) fail(kTruncated);
  return std::string_view(bytes).substr(begin, position_ - begin);
}

double PlyBody::value(std::string_view bytes, PlyType type) const {
  if (ascii_) {
    const std::string_view digits = bytes[0] == '+' ? bytes.substr(1) : bytes;
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
      fail(inQuotes(bytes) + " is not a number");
    if (!isFloat(type) && value != std::floor(value))
      fail(inQuotes(bytes) + " is not a whole number");
    return value;
  }
  return withType(type, [&](auto kind) {
    using T = decltype(kind);
    char ordered[sizeof(T)];
    std::memcpy(ordered, bytes.data(), sizeof(T));
    swapIf(bigEndian_, ordered, sizeof(T));
    std::memcpy(&kind, ordered, sizeof(T));
    return static_cast<double>(kind);
  });
}

std::uint64_t PlyBody::listSize(const PlyProperty& property) {
  const double count = value(next(property.countType), property.countType);
  const double least = ascii_ ? 2 : static_cast<double>(plySize(property.type));
  if (!(count >= 0) || count * least > static_cast<double>(file_.bytes.size() - position_) + 1)
    fail(fmt::format("a list of {} items does not fit; {}", count, kTruncated));
  return static_cast<std::uint64_t>(count);
}

void PlyBody::skipRow(const PlyElement& element) {
  for (const PlyProperty& property : element.properties) {
    const std::uint64_t count = property.list ? listSize(property) : 1;
    for (std::uint64_t k = 0; k < count; ++k) next(property.type);
  }
}

void PlyBody::requireRoom(const PlyElement& element) const {
  std::uint64_t least = 0;
  for (const PlyProperty& p : element.properties)
    least += ascii_ ? 2 : plySize(p.list ? p.countType : p.type);
  const std::uint64_t left = file_.bytes.size() - position_ + 1;
  if (element.count > left / std::max<std::uint64_t>(1, least))
    fail(fmt::format("{} elements {} do not fit in the {} bytes left; {}", element.count,
                     inQuotes(element.name), left - 1, kTruncated));
}

void PlyBody::put(OutputBuffer& out, PlyType type, double value) const {
  withType(type, [&](auto kind) {
    using T = decltype(kind);
    if constexpr (std::is_floating_point_v<T>) {
      kind = static_cast<T>(value);
    } else {
      const double rounded = std::round(value);
      if (!(rounded >= static_cast<double>(std::numeric_limits<T>::min()) &&
            rounded <= static_cast<double>(std::numeric_limits<T>::max())))
        fail(fmt::format("{} does not fit the type of its property; give it a larger one", value));
      kind = static_cast<T>(rounded);
    }
    if (ascii_) {
      if constexpr (sizeof(T) == 1)
        out.print(" {}", static_cast<int>(kind));
      else
        out.print(" {}", kind);
    } else {
      char bytes[sizeof(T)];
      std::memcpy(bytes, &kind, sizeof(T));
      swapIf(bigEndian_, bytes, sizeof(T));
      out.raw(std::string_view(bytes, sizeof(T)));
    }
    return 0;
  });
}

}  // namespace innermap
