// Gmsh's files, versions 4.1 and 2.2 (Geuzaine and Remacle, the Gmsh reference manual, "MSH file
// format").
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "core/text_scanner.h"
#include "io/cells/detail/cell_formats.h"
#include "io/cells/detail/msh_fields.h"

namespace innermap {
namespace {

struct MshCell {
  int type, corners;
  CellUse use;
  const char* name;
};

constexpr MshCell kMshCells[] = {
    {1, 2, CellUse::leftOut, "lines"},          {2, 3, CellUse::leftOut, "triangles"},
    {3, 4, CellUse::leftOut, "quadrilaterals"}, {4, 4, CellUse::tetrahedron, "tetrahedra"},
    {5, 8, CellUse::hexahedron, "hexahedra"},   {6, 6, CellUse::refused, "prisms"},
    {7, 5, CellUse::refused, "pyramids"},       {15, 1, CellUse::leftOut, "points"}};

class MshReader {
 public:
  explicit MshReader(const FileBytes& file)
      : file_(file), collector_(file.path), in_(file), fields_(collector_, in_) {}

  CellFile read() {
    readFormat();
    std::string_view section;
    while (in_.word(section)) {
      collector_.report(static_cast<double>(in_.position()) /
                        static_cast<double>(file_.bytes.size()));
      if (section.empty() || section[0] != '$')
        in_.fail(inQuotes(section) + " stands where a section should begin; export the file again");
      in_.endLine();
      readSection(section);
    }
    if (nodes_ == 0) in_.fail("has no nodes; the file is cut short or holds no mesh");
    fields_.finish(file_.path, nodeRows_, nodes_, std::move(tets_), std::move(hexes_));
    return collector_.finish();
  }

 private:
  void readFormat() {
    std::string_view word;
    if (!in_.word(word) || word != "$MeshFormat")
      in_.fail("a Gmsh file begins with $MeshFormat; give a .msh file of version 4.1 or 2.2");
    const std::string version(in_.nextWord());
    old_ = version.compare(0, 1, "2") == 0;
    if (!old_ && version != "4.1")
      in_.fail("is of version " + inQuotes(version) +
               "; save it as 4.1 (gmsh -save -format msh41)");
    const bool binary = in_.textInteger() == 1;
    if (in_.textInteger() != 8)
      in_.fail("numbers are not of eight bytes; save it on a 64-bit Gmsh");
    in_.endLine();
    if (binary) {
      in_.setBinary();
      if (in_.rawInteger() != 1)
        in_.fail("is written in another byte order; save it as text (gmsh -bin 0)");
    }
    expectEnd("$EndMeshFormat");
  }

  void expectEnd(const std::string& end) {
    const std::string_view word = in_.nextWord();
    if (word != end) in_.fail(inQuotes(word) + " stands where " + end + " should");
  }

  void readSection(std::string_view section) {
    if (section == "$Nodes")
      old_ ? readOldNodes() : readNodes();
    else if (section == "$Elements")
      old_ ? readOldElements() : readElements();
    else if (section == "$Entities" && !old_)
      readEntities();
    else if (section == "$NodeData" || section == "$ElementData")
      fields_.read(section == "$NodeData");
    else if (section == "$Comments" || section == "$PhysicalNames" || section == "$Periodic" ||
             section == "$PartitionedEntities" || section == "$GhostElements" ||
             section == "$Parametrizations" || section == "$ElementNodeData" ||
             section == "$InterpolationScheme") {
      collector_.note(fmt::format("{}: its section {} is left out", file_.path, section));
      return in_.skipSection(section);
    } else {
      in_.fail("the section " + inQuotes(section) + " is unknown; save the file as version 4.1");
    }
    expectEnd("$End" + std::string(section.substr(1)));
  }

  void readEntities() {
    std::int64_t counts[4];
    for (std::int64_t& count : counts) count = in_.size();
    for (int dimension = 0; dimension < 4; ++dimension) {
      in_.requireRoom(counts[dimension], dimension == 0 ? 5 : 9, dimension == 0 ? 36 : 68);
      for (std::int64_t i = 0; i < counts[dimension]; ++i) {
        const std::int64_t tag = in_.integer();
        for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) in_.real();
        const std::int64_t groups = in_.size();
        in_.requireRoom(groups, 1, 4);
        for (std::int64_t g = 0; g < groups; ++g) {
          const std::int64_t group = in_.integer();
          if (g == 0 && dimension == 3) physical_[tag] = group;
        }
        if (dimension == 0) continue;
        const std::int64_t bounds = in_.size();
        in_.requireRoom(bounds, 1, 4);
        for (std::int64_t b = 0; b < bounds; ++b) in_.integer();
      }
    }
  }

  void addNode(std::int64_t tag) {
    if (nodeRows_.contains(tag)) in_.fail(fmt::format("two nodes have the tag {}", tag));
    nodeRows_.add(tag, nodes_++);
  }

  void addPlace() {
    Vec3 p;
    for (int a = 0; a < 3; ++a) p[a] = in_.real();
    Points& vertices = collector_.file.mesh.vertices;
    collector_.poll(vertices.size());
    collector_.requireFinite(p, vertices.size());
    vertices.push_back(p);
  }

  void requireNoNodes() const {
    if (nodes_ > 0) in_.fail("there are two sections of nodes");
  }

  void readNodes() {
    requireNoNodes();
    const std::int64_t blocks = in_.size(), count = in_.size();
    in_.size();
    in_.size();
    in_.requireRoom(blocks, 4, 20);
    in_.requireRoom(count, 4, 32);
    collector_.requireCountable(static_cast<std::uint64_t>(count));
    for (std::int64_t b = 0; b < blocks; ++b) {
      const std::int64_t dimension = in_.integer();
      in_.integer();
      const bool parametric = in_.integer() != 0;
      const std::int64_t inBlock = in_.size();
      in_.requireRoom(inBlock, 4, 32);
      for (std::int64_t i = 0; i < inBlock; ++i) {
        collector_.poll(static_cast<std::uint64_t>(i));
        addNode(in_.size());
      }
      for (std::int64_t i = 0; i < inBlock; ++i) {
        addPlace();
        for (std::int64_t k = 0; parametric && k < std::min<std::int64_t>(dimension, 3); ++k)
          in_.real();
      }
    }
    requireCount(nodes_, count, "nodes");
  }

  void requireCount(std::int64_t got, std::int64_t said, const char* what) const {
    if (got != said)
      in_.fail(fmt::format("{} {} are there, the file says {}; export it again", got, what, said));
  }

  void readOldNodes() {
    requireNoNodes();
    const std::int64_t count = oldCount(4, 28);
    for (std::int64_t i = 0; i < count; ++i) {
      addNode(in_.integer());
      addPlace();
    }
  }

  // Of a section of version 2: text also in binary files.
  std::int64_t oldCount(int numbers, int bytes) {
    const std::int64_t count = in_.textInteger();
    in_.endLine();
    in_.requireRoom(count, numbers, bytes);
    collector_.requireCountable(static_cast<std::uint64_t>(count));
    return count;
  }

  const MshCell& cellOf(std::int64_t type) const {
    for (const MshCell& cell : kMshCells) {
      if (cell.type != type) continue;
      if (cell.use == CellUse::refused)
        in_.fail(
            fmt::format("has {} (Gmsh's type {}); only tetrahedra and hexahedra can be used: "
                        "split the others first",
                        cell.name, type));
      return cell;
    }
    in_.fail(
        fmt::format("has elements of Gmsh's type {}: cells of higher order are not read; save "
                    "a linear mesh (gmsh -order 1)",
                    type));
  }

  // The corners' tags come next.
  void readElement(const MshCell& cell, std::int64_t tag, std::int64_t entity,
                   std::int64_t physical) {
    std::int64_t corners[8];
    for (int k = 0; k < cell.corners; ++k) {
      const std::int64_t node = old_ ? in_.integer() : in_.size();
      corners[k] = nodeRows_.find(node);
      if (corners[k] < 0)
        in_.fail(fmt::format("element {} uses node {}, which the file has not; export it again",
                             tag, node));
    }
    collector_.addCell(cell.use, corners);
    if (cell.use == CellUse::leftOut) return collector_.leaveOut(cell.name);
    MshCellLists& lists = cell.use == CellUse::tetrahedron ? tets_ : hexes_;
    lists.tags.push_back(tag);
    lists.entities.push_back(static_cast<double>(entity));
    lists.groups.push_back(static_cast<double>(physical));
  }

  void readElements() {
    const std::int64_t blocks = in_.size(), count = in_.size();
    in_.size();
    in_.size();
    in_.requireRoom(blocks, 4, 20);
    in_.requireRoom(count, 2, 16);
    collector_.requireCountable(static_cast<std::uint64_t>(count));
    std::int64_t elements = 0;
    for (std::int64_t b = 0; b < blocks; ++b) {
      in_.integer();
      const std::int64_t entity = in_.integer();
      const MshCell& cell = cellOf(in_.integer());
      const std::int64_t inBlock = in_.size();
      in_.requireRoom(inBlock, cell.corners + 1, 8 * (cell.corners + 1));
      const auto group = physical_.find(entity);
      for (std::int64_t i = 0; i < inBlock; ++i, ++elements) {
        collector_.poll(static_cast<std::uint64_t>(i));
        const std::int64_t tag = in_.size();
        readElement(cell, tag, entity, group == physical_.end() ? 0 : group->second);
      }
    }
    requireCount(elements, count, "elements");
  }

  void readOldElements() {
    const std::int64_t count = oldCount(4, 8);
    for (std::int64_t i = 0; i < count;) {
      // Text: tag, type, number of labels. Binary: type, elements that follow, number of labels.
      const std::int64_t first = in_.integer(), second = in_.integer(), labels = in_.integer();
      const std::int64_t following = in_.binary() ? second : 1;
      const MshCell& cell = cellOf(in_.binary() ? first : second);
      in_.requireRoom(labels, 1, 4);
      if (following < 1 || following > count - i) in_.fail("a block of elements is too long");
      for (std::int64_t f = 0; f < following; ++f, ++i) {
        collector_.poll(static_cast<std::uint64_t>(i));
        const std::int64_t tag = in_.binary() ? in_.integer() : first;
        std::int64_t physical = 0, entity = 0;
        for (std::int64_t k = 0; k < labels; ++k) {
          const std::int64_t label = in_.integer();
          if (k == 0) physical = label;
          if (k == 1) entity = label;
        }
        readElement(cell, tag, entity, physical);
      }
    }
  }

  const FileBytes& file_;
  CellCollector collector_;
  MshCursor in_;
  bool old_ = false;
  std::int64_t nodes_ = 0;
  MshTags nodeRows_;
  std::map<std::int64_t, std::int64_t> physical_;  // of a volume's tag
  MshCellLists tets_, hexes_;
  MshFields fields_;
};

}  // namespace

CellFile readMsh(const FileBytes& file) { return MshReader(file).read(); }

}  // namespace innermap
