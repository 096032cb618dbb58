// PLY: elements and properties in any order and of any type; those of no use here are skipped.
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "core/ply_header.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/detail/polygon_mesh.h"

namespace innermap {
namespace {

const char kTruncated[] = "the file is cut short or its header promises too much; export it again";

// The body of a binary file.
class BinaryBody {
 public:
  BinaryBody(const FileBytes& file, const PlyHeader& header)
      : file_(file), position_(header.bodyOffset), big_(header.format == PlyFormat::bigEndian) {}

  std::size_t remaining() const { return file_.bytes.size() - position_; }
  static std::size_t leastBytes(PlyType type) { return plySize(type); }

  [[noreturn]] void fail(const std::string& what) const {
    throw FileError(file_.path, fmt::format("byte {}: {}", position_, what));
  }

  void skip(PlyType type) { position_ += take(plySize(type)); }
  void skip(PlyType type, std::uint64_t count) {
    if (count > remaining() / plySize(type)) fail(kTruncated);
    position_ += count * plySize(type);
  }

  double value(PlyType type) {
    switch (type) {
      case PlyType::int8:
        return as<std::int8_t>();
      case PlyType::uint8:
        return as<std::uint8_t>();
      case PlyType::int16:
        return as<std::int16_t>();
      case PlyType::uint16:
        return as<std::uint16_t>();
      case PlyType::int32:
        return as<std::int32_t>();
      case PlyType::uint32:
        return as<std::uint32_t>();
      case PlyType::float32:
        return as<float>();
      case PlyType::float64:
        return as<double>();
    }
    return 0;
  }

 private:
  std::size_t take(std::size_t size) const {
    if (size > remaining()) fail(kTruncated);
    return size;
  }

  template <class T>
  double as() {
    using Bits = std::conditional_t<
        sizeof(T) == 1, std::uint8_t,
        std::conditional_t<sizeof(T) == 2, std::uint16_t,
                           std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;
    take(sizeof(T));
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < sizeof(T); ++k) {
      const auto byte = static_cast<unsigned char>(file_.bytes[position_ + k]);
      bits |= static_cast<std::uint64_t>(byte) << (8 * (big_ ? sizeof(T) - 1 - k : k));
    }
    position_ += sizeof(T);
    const Bits narrow = static_cast<Bits>(bits);
    T value;
    std::memcpy(&value, &narrow, sizeof(T));
    return static_cast<double>(value);
  }

  const FileBytes& file_;
  std::size_t position_;
  bool big_;
};

// The body of a text file: numbers apart by white space; lines mean nothing.
class AsciiBody {
 public:
  AsciiBody(const FileBytes& file, const PlyHeader& header)
      : scanner_(file, {}, header.bodyOffset, header.bodyLine) {}

  // A number takes two bytes, but the last may lack its white space.
  std::size_t remaining() const { return scanner_.remainingBytes() + 1; }
  static std::size_t leastBytes(PlyType) { return 2; }
  [[noreturn]] void fail(const std::string& what) const { scanner_.fail(what); }

  void skip(PlyType) {
    std::string_view text;
    if (!scanner_.anyToken(text)) fail(kTruncated);
  }
  void skip(PlyType type, std::uint64_t count) {
    for (std::uint64_t k = 0; k < count; ++k) skip(type);
  }

  double value(PlyType type) {
    std::string_view text;
    if (!scanner_.anyToken(text)) fail(kTruncated);
    const double number = scanner_.number(text);
    if (!isFloat(type) && number != std::floor(number))
      fail(inQuotes(text) + " is not a whole number");
    return number;
  }

 private:
  TextScanner scanner_;
};

enum Role { kX, kY, kZ, kRed, kGreen, kBlue, kU, kV, kRoles, kNone = kRoles };

Role roleOf(const PlyProperty& property) {
  static const std::pair<const char*, Role> kNames[] = {{"x", kX},
                                                        {"y", kY},
                                                        {"z", kZ},
                                                        {"red", kRed},
                                                        {"green", kGreen},
                                                        {"blue", kBlue},
                                                        {"diffuse_red", kRed},
                                                        {"diffuse_green", kGreen},
                                                        {"diffuse_blue", kBlue},
                                                        {"r", kRed},
                                                        {"g", kGreen},
                                                        {"b", kBlue},
                                                        {"s", kU},
                                                        {"t", kV},
                                                        {"u", kU},
                                                        {"v", kV},
                                                        {"texture_u", kU},
                                                        {"texture_v", kV}};
  for (const auto& [name, role] : kNames)
    if (!property.list && property.name == name) return role;
  return kNone;
}

double colourScale(PlyType type) {
  if (isFloat(type)) return 1;
  return type == PlyType::int16 || type == PlyType::uint16 ? 1 / 65535.0 : 1 / 255.0;
}

template <class Body>
class PlyReader {
 public:
  PlyReader(const FileBytes& file, const PlyHeader& header)
      : file_(file), header_(header), body_(file, header) {}

  PolygonMesh read() {
    for (const PlyElement& element : header_.elements) {
      requireRoom(element);
      if (element.name == "vertex")
        readVertices(element);
      else if (element.name == "face" || element.name == "tristrips")
        readFaces(element, element.name == "tristrips");
      else
        skipElements(element);
    }
    const int count = static_cast<int>(mesh_.vertices.size());
    for (const int v : mesh_.corners)
      if (v < 0 || v >= count)
        throw FileError(file_.path, fmt::format("a face uses vertex {}, the file has {} (counted "
                                                "from 0); export the mesh again",
                                                v, count));
    finishUvs();
    return std::move(mesh_);
  }

 private:
  void requireRoom(const PlyElement& element) const {
    std::uint64_t least = 0;
    for (const PlyProperty& p : element.properties)
      least += Body::leastBytes(p.list ? p.countType : p.type);
    if (least > 0 && element.count > body_.remaining() / least)
      body_.fail(fmt::format("{} elements '{}' do not fit in the {} bytes left; {}", element.count,
                             element.name.substr(0, 40), body_.remaining(), kTruncated));
  }

  void poll(std::uint64_t index) const {
    if (index % 65536 == 0) throwIfCancelled();
  }

  std::uint64_t listSize(const PlyProperty& property) {
    const double count = body_.value(property.countType);
    if (!(count >= 0)) body_.fail("a list has a negative size; export the mesh again");
    if (count * static_cast<double>(Body::leastBytes(property.type)) >
        static_cast<double>(body_.remaining()))
      body_.fail(fmt::format("a list of {} items does not fit; {}", count, kTruncated));
    return static_cast<std::uint64_t>(count);
  }

  void skip(const PlyProperty& property) {
    if (property.list)
      body_.skip(property.type, listSize(property));
    else
      body_.skip(property.type);
  }

  void skipElements(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      poll(i);
      for (const PlyProperty& property : element.properties) skip(property);
    }
  }

  void readVertices(const PlyElement& element) {
    std::vector<Role> roles;
    bool has[kRoles + 1] = {};
    double scale = 1;
    for (const PlyProperty& property : element.properties) {
      const Role role = roleOf(property);
      // The first of each name counts: some files have u v and s t.
      roles.push_back(has[role] ? kNone : role);
      has[role] = true;
      if (role == kRed) scale = colourScale(property.type);
    }
    if (!mesh_.vertices.empty()) body_.fail("the file has two vertex elements; keep one");
    if (!has[kX] || !has[kY] || !has[kZ]) body_.fail("the vertices have no x, y and z");
    const bool colours = has[kRed] && has[kGreen] && has[kBlue], uvs = has[kU] && has[kV];
    requireCountable(file_.path, element.count);
    mesh_.vertices.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      poll(i);
      double values[kRoles] = {};
      for (std::size_t p = 0; p < roles.size(); ++p)
        if (roles[p] == kNone)
          skip(element.properties[p]);
        else
          values[roles[p]] = body_.value(element.properties[p].type);
      if (!isFinite({values[kX], values[kY], values[kZ]}) || !std::isfinite(values[kU]) ||
          !std::isfinite(values[kV]))
        body_.fail(fmt::format("vertex {} is not finite; export the mesh again", i));
      mesh_.vertices.push_back({values[kX], values[kY], values[kZ]});
      if (colours)
        mesh_.colours.push_back(
            clampedColour(scale * values[kRed], scale * values[kGreen], scale * values[kBlue]));
      if (uvs) vertexUvs_.push_back({values[kU], values[kV]});
    }
  }

  void readFaces(const PlyElement& element, bool strips) {
    int indices = -1, uvs = -1;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (!property.list) continue;
      if (property.name == "vertex_indices" || property.name == "vertex_index")
        indices = static_cast<int>(p);
      else if (property.name == "texcoord")
        uvs = static_cast<int>(p);
    }
    if (indices < 0 && element.count > 0)
      body_.fail(fmt::format("the element '{}' has no list vertex_indices", element.name));
    for (std::uint64_t i = 0; i < element.count; ++i) {
      poll(i);
      faceUvs_.clear();
      for (std::size_t p = 0; p < element.properties.size(); ++p)
        if (static_cast<int>(p) == indices)
          readIndices(element.properties[p]);
        else if (static_cast<int>(p) == uvs)
          readFaceUvs(element.properties[p]);
        else
          skip(element.properties[p]);
      if (strips)
        addStrip();
      else
        addFace(i);
    }
  }

  void readIndices(const PlyProperty& property) {
    const std::uint64_t count = listSize(property);
    face_.clear();
    face_.reserve(count);
    for (std::uint64_t k = 0; k < count; ++k) {
      const double index = body_.value(property.type);
      if (!(index >= -1 && index < std::numeric_limits<int>::max()) || index != std::floor(index))
        body_.fail(fmt::format("{} is not an index of a vertex; export the mesh again", index));
      face_.push_back(static_cast<int>(index));
    }
  }

  void readFaceUvs(const PlyProperty& property) {
    const std::uint64_t count = listSize(property);
    for (std::uint64_t k = 0; k < count; ++k) {
      const double value = body_.value(property.type);
      if (!std::isfinite(value)) body_.fail("a texture coordinate is not finite");
      faceUvs_.push_back(value);
    }
  }

  void addFace(std::uint64_t number) {
    if (face_.size() < 3)
      body_.fail(
          fmt::format("face {} has {} corners, it needs three; remove it", number, face_.size()));
    requireCountable(file_.path, mesh_.corners.size() + face_.size());
    mesh_.corners.insert(mesh_.corners.end(), face_.begin(), face_.end());
    mesh_.start.push_back(static_cast<int>(mesh_.corners.size()));
    if (faceUvs_.size() != 2 * face_.size()) return;
    mesh_.uvCorners.resize(mesh_.corners.size() - face_.size(), -1);
    for (std::size_t k = 0; k < face_.size(); ++k) {
      mesh_.uvCorners.push_back(static_cast<int>(mesh_.uvs.size()));
      mesh_.uvs.push_back({faceUvs_[2 * k], faceUvs_[2 * k + 1]});
    }
  }

  // Every vertex from the third makes a triangle with the two before, turned every other time; -1
  // begins a new strip; repeated vertices only steer the strip.
  void addStrip() {
    std::size_t first = 0;
    for (std::size_t k = 0; k < face_.size(); ++k) {
      if (face_[k] < 0) first = k + 1;
      if (face_[k] < 0 || k < first + 2) continue;
      Triangle t{face_[k - 2], face_[k - 1], face_[k]};
      if ((k - first) % 2 == 1) std::swap(t[0], t[1]);
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      requireCountable(file_.path, mesh_.corners.size() + 3);
      mesh_.corners.insert(mesh_.corners.end(), t.begin(), t.end());
      mesh_.start.push_back(static_cast<int>(mesh_.corners.size()));
    }
  }

  void finishUvs() {
    if (!mesh_.uvCorners.empty()) {
      mesh_.uvCorners.resize(mesh_.corners.size(), -1);
    } else if (!vertexUvs_.empty()) {
      mesh_.uvs = std::move(vertexUvs_);
      mesh_.uvCorners = mesh_.corners;
    }
  }

  const FileBytes& file_;
  const PlyHeader& header_;
  Body body_;
  PolygonMesh mesh_;
  std::vector<Vec2> vertexUvs_;
  std::vector<int> face_;
  std::vector<double> faceUvs_;
};

}  // namespace

PolygonMesh readPly(const FileBytes& file) {
  const PlyHeader header = readPlyHeader(file);
  if (header.format == PlyFormat::ascii) return PlyReader<AsciiBody>(file, header).read();
  return PlyReader<BinaryBody>(file, header).read();
}

}  // namespace innermap
