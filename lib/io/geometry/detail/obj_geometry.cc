// OBJ: what moves is replaced, all else is copied.
#include <algorithm>
#include <tuple>
#include <unordered_map>

#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "io/geometry/detail/geometry_formats.h"

namespace innermap {
namespace {

enum class Line { vertex, normal, texture, element, other };

Line kindOf(std::string_view keyword) {
  if (keyword == "v") return Line::vertex;
  if (keyword == "vn") return Line::normal;
  if (keyword == "vt") return Line::texture;
  return keyword == "f" || keyword == "fo" || keyword == "l" || keyword == "p" ? Line::element
                                                                               : Line::other;
}

using Numbers = std::vector<double>;

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
  void readElement(LineWords& words, std::string_view keyword, std::size_t line);
  Corner readCorner(std::string_view word, std::size_t line);
  int index(std::string_view word, std::size_t count, const char* what, std::int64_t& highest,
            std::size_t line) const;
  Vec3 three(LineWords& words, std::size_t line) const;
  void numberNormals();
  void requireInRange(std::int64_t highest, std::size_t count, const char* what) const;

  // The numbers of the line at that byte, from the `from`-th on.
  Numbers numbersAt(std::size_t byte, std::size_t from) const;
  Numbers meanOf(const std::vector<std::size_t>& lines, std::size_t from, const Midpoints& middles,
                 std::vector<Numbers>& made, std::size_t i) const;
  void writeVertex(OutputBuffer& out, const Vec3& p, std::size_t begin, std::size_t end) const;
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
  std::int64_t highestPoint_ = 0, highestTexture_ = 0, highestNormal_ = 0;
  bool normalsInPlace_ = true;  // the file's normals keep their numbers
};

Vec3 ObjGeometry::three(LineWords& words, std::size_t line) const {
  Vec3 p;
  std::string_view word;
  for (int a = 0; a < 3; ++a) {
    if (!words.next(word)) failAtLine(file_, line, "the line ends before its three coordinates");
    p[a] = numberOf(file_, line, word);
  }
  return p;
}

void ObjGeometry::read() {
  TextLines lines(file_, true);
  geometry.cornerDirections = true;
  std::size_t begin = 0, end = 0;
  std::string_view keyword;
  for (std::size_t count = 0; lines.next(begin, end); ++count) {
    if (count % 65536 == 0)
      reportProgress("reading",
                     static_cast<double>(begin) / static_cast<double>(file_.bytes.size()));
    LineWords words(file_, begin, end, true);
    if (!words.next(keyword)) continue;
    switch (kindOf(keyword)) {
      case Line::vertex:
        requireCountable(file_, geometry.points.size(), "points");
        geometry.points.push_back(three(words, lines.line()));
        vertexLines_.push_back(begin);
        break;
      case Line::normal:
        requireCountable(file_, normals_.size(), "normals");
        normals_.push_back(three(words, lines.line()));
        break;
      case Line::texture:
        requireCountable(file_, textureLines_.size(), "texture coordinates");
        textureLines_.push_back(begin);
        break;
      case Line::element:
        readElement(words, keyword, lines.line());
        break;
      case Line::other:
        break;
    }
  }
  requireInRange(highestPoint_, geometry.points.size(), "vertex");
  requireInRange(highestTexture_, textureLines_.size(), "texture coordinate");
  requireInRange(highestNormal_, normals_.size(), "normal");
  geometry.ownPoints = geometry.points.size();
  geometry.textures = textureLines_.size();
  numberNormals();
}

void ObjGeometry::requireInRange(std::int64_t highest, std::size_t count, const char* what) const {
  if (highest > static_cast<std::int64_t>(count))
    throw FileError(file_.path, fmt::format("{} index {} is out of range, the file has {}", what,
                                            highest, count));
}

int ObjGeometry::index(std::string_view word, std::size_t count, const char* what,
                       std::int64_t& highest, std::size_t line) const {
  const std::int64_t value = integerOf(file_, line, word), size = static_cast<std::int64_t>(count);
  if (value == 0 || value < -size || value > 2147483647)
    failAtLine(
        file_, line,
        fmt::format("{} index {} is out of range, the file has {} there", what, value, count));
  highest = std::max(highest, value);
  return static_cast<int>(value > 0 ? value - 1 : size + value);
}

// v, v/vt, v//vn or v/vt/vn
Corner ObjGeometry::readCorner(std::string_view word, std::size_t line) {
  Corner corner;
  const std::size_t slash = word.find('/');
  corner.point =
      index(word.substr(0, slash), geometry.points.size(), "vertex", highestPoint_, line);
  if (slash == word.npos) return corner;
  const std::string_view rest = word.substr(slash + 1);
  const std::size_t second = rest.find('/');
  if (const std::string_view uv = rest.substr(0, second); !uv.empty())
    corner.texture = index(uv, textureLines_.size(), "texture coordinate", highestTexture_, line);
  if (second == rest.npos || second + 1 >= rest.size()) return corner;
  const int normal =
      index(rest.substr(second + 1), normals_.size(), "normal", highestNormal_, line);
  const std::uint64_t key =
      static_cast<std::uint64_t>(normal) << 32 | static_cast<std::uint32_t>(corner.point);
  const auto [found, isNew] = useOf_.try_emplace(key, static_cast<int>(uses_.size()));
  if (isNew) uses_.push_back({normal, corner.point, found->second});
  corner.direction = found->second;
  return corner;
}

void ObjGeometry::readElement(LineWords& words, std::string_view keyword, std::size_t line) {
  std::vector<Corner> corners;
  std::string_view word;
  while (words.next(word)) corners.push_back(readCorner(word, line));
  const bool face = keyword[0] == 'f';
  const std::size_t least = face ? 3 : keyword == "l" ? 2 : 1;
  if (corners.size() < least)
    failAtLine(file_, line, fmt::format("it needs {} corners, here are {}", least, corners.size()));
  requireCountable(file_, geometry.elements.corners.size() + corners.size(), "corners");
  geometry.elements.add(face             ? Elements::Kind::face
                        : keyword == "l" ? Elements::Kind::line
                                         : Elements::Kind::points,
                        static_cast<std::uint32_t>(geometry.elements.size()), corners.data(),
                        corners.size());
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
  TextLines lines(file_, true, byte);
  std::size_t begin = 0, end = 0;
  lines.next(begin, end);
  LineWords words(file_, begin, end, true);
  std::string_view word;
  words.next(word);
  Numbers numbers;
  for (std::size_t k = 0; words.next(word); ++k)
    if (k >= from) numbers.push_back(numberOf(file_, lines.line(), word));
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

void ObjGeometry::writeVertex(OutputBuffer& out, const Vec3& p, std::size_t begin,
                              std::size_t end) const {
  LineWords words(file_, begin, end, true);
  std::string_view keyword, word;
  words.next(keyword);
  for (int a = 0; a < 3; ++a) words.next(word);
  out.print("{} {} {} {}", keyword, p.x, p.y, p.z);
  out.raw(std::string_view(file_.bytes).substr(words.position(), end - words.position()));
  if (end == file_.bytes.size() && file_.bytes.back() != '\n') out.raw("\n");
}

void ObjGeometry::writeVertices(OutputBuffer& out, const CarriedGeometry& carried) const {
  for (std::size_t i = 0; i < vertexLines_.size(); ++i) {
    if (carried.number[i] < 0) continue;
    TextLines lines(file_, true, vertexLines_[i]);
    std::size_t begin = 0, end = 0;
    lines.next(begin, end);
    writeVertex(out, carried.points.points[i], begin, end);
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
    TextLines lines(file_, true, line);
    std::size_t begin = 0, end = 0;
    lines.next(begin, end);
    out.raw(std::string_view(file_.bytes).substr(begin, end - begin));
    if (end == file_.bytes.size() && file_.bytes.back() != '\n') out.raw("\n");
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
  TextLines lines(file_, true);
  const Elements& elements = geometry.elements;
  // Where points come and go, all of them are written at the place of the first.
  const bool samePoints = unchanged(carried), sameTextures = carried.added == 0;
  std::size_t begin = 0, end = 0, vertices = 0, normals = 0, textures = 0, element = 0,
              elementLine = 0;
  std::string_view keyword;
  const std::vector<int> directionNumbers = numberDirections(carried);
  const auto normal = [&](std::size_t i) {
    if (directionNumbers[i] < 0) return;
    const Vec3& n = carried.directions[0][i];
    out.print("vn {} {} {}\n", n.x, n.y, n.z);
  };
  while (lines.next(begin, end)) {
    LineWords words(file_, begin, end, true);
    const Line kind = words.next(keyword) ? kindOf(keyword) : Line::other;
    const auto copy = [&] { out.raw(std::string_view(file_.bytes).substr(begin, end - begin)); };
    if (kind == Line::vertex) {
      if (samePoints)
        writeVertex(out, carried.points.points[vertices], begin, end);
      else if (vertices == 0)
        writeVertices(out, carried);
      ++vertices;
    } else if (kind == Line::normal) {
      if (normalsInPlace_ && samePoints)
        normal(normals);
      else if (normals == 0 && !carried.directions.empty())
        for (std::size_t i = 0; i < carried.directions[0].size(); ++i) normal(i);
      ++normals;
    } else if (kind == Line::texture && !sameTextures) {
      if (textures++ == 0) writeTextures(out);
    } else if (kind == Line::element && !(normalsInPlace_ && samePoints)) {
      for (; element < elements.size() && elements.source[element] == elementLine; ++element)
        writeElement(out, keyword, element, carried, directionNumbers);
      ++elementLine;
    } else {
      copy();
    }
  }
  return {};
}

}  // namespace

std::unique_ptr<GeometryFile> readObjGeometry(FileBytes file, const ReadGeometrySettings&) {
  return std::make_unique<ObjGeometry>(std::move(file));
}

}  // namespace innermap
