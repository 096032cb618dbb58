// The formats behind io/cell_file.h.
#pragma once

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "core/file_bytes.h"
#include "innermap/core/run.h"
#include "innermap/io/cell_file.h"

namespace innermap {

// Corners of the linear cells, by what becomes of them.
enum class CellUse { tetrahedron, hexahedron, leftOut, refused };

// What the readers fill; tells of what is left out at the end.
class CellCollector {
 public:
  explicit CellCollector(const std::string& path) : path_(path) { file.mesh.name = path; }

  CellFile file;

  // Throws MemoryError when `bytes` more than what was claimed so far are over the limit.
  void claim(std::uint64_t bytes);
  // For loops over items: polls for cancelling now and then.
  void poll(std::uint64_t index) const {
    if (index % 65536 == 0) throwIfCancelled();
  }
  void report(double fraction) const { reportProgress("reading cells", fraction); }
  void leaveOut(const std::string& kind, std::uint64_t count = 1) { leftOut_[kind] += count; }
  void note(const std::string& text) { file.notes.push_back(text); }
  void requireCountable(std::uint64_t count) const { innermap::requireCountable(path_, count); }
  void requireFinite(const Vec3& p, std::uint64_t index) const;
  // Corners counted from 0.
  void addCell(CellUse use, const std::int64_t* corners);

  // Checks that there are cells and that all is right; adds notes of what was left out.
  CellFile finish();

 private:
  [[noreturn]] void fail(const std::string& what) const;

  const std::string& path_;
  std::map<std::string, std::uint64_t> leftOut_;
  std::uint64_t claimed_ = 0;
};

CellFile readVtu(const FileBytes& file);
CellFile readMsh(const FileBytes& file);
CellFile readMedit(const FileBytes& file);

using LostFields = std::vector<std::string>;
// By the path's ending, which is one of the three.
LostFields writeCellsTo(const std::string& path, const CellMesh& mesh, std::ostream& stream);
LostFields writeVtu(std::ostream& stream, const CellMesh& mesh);
LostFields writeMsh(std::ostream& stream, const CellMesh& mesh);
LostFields writeMedit(std::ostream& stream, const CellMesh& mesh);

// The names that meshio gives them.
inline constexpr char kMeditReference[] = "medit:ref";
inline constexpr char kGmshPhysical[] = "gmsh:physical";
inline constexpr char kGmshGeometrical[] = "gmsh:geometrical";

// The field of that name with one component, or null.
const CellField* findField(const std::vector<CellField>& fields, std::string_view name);

}  // namespace innermap
