#include "innermap/field/field_file.h"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include "core/file.h"
#include "innermap/core/error.h"

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the file is little endian");

namespace innermap {
namespace {

// And a number: 1 for a field, 2 for several, one after the other.
constexpr std::string_view kFormatLine = "comment innermap field ";

constexpr std::size_t kLongestHeader = 1 << 20;
constexpr std::size_t kMostChannels = 4096, kMostSteps = 4096;
constexpr std::size_t kFaceBytes = 1 + 3 * sizeof(std::int32_t);

std::string coefficients(const Affine& affine, std::size_t channel) {
  const Matrix& c = affine.coefficients;
  return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}", c(0, channel), c(1, channel), c(2, channel),
                     c(3, channel));
}

void writeAffine(std::ostream& out, const HarmonicField& field) {
  const Affine& affine = field.affine();
  out << fmt::format("comment affine_center {:.17g} {:.17g} {:.17g}\n", affine.center.x,
                     affine.center.y, affine.center.z);
  for (std::size_t k = 0; k < field.channels(); ++k)
    out << "comment affine_" << k << ' ' << coefficients(affine, k) << '\n';
}

void writeHeader(std::ostream& out, const FieldFile& file) {
  const bool several = file.steps.size() > 1;
  out << "ply\nformat binary_little_endian 1.0\n" << kFormatLine << (several ? 2 : 1) << '\n';
  std::size_t sources = 0;
  std::string counts;
  for (const HarmonicField& step : file.steps) {
    writeAffine(out, step);
    sources += step.sources().size();
    counts += fmt::format(" {}", step.sources().size());
  }
  if (several) out << "comment step_sources" << counts << '\n';
  for (const auto& [key, value] : file.facts) out << "comment " << key << ' ' << value << '\n';
  out << "element vertex " << sources
      << "\nproperty double x\nproperty double y\nproperty double z\n";
  for (std::size_t k = 0; k < file.steps.front().channels(); ++k)
    out << "property double w" << k << '\n';
  out << "element boundary_vertex " << file.boundary.size() << '\n';
  for (const char* name : {"x", "y", "z", "tx", "ty", "tz"})
    out << "property double " << name << '\n';
  out << "element boundary_face " << file.boundaryTriangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
}

void put(std::ostream& out, const void* data, std::size_t size) {
  out.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

void putCharges(std::ostream& out, const HarmonicField& field) {
  const Matrix& w = field.weights();
  std::vector<double> row(3 + w.columns());
  for (std::size_t j = 0; j < w.rows(); ++j) {
    for (int a = 0; a < 3; ++a) row[a] = field.sources()[j][a];
    for (std::size_t k = 0; k < w.columns(); ++k) row[3 + k] = w(j, k);
    put(out, row.data(), row.size() * sizeof(double));
  }
}

void checkFacts(const Facts& facts) {
  for (const auto& [key, value] : facts)
    if (key.empty() ||
        key.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") != std::string::npos ||
        value.find_first_of("\r\n") != std::string::npos)
      throw DataError("field file: setting '" + key + "' cannot stand on one comment line");
}

struct AffineRows {
  Vec3 center;
  std::vector<std::array<double, 4>> rows;  // a channel each
};

struct Header {
  std::vector<AffineRows> affine;          // of each step
  std::vector<std::uint64_t> stepSources;  // of each step; empty: all are the only one's
  Facts facts;
  std::uint64_t sources = 0, vertices = 0, faces = 0;
  std::size_t channels = 0;
};

class HeaderReader {
 public:
  HeaderReader(const std::string& path, std::istream& in) : path_(path), in_(in) {}

  Header read() {
    expect("ply");
    expect("format binary_little_endian 1.0");
    checkFormat(next());
    std::string line = next();
    for (; line.rfind("comment ", 0) == 0; line = next()) comment(line.substr(8));
    header_.sources = count(line, "element vertex ");
    for (const char* name : {"x", "y", "z"}) expect(std::string("property double ") + name);
    for (line = next(); line == "property double w" + std::to_string(header_.channels);
         line = next())
      if (++header_.channels > kMostChannels) fail("has too many channels");
    header_.vertices = count(line, "element boundary_vertex ");
    for (const char* name : {"x", "y", "z", "tx", "ty", "tz"})
      expect(std::string("property double ") + name);
    header_.faces = count(next(), "element boundary_face ");
    expect("property list uchar int vertex_indices");
    expect("end_header");
    checkSteps();
    return header_;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw FileError(path_, "is not an innermap field (" + what +
                               "); give a map.ply written by innermap fit or map");
  }

 private:
  std::string next() {
    std::string line;
    if (!std::getline(in_, line)) fail("the header ends early");
    used_ += line.size() + 1;
    if (used_ > kLongestHeader) fail("the header is too long");
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
  }

  void checkFormat(const std::string& line) const {
    const std::string number =
        line.rfind(kFormatLine, 0) == 0 ? line.substr(kFormatLine.size()) : "";
    if (number == "1" || number == "2") return;
    if (!number.empty() && number.size() < 6 &&
        number.find_first_not_of("0123456789") == std::string::npos && number[0] != '0')
      throw FileError(path_, "is of format " + number +
                                 ", which a newer innermap wrote; this one reads formats 1 and 2: "
                                 "update innermap, or write the map again");
    fail("expected '" + std::string(kFormatLine) + "1' or 2");
  }

  void expect(const std::string& wanted) {
    const std::string line = next();
    if (line != wanted) fail("expected '" + wanted + "'");
  }

  std::uint64_t count(const std::string& line, const std::string& prefix) const {
    const std::string digits = line.rfind(prefix, 0) == 0 ? line.substr(prefix.size()) : "";
    if (digits.empty() || digits.size() > 12 ||
        digits.find_first_not_of("0123456789") != std::string::npos)
      fail("expected '" + prefix + "N'");
    return std::stoull(digits);
  }

  void checkSteps() {
    if (header_.channels == 0 || header_.affine.empty())
      fail("lacks its weights or its affine part");
    for (const AffineRows& affine : header_.affine)
      if (affine.rows.size() != header_.channels) fail("lacks its weights or its affine part");
    if (header_.stepSources.empty()) header_.stepSources = {header_.sources};
    std::uint64_t sum = 0;
    for (const std::uint64_t n : header_.stepSources) {
      if (n > header_.sources - sum) fail("its steps do not add up");
      sum += n;
    }
    if (sum != header_.sources || header_.stepSources.size() != header_.affine.size())
      fail("its steps do not add up");
  }

  void comment(const std::string& text) {
    const std::size_t space = text.find(' ');
    const std::string key = text.substr(0, space);
    const std::string value = space == std::string::npos ? "" : text.substr(space + 1);
    std::istringstream numbers(value);
    numbers.imbue(std::locale::classic());
    if (key == "affine_center") {
      if (header_.affine.size() >= kMostSteps) fail("has too many steps");
      Vec3& c = header_.affine.emplace_back().center;
      if (!(numbers >> c.x >> c.y >> c.z)) fail("bad affine_center");
    } else if (!header_.affine.empty() &&
               key == "affine_" + std::to_string(header_.affine.back().rows.size())) {
      std::array<double, 4> row{};
      if (!(numbers >> row[0] >> row[1] >> row[2] >> row[3])) fail("bad " + key);
      if (header_.affine.back().rows.size() >= kMostChannels) fail("has too many channels");
      header_.affine.back().rows.push_back(row);
    } else if (key == "step_sources") {
      for (std::uint64_t n = 0; header_.stepSources.size() < kMostSteps && numbers >> n;)
        header_.stepSources.push_back(n);
    } else {
      header_.facts.emplace_back(key, value);
    }
  }

  const std::string& path_;
  std::istream& in_;
  Header header_;
  std::size_t used_ = 0;
};

template <class T>
std::vector<T> take(const HeaderReader& reader, std::istream& in, std::size_t count) {
  std::vector<T> data(count);
  in.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(count * sizeof(T)));
  if (!in) reader.fail("the data end early");
  return data;
}

HarmonicField readStep(const HeaderReader& reader, std::istream& in, const Header& header,
                       std::size_t step) {
  const std::uint64_t count = header.stepSources[step];
  Matrix weights(count, header.channels);
  Points sources(count);
  const std::vector<double> rows = take<double>(reader, in, count * (3 + header.channels));
  for (std::size_t j = 0; j < count; ++j) {
    const double* row = rows.data() + j * (3 + header.channels);
    sources[j] = {row[0], row[1], row[2]};
    for (std::size_t k = 0; k < header.channels; ++k) weights(j, k) = row[3 + k];
  }
  Affine affine;
  affine.center = header.affine[step].center;
  affine.coefficients = Matrix(4, header.channels);
  for (std::size_t k = 0; k < header.channels; ++k)
    for (std::size_t r = 0; r < 4; ++r) affine.coefficients(r, k) = header.affine[step].rows[k][r];
  return HarmonicField(std::move(sources), std::move(weights), std::move(affine));
}

void readBoundary(const HeaderReader& reader, std::istream& in, const Header& header,
                  FieldFile& out) {
  const std::vector<double> corners = take<double>(reader, in, 6 * header.vertices);
  for (std::size_t i = 0; i < header.vertices; ++i) {
    const double* c = corners.data() + 6 * i;
    out.boundary.push_back({c[0], c[1], c[2]});
    out.boundaryTarget.push_back({c[3], c[4], c[5]});
  }
  const std::vector<char> faces = take<char>(reader, in, kFaceBytes * header.faces);
  for (std::size_t t = 0; t < header.faces; ++t) {
    const char* face = faces.data() + kFaceBytes * t;
    std::int32_t indices[3];
    std::memcpy(indices, face + 1, sizeof indices);
    for (const std::int32_t i : indices)
      if (face[0] != 3 || i < 0 || static_cast<std::uint64_t>(i) >= header.vertices)
        reader.fail("boundary face " + std::to_string(t) + " is out of range");
    out.boundaryTriangles.push_back({indices[0], indices[1], indices[2]});
  }
}

}  // namespace

void writeField(const std::string& path, const FieldFile& file) {
  checkFacts(file.facts);
  if (file.boundary.size() != file.boundaryTarget.size())
    throw DataError("field file: boundary and target have different numbers of vertices");
  if (file.steps.empty()) throw DataError("field file: has no field");
  for (const HarmonicField& step : file.steps)
    if (step.channels() != file.steps.front().channels())
      throw DataError("field file: its steps have different numbers of channels");
  writeWholeFile(path, [&](std::ostream& out) {
    writeHeader(out, file);
    for (const HarmonicField& step : file.steps) putCharges(out, step);
    for (std::size_t i = 0; i < file.boundary.size(); ++i) {
      const Vec3 &p = file.boundary[i], &t = file.boundaryTarget[i];
      const double both[6] = {p.x, p.y, p.z, t.x, t.y, t.z};
      put(out, both, sizeof both);
    }
    for (const auto& triangle : file.boundaryTriangles) {
      const unsigned char corners = 3;
      const std::int32_t indices[3] = {triangle[0], triangle[1], triangle[2]};
      put(out, &corners, 1);
      put(out, indices, sizeof indices);
    }
  });
}

bool isFieldFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string wanted = "ply\nformat binary_little_endian 1.0\ncomment innermap field";
  std::string start(wanted.size(), '\0');
  return in.read(start.data(), static_cast<std::streamsize>(start.size())) && start == wanted;
}

FieldFile readField(const std::string& path) {
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) throw FileError(path, "cannot be read; check that the file exists");
  HeaderReader reader(path, in);
  const Header header = reader.read();
  const std::uint64_t start = static_cast<std::uint64_t>(in.tellg());
  const std::uint64_t need = header.sources * (3 + header.channels) * sizeof(double) +
                             header.vertices * 6 * sizeof(double) + header.faces * kFaceBytes;
  if (start + need != size)
    reader.fail(
        fmt::format("the header promises {} bytes of data, the file has {}", need, size - start));
  try {
    FieldFile out;
    for (std::size_t step = 0; step < header.affine.size(); ++step)
      out.steps.push_back(readStep(reader, in, header, step));
    out.facts = header.facts;
    readBoundary(reader, in, header, out);
    return out;
  } catch (const DataError& bad) {
    reader.fail(bad.what());
  }
}

}  // namespace innermap
