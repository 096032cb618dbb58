// PLY: all elements and properties stay, in their types.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "innermap/core/detail/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/io/geometry/detail/ply_body.h"

namespace innermap {
namespace {

enum class Role { other, vertices, faces, strips, edges };

Role roleOf(const PlyElement& element) {
  if (element.name == "vertex") return Role::vertices;
  if (element.name == "face") return Role::faces;
  if (element.name == "tristrips") return Role::strips;
  return element.name == "edge" ? Role::edges : Role::other;
}

bool isIndices(const PlyProperty& p) {
  return p.list && (p.name == "vertex_indices" || p.name == "vertex_index");
}

// What a property of the vertices moves with: the place (-1) or one of the directions.
struct Moving {
  int direction = -1, axis = 0;
};

class PlyGeometry : public GeometryFile {
 public:
  PlyGeometry(FileBytes file, const ReadGeometrySettings& settings)
      : file_(std::move(file)), header_(readPlyHeader(file_)) {
    read(settings);
  }

  std::vector<std::string> write(const std::string&, const CarriedGeometry& carried,
                                 std::ostream& stream) const override;

 private:
  void read(const ReadGeometrySettings& settings);
  void findMoving(const PlyElement& element, const ReadGeometrySettings& settings);
  bool findThree(const PlyElement& element, const std::vector<std::array<std::string, 3>>& names,
                 int direction);
  void readVertices(PlyBody& body, const PlyElement& element);
  void readFace(PlyBody& body, const PlyElement& element, std::uint64_t row);
  void addElement(Role role, std::uint64_t row, const std::vector<double>& indices);

  double moved(const Moving& what, std::size_t point, const CarriedGeometry& carried) const {
    const Points& of = what.direction < 0
                           ? carried.points.points
                           : carried.directions[static_cast<std::size_t>(what.direction)];
    return of[point][what.axis];
  }
  void writeHeader(OutputBuffer& out, const CarriedGeometry& carried) const;
  void writeVertices(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                     const CarriedGeometry& carried) const;
  void writeAdded(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                  const std::vector<std::size_t>& rows, const CarriedGeometry& carried) const;
  void writeElement(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                    std::size_t which) const;
  void copy(OutputBuffer& out, std::size_t begin, std::size_t end) const {
    out.raw(std::string_view(file_.bytes).substr(begin, end - begin));
  }
  std::vector<double> textureAt(int texture) const;

  FileBytes file_;
  PlyHeader header_;
  std::map<std::size_t, Moving> moving_;  // of the vertices' properties, by their place
  std::vector<std::uint32_t> rows_;       // #elements of the file: row among its PLY element's
  std::vector<Role> roles_;               // #elements of the file
  std::vector<double> textures_;          // two for each corner, where faces have them
  mutable const CarriedGeometry* carried_ = nullptr;
};

bool PlyGeometry::findThree(const PlyElement& element,
                            const std::vector<std::array<std::string, 3>>& names, int direction) {
  for (const auto& three : names) {
    std::array<std::optional<std::size_t>, 3> at;
    for (std::size_t p = 0; p < element.properties.size(); ++p)
      for (std::size_t a = 0; a < 3; ++a)
        if (!element.properties[p].list && element.properties[p].name == three[a] && !at[a])
          at[a] = p;
    if (!at[0] || !at[1] || !at[2]) continue;
    for (int a = 0; a < 3; ++a) {
      const PlyType type = element.properties[*at[static_cast<std::size_t>(a)]].type;
      if (!isFloat(type) && !(direction < 0))
        throw FileError(file_.path, "property '" + three[static_cast<std::size_t>(a)] +
                                        "' holds whole numbers; a direction needs float or double");
      moving_[*at[static_cast<std::size_t>(a)]] = {direction, a};
    }
    return true;
  }
  return false;
}

void PlyGeometry::findMoving(const PlyElement& element, const ReadGeometrySettings& settings) {
  if (!findThree(element, {{"x", "y", "z"}}, -1))
    throw FileError(file_.path, "its vertices have no x, y and z");
  for (const PlyProperty& p : element.properties)
    if ((p.name == "x" || p.name == "y" || p.name == "z") && !isFloat(p.type))
      throw FileError(file_.path,
                      "places are whole numbers; write them as float or double to carry them");
  const auto add = [&](const std::string& name, DirectionKind kind, bool must) {
    const auto next = static_cast<int>(geometry.directions.size());
    std::vector<std::array<std::string, 3>> names;
    if (name == "n") names.push_back({"nx", "ny", "nz"});
    for (const char* between : {"_", ".", ""})
      names.push_back({name + between + "x", name + between + "y", name + between + "z"});
    if (findThree(element, names, next))
      geometry.directions.push_back({name, kind, {}, {}});
    else if (must)
      throw FileError(file_.path, fmt::format("has no vector {0}: its vertices have no properties "
                                              "{1}_x, {1}_y and {1}_z",
                                              inQuotes(name), name));
  };
  add("n", DirectionKind::normal, false);
  for (const std::string& name : settings.normals)
    if (name != "n") add(name, DirectionKind::normal, true);
  for (const std::string& name : settings.vectors) add(name, DirectionKind::vector, true);
}

void PlyGeometry::read(const ReadGeometrySettings& settings) {
  PlyBody body(file_, header_);
  bool vertices = false;
  for (const PlyElement& element : header_.elements) {
    body.requireRoom(element);
    const Role role = roleOf(element);
    if (role == Role::vertices) {
      if (vertices) throw FileError(file_.path, "has two elements of vertices; keep one");
      vertices = true;
      findMoving(element, settings);
      readVertices(body, element);
      continue;
    }
    if (role == Role::strips && element.count > 0) geometry.splittable = false;
    for (std::uint64_t row = 0; row < element.count; ++row) {
      if (row % 65536 == 0)
        reportProgress(
            settings.progress, "reading",
            static_cast<double>(body.position()) / static_cast<double>(file_.bytes.size()));
      if (role == Role::other)
        body.skipRow(element);
      else
        readFace(body, element, row);
    }
  }
  if (!vertices) throw FileError(file_.path, "has no vertices");
  const auto count = static_cast<int>(geometry.points.size());
  for (const Corner& corner : geometry.elements.corners)
    if (corner.point >= count || corner.point < -1)
      throw FileError(file_.path, fmt::format("a face uses vertex {}, the file has {} (counted "
                                              "from 0)",
                                              corner.point, count));
  geometry.ownPoints = geometry.points.size();
  geometry.textures = textures_.size() / 2;
}

void PlyGeometry::readVertices(PlyBody& body, const PlyElement& element) {
  requireCountable(file_, element.count, "vertices");
  geometry.points.reserve(element.count);
  std::vector<const Moving*> moving(element.properties.size());
  for (const auto& [at, what] : moving_) moving[at] = &what;
  std::vector<Vec3> values(1 + geometry.directions.size());
  for (std::uint64_t row = 0; row < element.count; ++row) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const std::uint64_t items = property.list ? body.listSize(property) : 1;
      for (std::uint64_t k = 0; k < items; ++k) {
        const std::string_view bytes = body.next(property.type);
        if (!moving[p]) continue;
        const double value = body.value(bytes, property.type);
        if (!std::isfinite(value) && moving[p]->direction < 0)
          body.fail(fmt::format("vertex {} is not finite; export the file again", row));
        values[static_cast<std::size_t>(1 + moving[p]->direction)][moving[p]->axis] = value;
      }
    }
    geometry.points.push_back(values[0]);
    for (std::size_t d = 0; d < geometry.directions.size(); ++d) {
      geometry.directions[d].values.push_back(values[d + 1]);
      geometry.directions[d].points.push_back(static_cast<int>(row));
    }
  }
}

void PlyGeometry::readFace(PlyBody& body, const PlyElement& element, std::uint64_t row) {
  const Role role = roleOf(element);
  std::vector<double> indices, uvs;
  for (const PlyProperty& property : element.properties) {
    const std::uint64_t items = property.list ? body.listSize(property) : 1;
    const bool ends = role == Role::edges && !property.list &&
                      (property.name == "vertex1" || property.name == "vertex2");
    const bool isTexture = property.list && property.name == "texcoord";
    for (std::uint64_t k = 0; k < items; ++k) {
      const std::string_view bytes = body.next(property.type);
      if ((role != Role::edges && isIndices(property)) || ends)
        indices.push_back(body.value(bytes, property.type));
      else if (isTexture)
        uvs.push_back(body.value(bytes, property.type));
    }
  }
  const std::size_t first = textures_.size() / 2;
  addElement(role, row, indices);
  if (uvs.size() != 2 * indices.size() || uvs.empty()) return;
  textures_.insert(textures_.end(), uvs.begin(), uvs.end());
  std::vector<Corner>& corners = geometry.elements.corners;
  for (std::size_t k = 0; k < indices.size(); ++k)
    corners[corners.size() - indices.size() + k].texture = static_cast<int>(first + k);
}

void PlyGeometry::addElement(Role role, std::uint64_t row, const std::vector<double>& indices) {
  std::vector<Corner> corners;
  for (const double index : indices) {
    const double least = role == Role::strips ? -1 : 0;
    if (!(index >= least && index < std::numeric_limits<int>::max()) || index != std::floor(index))
      throw FileError(file_.path, fmt::format("{} is not an index of a vertex", index));
    Corner corner;
    corner.point = static_cast<int>(index);
    corners.push_back(corner);
  }
  requireCountable(file_, geometry.elements.corners.size() + corners.size(), "corners");
  Elements::Kind kind = role == Role::edges    ? Elements::Kind::line
                        : role == Role::strips ? Elements::Kind::cell
                                               : Elements::Kind::face;
  if (kind == Elements::Kind::face && corners.size() < 3) kind = Elements::Kind::cell;
  geometry.elements.add(kind, static_cast<std::uint32_t>(rows_.size()), corners.data(),
                        corners.size());
  rows_.push_back(static_cast<std::uint32_t>(row));
  roles_.push_back(role);
}

void PlyGeometry::writeHeader(OutputBuffer& out, const CarriedGeometry& carried) const {
  std::map<Role, std::uint64_t> counts;
  for (const int number : carried.number) counts[Role::vertices] += number >= 0;
  for (std::size_t e = 0; e < geometry.elements.size(); ++e) {
    const Role role = roles_[geometry.elements.source[e]];
    // A line that was split is as many edges as it has parts.
    const std::size_t corners = geometry.elements.start[e + 1] - geometry.elements.start[e];
    if (carried.stays[e]) counts[role] += role == Role::edges ? corners - 1 : 1;
  }
  std::size_t position = 0;
  for (std::size_t e = 0; e < header_.elements.size(); ++e) {
    const std::size_t line = file_.bytes.find("element", position);
    // Comments may have the word too.
    const std::size_t lineBegin = file_.bytes.find_last_of("\r\n", line) + 1;
    if (file_.bytes.find_first_not_of(" \t", lineBegin) != line) {
      copy(out, position, line + 7);
      position = line + 7;
      --e;
      continue;
    }
    const std::size_t end = file_.bytes.find_first_of("\r\n", line);
    copy(out, position, line);
    const PlyElement& element = header_.elements[e];
    const Role role = roleOf(element);
    out.print("element {} {}", element.name, role == Role::other ? element.count : counts[role]);
    position = end;
  }
  copy(out, position, header_.bodyOffset);
}

void PlyGeometry::writeVertices(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                                const CarriedGeometry& carried) const {
  std::vector<const Moving*> moving(element.properties.size());
  for (const auto& [at, what] : moving_) moving[at] = &what;
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < element.count; ++row) {
    std::size_t copied = body.position();
    if (carried.added > 0) rows.push_back(copied);
    const bool stays = carried.number[row] >= 0;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const std::uint64_t items = property.list ? body.listSize(property) : 1;
      for (std::uint64_t k = 0; k < items; ++k) {
        const std::string_view bytes = body.next(property.type);
        if (!moving[p] || !stays) continue;
        const auto begin = static_cast<std::size_t>(bytes.data() - file_.bytes.data());
        // Digits come with a space of their own.
        copy(out, copied,
             body.ascii() && begin > copied && file_.bytes[begin - 1] == ' ' ? begin - 1 : begin);
        body.put(out, property.type, moved(*moving[p], row, carried));
        copied = begin + bytes.size();
      }
    }
    if (stays) copy(out, copied, body.position());
  }
  if (carried.added > 0) writeAdded(out, body, element, rows, carried);
}

// Properties of points between others are the means of theirs.
void PlyGeometry::writeAdded(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                             const std::vector<std::size_t>& rows,
                             const CarriedGeometry& carried) const {
  const std::size_t after = body.position(), originals = rows.size();
  std::vector<std::vector<double>> made;
  const auto valuesOf = [&](int point) {
    const auto i = static_cast<std::size_t>(point);
    if (i >= originals) return made[i - originals];
    std::vector<double> values;
    body.seek(rows[i]);
    for (const PlyProperty& property : element.properties) {
      const std::uint64_t items = property.list ? body.listSize(property) : 1;
      for (std::uint64_t k = 0; k < items; ++k) {
        const double value = body.value(body.next(property.type), property.type);
        if (!property.list) values.push_back(value);
      }
      if (property.list) values.push_back(0);
    }
    return values;
  };
  for (std::size_t i = 0; i < carried.added; ++i) {
    const auto& [a, b] = geometry.pointMiddles.parents()[i];
    std::vector<double> values = valuesOf(a);
    const std::vector<double> others = valuesOf(b);
    for (std::size_t p = 0; p < values.size(); ++p) values[p] = 0.5 * (values[p] + others[p]);
    made.push_back(values);
    if (carried.number[originals + i] < 0) continue;
    if (body.ascii()) out.raw("\n");
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      const auto found = moving_.find(p);
      if (property.list)
        body.put(out, property.countType, 0);
      else
        body.put(out, property.type,
                 found == moving_.end() ? values[p] : moved(found->second, originals + i, carried));
    }
  }
  body.seek(after);
}

std::vector<double> PlyGeometry::textureAt(int texture) const {
  const auto i = static_cast<std::size_t>(texture);
  const std::size_t originals = textures_.size() / 2;
  if (i < originals) return {textures_[2 * i], textures_[2 * i + 1]};
  const auto& [a, b] = geometry.textureMiddles.parents()[i - originals];
  const std::vector<double> from = textureAt(a), to = textureAt(b);
  return {0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])};
}

// The row at the body's position, with the corners of element `which` in place of its own.
void PlyGeometry::writeElement(OutputBuffer& out, PlyBody& body, const PlyElement& element,
                               std::size_t which) const {
  const Elements& elements = geometry.elements;
  const std::size_t begin = elements.start[which], end = elements.start[which + 1];
  const bool edges = roleOf(element) == Role::edges;
  const auto number = [&](std::size_t k) {
    const int point = elements.corners[k].point;
    return point < 0 ? -1.0 : carried_->number[static_cast<std::size_t>(point)];
  };
  const std::size_t row = body.position();
  for (std::size_t part = 0; part < (edges ? end - begin - 1 : 1); ++part) {
    body.seek(row);
    if (body.ascii()) out.raw("\n");
    for (const PlyProperty& property : element.properties) {
      const std::uint64_t items = property.list ? body.listSize(property) : 1;
      std::vector<double> values;
      for (std::uint64_t k = 0; k < items; ++k)
        values.push_back(body.value(body.next(property.type), property.type));
      if (edges && property.name == "vertex1") values = {number(begin + part)};
      if (edges && property.name == "vertex2") values = {number(begin + part + 1)};
      if (!edges && isIndices(property)) {
        values.clear();
        for (std::size_t k = begin; k < end; ++k) values.push_back(number(k));
      }
      if (property.list && property.name == "texcoord" && elements.corners[begin].texture >= 0) {
        values.clear();
        for (std::size_t k = begin; k < end; ++k)
          for (const double value : textureAt(elements.corners[k].texture)) values.push_back(value);
      }
      if (property.list) body.put(out, property.countType, static_cast<double>(values.size()));
      for (const double value : values) body.put(out, property.type, value);
    }
  }
}

std::vector<std::string> PlyGeometry::write(const std::string&, const CarriedGeometry& carried,
                                            std::ostream& stream) const {
  carried_ = &carried;
  OutputBuffer out(stream);
  writeHeader(out, carried);
  PlyBody body(file_, header_);
  std::size_t next = 0, fileElement = 0;
  for (const PlyElement& element : header_.elements) {
    const Role role = roleOf(element);
    if (role == Role::vertices) {
      writeVertices(out, body, element, carried);
      continue;
    }
    for (std::uint64_t row = 0; row < element.count; ++row) {
      const std::size_t begin = body.position();
      body.skipRow(element);
      const std::size_t end = body.position();
      if (role == Role::other || unchanged(carried)) {
        copy(out, begin, end);
        continue;
      }
      for (; next < geometry.elements.size() && geometry.elements.source[next] == fileElement;
           ++next) {
        if (!carried.stays[next]) continue;
        body.seek(begin);
        writeElement(out, body, element, next);
      }
      body.seek(end);
      ++fileElement;
    }
  }
  copy(out, body.position(), file_.bytes.size());
  return {};
}

}  // namespace

std::unique_ptr<GeometryFile> readPlyGeometry(FileBytes file,
                                              const ReadGeometrySettings& settings) {
  return std::make_unique<PlyGeometry>(std::move(file), settings);
}

}  // namespace innermap
