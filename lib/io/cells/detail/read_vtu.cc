// VTK's XML unstructured grids (kitware, "VTK XML Formats", docs.vtk.org).
#include <fmt/format.h>

#include <charconv>
#include <map>

#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "io/cells/detail/cell_formats.h"
#include "io/cells/detail/vtu_arrays.h"
#include "io/cells/detail/xml_tags.h"

namespace innermap {
namespace {

struct VtkCell {
  int type;
  int corners;  // -1: any number
  CellUse use;
  const char* name;
};

constexpr VtkCell kVtkCells[] = {
    {0, 0, CellUse::leftOut, "empty cells"},      {1, 1, CellUse::leftOut, "points"},
    {2, -1, CellUse::leftOut, "sets of points"},  {3, 2, CellUse::leftOut, "lines"},
    {4, -1, CellUse::leftOut, "curves"},          {5, 3, CellUse::leftOut, "triangles"},
    {6, -1, CellUse::leftOut, "triangle strips"}, {7, -1, CellUse::leftOut, "polygons"},
    {8, 4, CellUse::leftOut, "pixels"},           {9, 4, CellUse::leftOut, "quadrilaterals"},
    {10, 4, CellUse::tetrahedron, "tetrahedra"},  {12, 8, CellUse::hexahedron, "hexahedra"},
    {11, 8, CellUse::refused, "voxels"},          {13, 6, CellUse::refused, "wedges"},
    {14, 5, CellUse::refused, "pyramids"},        {42, -1, CellUse::refused, "polyhedra"}};

class VtuReader {
 public:
  explicit VtuReader(const FileBytes& file) : file_(file), collector_(file.path) {}

  CellFile read() {
    readTags();
    if (pieces_ != 1)
      fail(fmt::format("has {} pieces; merge them into one (ParaView: Clean to Grid)", pieces_));
    collector_.report(0.2);
    readPoints();
    collector_.report(0.4);
    readCells();
    collector_.report(0.6);
    for (const VtuArray& array : pointArrays_)
      readField(array, points_, nullptr, collector_.file.mesh.vertexFields);
    for (const VtuArray& array : cellArrays_)
      readField(array, cells_, &keptCells_, collector_.file.mesh.cellFields);
    return collector_.finish();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw FileError(file_.path, what); }

  std::uint64_t count(const XmlTag& tag, const char* name, std::uint64_t missing) const {
    const std::string text = tag.attribute(name);
    if (text.empty()) return missing;
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      failAt(file_, tag.begin, std::string(name) + " is " + inQuotes(text) + ", no number");
    return value;
  }

  void readTags() {
    XmlTags tags(file_);
    XmlTag tag;
    bool grid = false;
    std::string within;  // PointData, CellData, Points, Cells
    while (tags.next(tag)) {
      if (tag.name == "VTKFile") {
        if (!tag.closing) readFileTag(tag);
        grid = true;
      } else if (!grid) {
        break;
      } else if (tag.name == "Piece" && !tag.closing) {
        ++pieces_;
        points_ = count(tag, "NumberOfPoints", 0);
        cells_ = count(tag, "NumberOfCells", 0);
      } else if (tag.name == "AppendedData" && !tag.closing) {
        readAppended(tag);
        break;
      } else if (tag.name == "DataArray" && !tag.closing) {
        readArrayTag(tag, within, tags);
      } else if (tag.name == "PointData" || tag.name == "CellData" || tag.name == "Points" ||
                 tag.name == "Cells" || tag.name == "FieldData") {
        within = tag.closing || tag.complete ? "" : std::string(tag.name);
        if (!tag.closing) active_ = {tag.attribute("Vectors"), tag.attribute("Normals")};
        if (within == "FieldData") collector_.note(file_.path + ": its FieldData is left out");
      }
    }
    if (!grid) fail("is no VTK XML file; give a .vtu file");
  }

  void readFileTag(const XmlTag& tag) {
    if (tag.attribute("type") != "UnstructuredGrid")
      fail("holds " + inQuotes(tag.attribute("type")) +
           "; a file of cells has the type 'UnstructuredGrid'");
    encoding_.bigEndian = tag.attribute("byte_order") == "BigEndian";
    encoding_.longHeader = tag.attribute("header_type") == "UInt64";
    const std::string compressor = tag.attribute("compressor");
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      fail("is compressed by " + inQuotes(compressor) +
           ", which is not read; write it with zlib or without compression");
    encoding_.compressed = !compressor.empty();
  }

  void readAppended(const XmlTag& tag) {
    const std::size_t start = file_.bytes.find('_', tag.end);
    if (start == file_.bytes.npos) fail("its AppendedData has no '_'; export the file again");
    encoding_.appended = start + 1;
    encoding_.appendedRaw = tag.attribute("encoding") == "raw";
    encoding_.appendedEnd = file_.bytes.size();
    // What follows base64 stops it by itself.
  }

  void readArrayTag(const XmlTag& tag, const std::string& within, XmlTags& tags) {
    VtuArray array;
    array.name = tag.attribute("Name");
    array.type = tag.attribute("type");
    array.format = tag.attribute("format");
    if (array.format.empty()) array.format = "ascii";
    array.kind = tag.attribute("Kind");
    if (array.kind.empty() && !array.name.empty())
      array.kind = array.name == active_.first    ? "vector"
                   : array.name == active_.second ? "normal"
                                                  : "";
    const std::uint64_t components = count(tag, "NumberOfComponents", 1);
    if (components < 1 || components > 1000)
      failAt(file_, tag.begin, fmt::format("{} has {} components", array.label(), components));
    array.components = static_cast<int>(components);
    array.offset = count(tag, "offset", 0);
    array.begin = array.end = tag.end;
    if (!tag.complete) {
      // Arrays may have an InformationKey behind their text.
      array.end = std::min(file_.bytes.find('<', tag.end), file_.bytes.size());
      const std::size_t close = file_.bytes.find("</DataArray", tag.end);
      if (close == file_.bytes.npos)
        failAt(file_, tag.begin, array.label() + " does not end; the file is cut short");
      tags.skipTo(close);
    }
    if (within == "PointData") pointArrays_.push_back(array);
    if (within == "CellData") cellArrays_.push_back(array);
    if (within == "Points") places_.push_back(array);
    if (within == "Cells") topology_[array.name] = array;
  }

  void readPoints() {
    if (places_.size() != 1 || places_[0].components != 3)
      fail("its Points are not one array of three components");
    collector_.requireCountable(points_);
    places_[0].name = "Points";
    const std::vector<double> numbers =
        vtuReals(file_, encoding_, places_[0], 3 * points_, collector_);
    Points& vertices = collector_.file.mesh.vertices;
    vertices.resize(points_);
    for (std::size_t i = 0; i < points_; ++i) {
      collector_.poll(i);
      vertices[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
      collector_.requireFinite(vertices[i], i);
    }
  }

  const VtuArray& topology(const std::string& name) const {
    const auto found = topology_.find(name);
    if (found == topology_.end()) fail("its Cells have no array '" + name + "'");
    return found->second;
  }

  CellUse useOf(std::int64_t type, std::int64_t corners, std::uint64_t cell) {
    for (const VtkCell& known : kVtkCells) {
      if (type != known.type) continue;
      if (known.use == CellUse::refused)
        fail(
            fmt::format("cell {} is one of its {} (VTK type {}); only tetrahedra and hexahedra "
                        "can be used: split the others first (ParaView: Tetrahedralize)",
                        cell, known.name, type));
      if (known.corners >= 0 && corners != known.corners)
        fail(fmt::format("cell {} has {} corners, VTK's type {} has {}", cell, corners, type,
                         known.corners));
      if (known.use == CellUse::leftOut) collector_.leaveOut(known.name);
      return known.use;
    }
    fail(
        fmt::format("cell {} has VTK's type {}: cells of higher order are not read; save a linear "
                    "mesh (ParaView: Tetrahedralize)",
                    cell, type));
  }

  void readCells() {
    collector_.requireCountable(cells_);
    const auto types = vtuIntegers(file_, encoding_, topology("types"), cells_, collector_);
    const auto offsets = vtuIntegers(file_, encoding_, topology("offsets"), cells_, collector_);
    const auto corners = vtuIntegers(file_, encoding_, topology("connectivity"), collector_);
    std::vector<std::uint64_t> hexahedra;
    for (std::uint64_t c = 0; c < cells_; ++c) {
      collector_.poll(c);
      const std::int64_t begin = c == 0 ? 0 : offsets[c - 1], end = offsets[c];
      if (begin > end || end > static_cast<std::int64_t>(corners.size()) || begin < 0)
        fail(fmt::format("cell {} ends at corner {} of {}; export the file again", c, end,
                         corners.size()));
      const CellUse use = useOf(types[c], end - begin, c);
      collector_.addCell(use, corners.data() + begin);
      if (use == CellUse::tetrahedron) keptCells_.push_back(c);
      if (use == CellUse::hexahedron) hexahedra.push_back(c);
    }
    keptCells_.insert(keptCells_.end(), hexahedra.begin(), hexahedra.end());
  }

  // rows: those kept, or null for all.
  void readField(const VtuArray& array, std::uint64_t count, const std::vector<std::uint64_t>* rows,
                 std::vector<CellField>& fields) {
    if (!isNumberType(array))
      return collector_.note(
          fmt::format("{}: {} of type {} is left out", file_.path, array.label(), array.type));
    CellField field;
    field.name = array.name;
    field.components = array.components;
    field.whole = isWholeType(array);
    if (array.components == 3 && array.kind == "vector") field.kind = CellField::Kind::vector;
    if (array.components == 3 && array.kind == "normal") field.kind = CellField::Kind::normal;
    const auto width = static_cast<std::uint64_t>(array.components);
    field.values = vtuReals(file_, encoding_, array, count * width, collector_);
    if (rows) {
      std::vector<double> kept;
      kept.reserve(rows->size() * width);
      for (const std::uint64_t row : *rows)
        for (std::uint64_t k = 0; k < width; ++k) kept.push_back(field.values[row * width + k]);
      field.values = std::move(kept);
    }
    fields.push_back(std::move(field));
  }

  const FileBytes& file_;
  CellCollector collector_;
  VtuEncoding encoding_;
  int pieces_ = 0;
  std::uint64_t points_ = 0, cells_ = 0;
  std::pair<std::string, std::string> active_;  // names of vectors and normals
  std::vector<VtuArray> pointArrays_, cellArrays_, places_;
  std::map<std::string, VtuArray> topology_;
  std::vector<std::uint64_t> keptCells_;  // of the file: tetrahedra, then hexahedra
};

}  // namespace

CellFile readVtu(const FileBytes& file) { return VtuReader(file).read(); }

}  // namespace innermap
