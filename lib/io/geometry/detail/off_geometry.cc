// OFF as text, with vertices one to a line.
#include <algorithm>

#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "io/geometry/detail/geometry_formats.h"

namespace innermap {
namespace {

class OffGeometry : public GeometryFile {
 public:
  explicit OffGeometry(FileBytes file) : file_(std::move(file)) {
    geometry.splittable = false;
    read();
  }

  std::vector<std::string> write(const std::string&, const CarriedGeometry& carried,
                                 std::ostream& stream) const override;

 private:
  void read();
  // The next line with words on it.
  bool filled(TextLines& lines, std::size_t& begin, std::size_t& end) const {
    std::string_view word;
    while (lines.next(begin, end))
      if (LineWords(file_, begin, end, true).next(word)) return true;
    return false;
  }
  void readCounts(TextLines& lines);
  void readFace(LineWords words, std::size_t line, std::uint32_t number);

  FileBytes file_;
  std::size_t countsBegin_ = 0, countsEnd_ = 0;  // bytes of the words of the counts
  std::size_t bodyBegin_ = 0;                    // byte of the line behind them
  std::int64_t vertices_ = 0, faces_ = 0, edges_ = 0;
  bool normals_ = false;
};

void OffGeometry::readCounts(TextLines& lines) {
  std::size_t begin = 0, end = 0;
  if (!filled(lines, begin, end)) failAtLine(file_, 1, "is empty");
  LineWords words(file_, begin, end, true);
  std::string_view word;
  words.next(word);
  const std::size_t off = word.find("OFF");
  if (off == word.npos || off + 3 != word.size())
    failAtLine(file_, lines.line(), "an OFF file begins with OFF; give an OFF file");
  const std::string_view before = word.substr(0, off);
  if (before.find_first_not_of("STCN") != before.npos)
    failAtLine(file_, lines.line(), inQuotes(word) + " is not read, only OFF, COFF, NOFF, STOFF");
  normals_ = before.find('N') != before.npos;
  std::size_t position = words.position();
  if (!words.next(word)) {
    if (!filled(lines, begin, end)) failAtLine(file_, lines.line(), "has no counts");
    words = LineWords(file_, begin, end, true);
    position = words.position();
    words.next(word);
  }
  if (equalsIgnoringCase(word, "BINARY"))
    failAtLine(file_, lines.line(), "binary OFF files are not read; write text");
  countsBegin_ = position;
  std::int64_t* counts[] = {&vertices_, &faces_, &edges_};
  for (std::int64_t* count : counts) {
    if (word.empty()) break;
    *count = integerOf(file_, lines.line(), word);
    countsEnd_ = words.position();
    if (!words.next(word)) word = {};
  }
  bodyBegin_ = end;
  const auto room = static_cast<std::int64_t>((file_.bytes.size() - end + 1) / 2);
  if (vertices_ < 0 || faces_ < 0 || vertices_ > room / 3 || faces_ > room)
    failAtLine(file_, lines.line(),
               fmt::format("{} vertices and {} faces do not fit in the file", vertices_, faces_));
}

void OffGeometry::read() {
  TextLines lines(file_, false);
  readCounts(lines);
  requireCountable(file_, static_cast<std::size_t>(vertices_), "vertices");
  if (normals_) geometry.directions.push_back({"normals", DirectionKind::normal, {}, {}});
  std::size_t begin = 0, end = 0;
  const auto next = [&](std::int64_t i) {
    if (i % 65536 == 0) throwIfCancelled();
    if (!filled(lines, begin, end))
      failAtLine(file_, lines.line(), "the file is cut short or its counts are wrong");
    return LineWords(file_, begin, end, true);
  };
  for (std::int64_t v = 0; v < vertices_; ++v) {
    LineWords words = next(v);
    std::string_view word;
    Vec3 values[2];
    for (int k = 0; k < (normals_ ? 6 : 3); ++k) {
      if (!words.next(word)) failAtLine(file_, lines.line(), "a vertex has too few numbers");
      values[k / 3][k % 3] = numberOf(file_, lines.line(), word);
    }
    geometry.points.push_back(values[0]);
    if (!normals_) continue;
    geometry.directions[0].values.push_back(values[1]);
    geometry.directions[0].points.push_back(static_cast<int>(v));
  }
  for (std::int64_t f = 0; f < faces_; ++f) {
    const LineWords words = next(f);
    readFace(words, lines.line(), static_cast<std::uint32_t>(f));
  }
  geometry.ownPoints = geometry.points.size();
}

void OffGeometry::readFace(LineWords words, std::size_t line, std::uint32_t number) {
  std::string_view word;
  words.next(word);
  const std::int64_t count = integerOf(file_, line, word);
  std::vector<Corner> corners;
  for (std::int64_t k = 0; k < count; ++k) {
    if (!words.next(word)) failAtLine(file_, line, "a face has too few corners");
    const std::int64_t index = integerOf(file_, line, word);
    if (index < 0 || index >= vertices_)
      failAtLine(file_, line, fmt::format("a face uses vertex {} of {}", index, vertices_));
    Corner corner;
    corner.point = static_cast<int>(index);
    corners.push_back(corner);
  }
  geometry.elements.add(Elements::Kind::face, number, corners.data(), corners.size());
}

std::vector<std::string> OffGeometry::write(const std::string&, const CarriedGeometry& carried,
                                            std::ostream& stream) const {
  OutputBuffer out(stream);
  const auto copy = [&](std::size_t begin, std::size_t end) {
    out.raw(std::string_view(file_.bytes).substr(begin, end - begin));
  };
  std::size_t points = 0, faces = 0;
  for (const int number : carried.number) points += number >= 0;
  for (const std::uint8_t stays : carried.stays) faces += stays;
  copy(0, countsBegin_);
  out.print("{}{} {} {}", countsBegin_ > 0 && file_.bytes[countsBegin_ - 1] == 'F' ? " " : "",
            points, faces, edges_);
  copy(countsEnd_, bodyBegin_);
  TextLines lines(file_, false, bodyBegin_);
  std::size_t begin = 0, end = 0, row = 0;
  const auto vertices = static_cast<std::size_t>(vertices_), all = vertices + carried.stays.size();
  while (lines.next(begin, end)) {
    LineWords words(file_, begin, end, true);
    std::string_view word;
    if (row >= all || !words.next(word)) {
      copy(begin, end);
      continue;
    }
    if (row < vertices) {
      for (int k = 1; k < (normals_ ? 6 : 3); ++k) words.next(word);
      const Vec3& p = carried.points.points[row];
      if (carried.number[row] >= 0) {
        out.print("{} {} {}", p.x, p.y, p.z);
        if (normals_) {
          const Vec3& n = carried.directions[0][row];
          out.print(" {} {} {}", n.x, n.y, n.z);
        }
        copy(words.position(), end);
      }
    } else if (const std::size_t face = row - vertices; carried.stays[face]) {
      const Elements& elements = geometry.elements;
      out.print("{}", elements.start[face + 1] - elements.start[face]);
      for (std::size_t k = elements.start[face]; k < elements.start[face + 1]; ++k) {
        words.next(word);
        out.print(" {}", carried.number[static_cast<std::size_t>(elements.corners[k].point)]);
      }
      copy(words.position(), end);
    }
    ++row;
  }
  return {};
}

}  // namespace

std::unique_ptr<GeometryFile> readOffGeometry(FileBytes file, const ReadGeometrySettings&) {
  return std::make_unique<OffGeometry>(std::move(file));
}

}  // namespace innermap
