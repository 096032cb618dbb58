#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/file.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/io/cell_file.h"
#include "io/cells/detail/cell_formats.h"
#include "io/cells/detail/hanging_vertices.h"

namespace innermap {
namespace {

struct Format {
  const char* extension;
  CellFile (*read)(const FileBytes&);
  LostFields (*write)(std::ostream&, const CellMesh&);
};

constexpr Format kFormats[] = {
    {".vtu", readVtu, writeVtu}, {".msh", readMsh, writeMsh}, {".mesh", readMedit, writeMedit}};

const Format* findFormat(const std::string& path) {
  for (const Format& format : kFormats)
    if (equalsIgnoringCase(extensionOf(path), format.extension)) return &format;
  return nullptr;
}

const Format& formatOf(const std::string& path) {
  if (const Format* format = findFormat(path)) return *format;
  throw FileError(path,
                  "tetrahedra and hexahedra are kept in .vtu, .msh (Gmsh) and .mesh (MEDIT) "
                  "files; give one of these extensions");
}

}  // namespace

void CellCollector::fail(const std::string& what) const { throw FileError(path_, what); }

void CellCollector::claim(std::uint64_t bytes) {
  claimed_ += bytes;
  const std::uint64_t limit = std::min(memoryLimit(), availableMemory());
  requireMemory("reading " + path_, claimed_, limit, "use a smaller file");
}

void CellCollector::requireFinite(const Vec3& p, std::uint64_t index) const {
  if (!isFinite(p))
    fail(fmt::format("vertex {} is not finite (counted from 0); export the mesh again", index));
}

void CellCollector::addCell(CellUse use, const std::int64_t* corners) {
  const auto count = static_cast<std::int64_t>(file.mesh.vertices.size());
  const auto add = [&](auto& cells, auto cell) {
    for (std::size_t k = 0; k < cell.size(); ++k) {
      if (corners[k] < 0 || corners[k] >= count)
        fail(
            fmt::format("a cell uses vertex {}, the file has {} (counted from 0); export the mesh "
                        "again",
                        corners[k], count));
      cell[k] = static_cast<int>(corners[k]);
    }
    cells.push_back(cell);
  };
  if (use == CellUse::tetrahedron) add(file.mesh.tetrahedra, Tetrahedron{});
  if (use == CellUse::hexahedron) add(file.mesh.hexahedra, Hexahedron{});
}

CellFile CellCollector::finish() {
  if (file.mesh.tetrahedra.empty() && file.mesh.hexahedra.empty())
    fail("has no tetrahedra and no hexahedra" +
         std::string(leftOut_.empty() ? "" : ", only " + leftOut_.begin()->first) +
         "; give a mesh of a solid's inside");
  validate(file.mesh);
  if (const std::uint64_t hanging = countHangingVertices(file.mesh))
    note(fmt::format(
        "{}: {} vertices hang in the middle of edges or faces of other cells; the cells "
        "do not fit together there",
        path_, hanging));
  for (const auto& [kind, count] : leftOut_)
    note(fmt::format("{}: {} {} left out", path_, count, kind));
  report(1);
  return std::move(file);
}

const CellField* findField(const std::vector<CellField>& fields, std::string_view name) {
  for (const CellField& field : fields)
    if (field.name == name && field.components == 1) return &field;
  return nullptr;
}

bool isCellFile(const std::string& path) { return findFormat(path) != nullptr; }

CellFile readCells(const std::string& path) {
  const Format& format = formatOf(path);
  const std::uint64_t limit = std::min(memoryLimit(), availableMemory());
  requireMemory("reading " + path, readCellsMemory(path), limit, "use a smaller file");
  return format.read(readFileBytes(path, "a file of cells"));
}

std::uint64_t readCellsMemory(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw FileError(path, "cannot be read (" + error.message() + "); check the name");
  // The bytes, what they hold (base64 takes 4/3, text about twice), an array on its way.
  return size + size + size / 2;
}

std::vector<std::string> writeCells(const std::string& path, const CellMesh& mesh) {
  formatOf(path);
  validate(mesh);
  LostFields lost;
  writeWholeFile(path, [&](std::ostream& stream) { lost = writeCellsTo(path, mesh, stream); });
  return lost;
}

LostFields writeCellsTo(const std::string& path, const CellMesh& mesh, std::ostream& stream) {
  return formatOf(path).write(stream, mesh);
}

}  // namespace innermap
