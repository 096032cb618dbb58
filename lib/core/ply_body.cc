#include "core/ply_body.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/byte_order.h"
#include "innermap/core/error.h"

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "values are copied as they are");

namespace innermap {
namespace {

const char kTruncated[] = "the file is cut short or its header claims too much; export it again";

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

}  // namespace

void PlyBody::fail(const std::string& what) const {
  if (ascii_) scanner_.fail(what);
  throw FileError(file_.path, fmt::format("byte {}: {}", position_, what));
}

void PlyBody::seek(std::size_t position) {
  position_ = position;
  scanner_.seek(position);
}

std::uint64_t PlyBody::rows(const PlyElement& element) const {
  if (element.properties.empty()) return 0;
  std::uint64_t least = 0;
  for (const PlyProperty& p : element.properties)
    least += leastBytes(p.list ? p.countType : p.type);
  if (element.count > remaining() / least)
    fail(fmt::format("{} elements {} do not fit in the {} bytes left; {}", element.count,
                     inQuotes(element.name), remaining(), kTruncated));
  return element.count;
}

std::string_view PlyBody::next(PlyType type) {
  if (ascii_) {
    std::string_view text;
    if (!scanner_.anyToken(text)) fail(kTruncated);
    return text;
  }
  const std::size_t size = plySize(type), begin = position_;
  if (size > file_.bytes.size() - begin) fail(kTruncated);
  position_ += size;
  return {file_.bytes.data() + begin, size};
}

double PlyBody::nextValue(PlyType type) {
  if (ascii_) return nextNumber(type);
  return withType(type, [&](auto kind) {
    if (sizeof kind > file_.bytes.size() - position_) fail(kTruncated);
    kind = numberAt<decltype(kind)>(file_.bytes.data() + position_, bigEndian_);
    position_ += sizeof kind;
    return static_cast<double>(kind);
  });
}

double PlyBody::nextNumber(PlyType type) {
  const std::string_view text = next(type);
  if (!isFloat(type))
    if (const std::optional<std::int64_t> value = parseInteger(text))
      return static_cast<double>(*value);
  const double value = scanner_.number(text);
  if (!isFloat(type) && value != std::floor(value)) fail(inQuotes(text) + " is not a whole number");
  return value;
}

std::uint64_t PlyBody::items(const PlyProperty& property) {
  if (!property.list) return 1;
  const double count = nextValue(property.countType);
  if (!(count >= 0)) fail("a list has a negative size; export the file again");
  if (count * static_cast<double>(leastBytes(property.type)) > static_cast<double>(remaining()))
    fail(fmt::format("a list of {} items does not fit; {}", count, kTruncated));
  return static_cast<std::uint64_t>(count);
}

void PlyBody::skip(const PlyProperty& property) {
  const std::uint64_t count = items(property);
  if (!ascii_ && property.list)
    position_ += count * plySize(property.type);
  else
    for (std::uint64_t k = 0; k < count; ++k) next(property.type);
}

void PlyBody::skipRow(const PlyElement& element) {
  for (const PlyProperty& property : element.properties) skip(property);
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
      char bytes[sizeof kind];
      putNumber(bytes, kind, bigEndian_);
      out.raw({bytes, sizeof kind});
    }
    return 0;
  });
}

PlyRole plyRole(const PlyElement& element) {
  if (element.name == "vertex") return PlyRole::vertices;
  if (element.name == "face") return PlyRole::faces;
  if (element.name == "tristrips") return PlyRole::strips;
  // Edges without ends are something else.
  int ends = 0;
  for (const PlyProperty& property : element.properties)
    ends += plyPart(PlyRole::edges, property) == PlyPart::end;
  return element.name == "edge" && ends == 2 ? PlyRole::edges : PlyRole::other;
}

PlyPart plyPart(PlyRole role, const PlyProperty& property) {
  const std::string& name = property.name;
  if (!property.list)
    return role == PlyRole::edges && (name == "vertex1" || name == "vertex2") ? PlyPart::end
                                                                              : PlyPart::other;
  if (name == "texcoord") return PlyPart::uvs;
  return role != PlyRole::edges && (name == "vertex_indices" || name == "vertex_index")
             ? PlyPart::corners
             : PlyPart::other;
}

PlyFaces::PlyFaces(const PlyElement& element) : element_(element), role_(plyRole(element)) {
  for (const PlyProperty& property : element.properties) parts_.push_back(plyPart(role_, property));
}

int PlyFaces::corner(PlyBody& body, PlyType type) const {
  const double index = body.nextValue(type), least = role_ == PlyRole::strips ? -1 : 0;
  if (!(index >= least && index < std::numeric_limits<int>::max()) || index != std::floor(index))
    body.fail(fmt::format("{} is not an index of a vertex; export the file again", index));
  return static_cast<int>(index);
}

double PlyFaces::uv(PlyBody& body, PlyType type) {
  const double value = body.nextValue(type);
  if (!std::isfinite(value)) body.fail("a texture coordinate is not finite");
  return value;
}

void PlyFaces::read(PlyBody& body) {
  corners.clear();
  uvs.clear();
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const PlyProperty& property = element_.properties[p];
    if (parts_[p] == PlyPart::other) {
      body.skip(property);
      continue;
    }
    const std::uint64_t items = body.items(property);
    if (parts_[p] == PlyPart::uvs)
      for (std::uint64_t k = 0; k < items; ++k) uvs.push_back(uv(body, property.type));
    else
      for (std::uint64_t k = 0; k < items; ++k) corners.push_back(corner(body, property.type));
  }
}

}  // namespace innermap
