// OBJ: what moves is replaced, all else is copied.
#include <algorithm>
#include <tuple>
#include <unordered_map>

#include "innermap/core/run.h"
#include "io/geometry/detail/geometry_formats.h"
#include "mesh/obj_scanner.h"

namespace innermap {
namespace {

using Numbers = std::vector<double>;

Elements::Kind elementKind(ObjLine kind) {
  if (kind == ObjLine::face) return Elements::Kind::face;
  return kind == ObjLine::line ? Elements::Kind::line : Elements::Kind::points;
}

class ObjGeometry : public GeometryFile {
 public:
  explicit ObjGeometry(FileBytes file) : file_(std::move(file)) { read(); }

  std::vector<std::string> write(const std::string&, const CarriedGeometry& carried,
                                 std::ostream& stream) const override;

 private:
  // A use of a normal at a point.
  struct Use {
    int normal, point;
    int id;
  };

  void read();
  void readElement(ObjScanner& obj);
  int useOf(int normal, int point);
  void numberNormals();

  // The numbers of the line at that byte, from the `from`-th on.
  Numbers numbersAt(std::size_t byte, std::size_t from) const;
  Numbers meanOf(const std::vector<std::size_t>& lines, std::size_t from, const Midpoints& middles,
                 std::vector<Numbers>& made, std::size_t i) const;
  // The rest of the line, to which a line break is added where the file ends without one.
  void copyRest(OutputBuffer& out, TextScanner& text) const;
  void writeVertex(OutputBuffer& out, const Vec3& p, TextScanner& text) const;
  void writeVertices(OutputBuffer& out, const CarriedGeometry& carried) const;
  void writeTextures(OutputBuffer& out) const;
  void writeElement(OutputBuffer& out, std::string_view keyword, std::size_t element,
                    const CarriedGeometry& carried, const std::vector<int>& directionNumbers) const;
  std::vector<int> numberDirections(const CarriedGeometry& carried) const;

  FileBytes file_;
  std::vector<std::size_t> vertexLines_, textureLines_;  // bytes
  Points normals_;                                       // of the file
  std::vector<Use> uses_;
  std::unordered_map<std::uint64_t, int> useOf_;
  bool normalsInPlace_ = true;  // the file's normals keep their numbers
};

void ObjGeometry::read() {
  ObjScanner obj(file_, true);
  for (std::size_t count = 0; obj.next(); ++count) {
    if (count % 65536 == 0) reportProgress("reading", obj.fraction());
    switch (obj.kind()) {
      case ObjLine::vertex:
        requireCountable(file_.path, geometry.points.size());
        geometry.points.push_back(obj.text().nextVec3("three coordinates"));
        vertexLines_.push_back(obj.text().lineBegin());
        break;
      case ObjLine::normal:
        requireCountable(file_.path, normals_.size());
        normals_.push_back(obj.text().nextVec3("three coordinates"));
        break;
      case ObjLine::texture:
        requireCountable(file_.path, textureLines_.size());
        textureLines_.push_back(obj.text().lineBegin());
        break;
      case ObjLine::other:
        break;
      default:
        readElement(obj);
    }
  }
  obj.requireInRange();
  geometry.ownPoints = geometry.points.size();
  geometry.textures = textureLines_.size();
  numberNormals();
}

void ObjGeometry::readElement(ObjScanner& obj) {
  std::vector<Corner> corners;
  for (const ObjCorner& corner : obj.corners())
    corners.push_back({corner.vertex, corner.normal < 0 ? -1 : useOf(corner.normal, corner.vertex),
                       corner.texture});
  requireCountable(file_.path, geometry.elements.corners.size() + corners.size());
  geometry.elements.add(elementKind(obj.kind()),
                        static_cast<std::uint32_t>(geometry.elements.size()), corners.data(),
                        corners.size());
}

int ObjGeometry::useOf(int normal, int point) {
  const std::uint64_t key =
      static_cast<std::uint64_t>(normal) << 32 | static_cast<std::uint32_t>(point);
  const auto [found, isNew] = useOf_.try_emplace(key, static_cast<int>(uses_.size()));
  if (isNew) uses_.push_back({normal, point, found->second});
  return found->second;
}

// Uses of normals become directions, in the order of the file's normals.
void ObjGeometry::numberNormals() {
  useOf_.clear();
  // Point clouds have a normal for each point and no face.
  if (uses_.empty() && normals_.size() == geometry.points.size())
    for (int i = 0; i < static_cast<int>(normals_.size()); ++i) uses_.push_back({i, i, i});
  std::sort(uses_.begin(), uses_.end(), [](const Use& a, const Use& b) {
    return std::tie(a.normal, a.id) < std::tie(b.normal, b.id);
  });
  std::vector<int> newId(uses_.size());
  Directions directions;
  directions.name = "vn";
  std::size_t used = 0;
  for (std::size_t i = 0; i < uses_.size(); ++i) {
    newId[static_cast<std::size_t>(uses_[i].id)] = static_cast<int>(i);
    directions.values.push_back(normals_[static_cast<std::size_t>(uses_[i].normal)]);
    directions.points.push_back(uses_[i].point);
    used += i == 0 || uses_[i].normal != uses_[i - 1].normal;
    normalsInPlace_ = normalsInPlace_ && uses_[i].normal == static_cast<int>(i);
  }
  normalsInPlace_ = normalsInPlace_ && uses_.size() == normals_.size();
  if (used < normals_.size())
    notes.push_back(fmt::format("{}: {} normals that nothing uses are left out", file_.path,
                                normals_.size() - used));
  for (Corner& corner : geometry.elements.corners)
    if (corner.direction >= 0) corner.direction = newId[static_cast<std::size_t>(corner.direction)];
  uses_ = {};
  geometry.cornerDirections = !directions.values.empty();
  if (geometry.cornerDirections) geometry.directions.push_back(std::move(directions));
}

Numbers ObjGeometry::numbersAt(std::size_t byte, std::size_t from) const {
  TextScanner text(file_, kObjSyntax, byte);
  text.nextLine();
  std::string_view word;
  text.token(word);
  Numbers numbers;
  for (std::size_t k = 0; text.token(word); ++k)
    if (k >= from) numbers.push_back(text.number(word));
  return numbers;
}

// Of the middle `i`: the means of its parents' numbers, where they have equally many.
Numbers ObjGeometry::meanOf(const std::vector<std::size_t>& lines, std::size_t from,
                            const Midpoints& middles, std::vector<Numbers>& made,
                            std::size_t i) const {
  const auto of = [&](int parent) {
    const auto p = static_cast<std::size_t>(parent);
    return p < middles.originals() ? numbersAt(lines[p], from) : made[p - middles.originals()];
  };
  Numbers a = of(middles.parents()[i][0]);
  const Numbers b = of(middles.parents()[i][1]);
  a.resize(std::min(a.size(), b.size()));
  for (std::size_t k = 0; k < a.size(); ++k) a[k] = 0.5 * (a[k] + b[k]);
  made.push_back(a);
  return a;
}

void ObjGeometry::copyRest(OutputBuffer& out, TextScanner& text) const {
  const std::size_t begin = text.position(), end = text.endLine();
  out.raw(std::string_view(file_.bytes).substr(begin, end - begin));
  if (end == file_.bytes.size() && file_.bytes.back() != '\n') out.raw("\n");
}

void ObjGeometry::writeVertex(OutputBuffer& out, const Vec3& p, TextScanner& text) const {
  std::string_view word;
  for (int a = 0; a < 3; ++a) text.token(word);
  out.print("v {} {} {}", p.x, p.y, p.z);
  copyRest(out, text);
}

void ObjGeometry::writeVertices(OutputBuffer& out, const CarriedGeometry& carried) const {
  for (std::size_t i = 0; i < vertexLines_.size(); ++i) {
    if (carried.number[i] < 0) continue;
    TextScanner text(file_, kObjSyntax, vertexLines_[i]);
    std::string_view keyword;
    text.nextFilledLine(keyword);
    writeVertex(out, carried.points.points[i], text);
  }
  std::vector<Numbers> made;
  for (std::size_t i = 0; i < carried.added; ++i) {
    const Numbers more = meanOf(vertexLines_, 3, geometry.pointMiddles, made, i);
    const Vec3& p = carried.points.points[vertexLines_.size() + i];
    if (carried.number[vertexLines_.size() + i] < 0) continue;
    out.print("v {} {} {}", p.x, p.y, p.z);
    for (const double value : more) out.print(" {}", value);
    out.raw("\n");
  }
}

void ObjGeometry::writeTextures(OutputBuffer& out) const {
  for (const std::size_t line : textureLines_) {
    TextScanner text(file_, kObjSyntax, line);
    text.nextLine();
    copyRest(out, text);
  }
  std::vector<Numbers> made;
  for (std::size_t i = 0; i < geometry.textureMiddles.parents().size(); ++i) {
    out.raw("vt");
    for (const double value : meanOf(textureLines_, 0, geometry.textureMiddles, made, i))
      out.print(" {}", value);
    out.raw("\n");
  }
}

// Normals of points that stay, in order; -1 for others.
std::vector<int> ObjGeometry::numberDirections(const CarriedGeometry& carried) const {
  std::vector<int> out;
  if (geometry.directions.empty()) return out;
  int next = 0;
  for (const int point : geometry.directions[0].points)
    out.push_back(carried.number[static_cast<std::size_t>(point)] < 0 ? -1 : next++);
  return out;
}

void ObjGeometry::writeElement(OutputBuffer& out, std::string_view keyword, std::size_t element,
                               const CarriedGeometry& carried,
                               const std::vector<int>& directionNumbers) const {
  const Elements& elements = geometry.elements;
  if (!carried.stays[element]) return;
  bool any = false;
  for (std::size_t k = elements.start[element]; k < elements.start[element + 1]; ++k) {
    const Corner& corner = elements.corners[k];
    const int number = carried.number[static_cast<std::size_t>(corner.point)];
    if (number < 0) continue;  // of a set of points
    if (!any) out.raw(keyword);
    any = true;
    out.print(" {}", number + 1);
    if (corner.texture >= 0 || corner.direction >= 0) out.raw("/");
    if (corner.texture >= 0) out.print("{}", corner.texture + 1);
    if (corner.direction >= 0)
      out.print("/{}", directionNumbers[static_cast<std::size_t>(corner.direction)] + 1);
  }
  if (any) out.raw("\n");
}

std::vector<std::string> ObjGeometry::write(const std::string&, const CarriedGeometry& carried,
                                            std::ostream& stream) const {
  OutputBuffer out(stream);
  FileCopy copy(file_, out);
  ObjScanner obj(file_, true);
  const Elements& elements = geometry.elements;
  // Where points come and go, all of them are written at the place of the first.
  const bool samePoints = unchanged(carried), sameTextures = carried.added == 0;
  std::size_t vertices = 0, normals = 0, textures = 0, element = 0, elementLine = 0;
  const std::vector<int> directionNumbers = numberDirections(carried);
  const auto normal = [&](std::size_t i) {
    if (directionNumbers[i] < 0) return;
    const Vec3& n = carried.directions[0][i];
    out.print("vn {} {} {}\n", n.x, n.y, n.z);
  };
  while (obj.next()) {
    const ObjLine kind = obj.kind();
    if (kind == ObjLine::other || (kind == ObjLine::texture && sameTextures)) continue;
    const bool isElement =
        kind != ObjLine::vertex && kind != ObjLine::normal && kind != ObjLine::texture;
    if (isElement && normalsInPlace_ && samePoints) continue;
    copy.to(obj.text().lineBegin());
    if (kind == ObjLine::vertex) {
      if (samePoints)
        writeVertex(out, carried.points.points[vertices], obj.text());
      else if (vertices == 0)
        writeVertices(out, carried);
      ++vertices;
    } else if (kind == ObjLine::normal) {
      if (normalsInPlace_ && samePoints)
        normal(normals);
      else if (normals == 0 && !carried.directions.empty())
        for (std::size_t i = 0; i < carried.directions[0].size(); ++i) normal(i);
      ++normals;
    } else if (kind == ObjLine::texture) {
      if (textures++ == 0) writeTextures(out);
    } else {
      for (; element < elements.size() && elements.source[element] == elementLine; ++element)
        writeElement(out, obj.keyword(), element, carried, directionNumbers);
      ++elementLine;
    }
    copy.skipTo(obj.text().endLine());
  }
  copy.to(file_.bytes.size());
  return {};
}

}  // namespace

std::unique_ptr<GeometryFile> readObjGeometry(FileBytes file) {
  return std::make_unique<ObjGeometry>(std::move(file));
}

}  // namespace innermap
