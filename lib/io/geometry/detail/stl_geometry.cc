// STL, binary and text. A triangle's normal is carried at its centre.
#include <cmath>
#include <cstring>

#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "io/geometry/detail/geometry_formats.h"

namespace innermap {
namespace {

constexpr std::size_t kHeader = 84, kTriangle = 50;  // bytes

class StlGeometry : public GeometryFile {
 public:
  explicit StlGeometry(FileBytes file) : file_(std::move(file)) {
    geometry.splittable = false;
    geometry.directions.push_back({"normals", DirectionKind::normal, {}, {}});
    std::uint32_t count = 0;
    if (file_.bytes.size() >= kHeader) std::memcpy(&count, file_.bytes.data() + 80, 4);
    binary_ = file_.bytes.size() == kHeader + kTriangle * static_cast<std::size_t>(count) ||
              file_.bytes.compare(0, 5, "solid") != 0;
    if (binary_ && file_.bytes.size() < kHeader + kTriangle * static_cast<std::size_t>(count))
      throw FileError(file_.path,
                      fmt::format("{} triangles do not fit in the file; it is cut short", count));
    if (binary_)
      readBinary(count);
    else
      readText();
    addCentres();
  }

  std::vector<std::string> write(const std::string&, const CarriedGeometry& carried,
                                 std::ostream& stream) const override {
    OutputBuffer out(stream);
    binary_ ? writeBinary(out, carried) : writeText(out, carried);
    return {};
  }

 private:
  void addTriangle(const Vec3& normal, const Vec3 (&corners)[3]) {
    requireCountable(file_, geometry.points.size() + 3, "corners");
    Corner at[3];
    for (int k = 0; k < 3; ++k) {
      at[k].point = static_cast<int>(geometry.points.size());
      if (!isFinite(corners[k]))
        throw FileError(file_.path, fmt::format("triangle {} is not finite (counted from 0)",
                                                geometry.elements.size()));
      geometry.points.push_back(corners[k]);
    }
    geometry.elements.add(Elements::Kind::face,
                          static_cast<std::uint32_t>(geometry.elements.size()), at, 3);
    geometry.directions[0].values.push_back(normal);
  }

  void addCentres() {
    geometry.ownPoints = geometry.points.size();
    requireCountable(file_, geometry.ownPoints / 3 * 4, "corners");
    for (std::size_t t = 0; t < geometry.elements.size(); ++t) {
      const Points& p = geometry.points;
      geometry.directions[0].points.push_back(static_cast<int>(p.size()));
      geometry.points.push_back((p[3 * t] + p[3 * t + 1] + p[3 * t + 2]) / 3.0);
    }
  }

  void readBinary(std::uint32_t count) {
    for (std::size_t t = 0; t < count; ++t) {
      if (t % 65536 == 0) throwIfCancelled();
      float numbers[12];
      std::memcpy(numbers, file_.bytes.data() + kHeader + kTriangle * t, sizeof numbers);
      Vec3 rows[4];
      for (int k = 0; k < 12; ++k) rows[k / 3][k % 3] = numbers[k];
      addTriangle(rows[0], {rows[1], rows[2], rows[3]});
    }
  }

  void readText() {
    TextLines lines(file_, false);
    std::size_t begin = 0, end = 0, corners = 0;
    bool within = false;
    Vec3 normal, at[3];
    std::string_view word;
    for (std::size_t n = 0; lines.next(begin, end); ++n) {
      if (n % 65536 == 0) throwIfCancelled();
      LineWords words(file_, begin, end, false);
      if (!words.next(word)) continue;
      if (equalsIgnoringCase(word, "facet")) {
        if (within) failAtLine(file_, lines.line(), "a facet begins within another");
        within = true;
        words.next(word);
        normal = three(words, lines.line());
        corners = 0;
      } else if (equalsIgnoringCase(word, "vertex")) {
        if (!within || corners >= 3)
          failAtLine(file_, lines.line(), "a corner stands outside a facet, or is its fourth");
        at[corners++] = three(words, lines.line());
      } else if (equalsIgnoringCase(word, "endfacet")) {
        if (!within || corners != 3)
          failAtLine(file_, lines.line(), "a facet has not three corners");
        within = false;
        addTriangle(normal, at);
      }
    }
    if (within)
      failAtLine(file_, lines.line(), "the last facet does not end; the file is cut short");
  }

  Vec3 three(LineWords& words, std::size_t line) const {
    Vec3 p;
    std::string_view word;
    for (int a = 0; a < 3; ++a) {
      if (!words.next(word)) failAtLine(file_, line, "the line ends before its three numbers");
      p[a] = numberOf(file_, line, word);
    }
    return p;
  }

  void writeBinary(OutputBuffer& out, const CarriedGeometry& carried) const {
    std::uint32_t count = 0;
    for (const std::uint8_t stays : carried.stays) count += stays;
    out.raw(std::string_view(file_.bytes).substr(0, 80));
    out.raw(std::string_view(reinterpret_cast<const char*>(&count), 4));
    for (std::size_t t = 0; t < carried.stays.size(); ++t) {
      if (!carried.stays[t]) continue;
      float numbers[12];
      for (std::size_t k = 0; k < 12; ++k) {
        const Vec3& row =
            k < 3 ? carried.directions[0][t] : carried.points.points[3 * t + k / 3 - 1];
        numbers[k] = static_cast<float>(row[static_cast<int>(k % 3)]);
      }
      out.raw(std::string_view(reinterpret_cast<const char*>(numbers), sizeof numbers));
      out.raw(std::string_view(file_.bytes).substr(kHeader + kTriangle * t + 48, 2));
    }
  }

  void writeText(OutputBuffer& out, const CarriedGeometry& carried) const {
    TextLines lines(file_, false);
    std::size_t begin = 0, end = 0, triangle = 0, corner = 0;
    std::string_view first, word;
    bool within = false;
    while (lines.next(begin, end)) {
      LineWords words(file_, begin, end, false);
      if (!words.next(first)) first = {};
      within = within || equalsIgnoringCase(first, "facet");
      const bool kept = !within || carried.stays[triangle];
      Vec3 value;
      const bool facet = equalsIgnoringCase(first, "facet"),
                 vertex = within && equalsIgnoringCase(first, "vertex");
      if (facet) value = carried.directions[0][triangle];
      if (vertex) value = carried.points.points[3 * triangle + corner++];
      if (kept && (facet || vertex)) {
        if (facet) words.next(word);
        out.raw(std::string_view(file_.bytes).substr(begin, words.position() - begin));
        out.print(" {} {} {}", value.x, value.y, value.z);
        for (int a = 0; a < 3; ++a) words.next(word);
        out.raw(std::string_view(file_.bytes).substr(words.position(), end - words.position()));
      } else if (kept) {
        out.raw(std::string_view(file_.bytes).substr(begin, end - begin));
      }
      if (!equalsIgnoringCase(first, "endfacet")) continue;
      within = false;
      corner = 0;
      ++triangle;
    }
  }

  FileBytes file_;
  bool binary_ = false;
};

}  // namespace

std::unique_ptr<GeometryFile> readStlGeometry(FileBytes file, const ReadGeometrySettings&) {
  return std::make_unique<StlGeometry>(std::move(file));
}

}  // namespace innermap
