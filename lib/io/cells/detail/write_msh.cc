// Gmsh 4.1, binary.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "io/cells/detail/cell_formats.h"

namespace innermap {
namespace {

class BinaryWriter {
 public:
  explicit BinaryWriter(std::ostream& stream) : stream_(stream) {}
  ~BinaryWriter() { flush(); }

  void text(const std::string& text) { bytes_ += text; }
  void integer(std::int64_t value) { add(static_cast<std::int32_t>(value)); }
  void size(std::uint64_t value) { add(value); }
  void real(double value) { add(value); }

 private:
  template <class T>
  void add(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes_.append(raw, sizeof(T));
    if (bytes_.size() > (1u << 20)) flush();
  }
  void flush() {
    stream_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    bytes_.clear();
  }

  std::ostream& stream_;
  std::string bytes_;
};

// Cells of one volume: what Gmsh calls an entity.
struct Volume {
  std::int64_t physical = 0;  // 0: in no group
  std::vector<std::size_t> tets, hexes;
};

std::map<std::int64_t, Volume> volumesOf(const CellMesh& mesh) {
  const CellField* physical = findField(mesh.cellFields, kGmshPhysical);
  const CellField* geometrical = findField(mesh.cellFields, kGmshGeometrical);
  const auto label = [](const CellField* field, std::size_t c) -> std::int64_t {
    const double value = field ? field->values[c] : 0;
    return std::abs(value) < 2e9 ? std::llround(value) : 0;
  };
  // A volume is in one group: a tag whose cells are in several gets a tag for each of the others.
  std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> tagOf;
  std::map<std::int64_t, Volume> volumes;
  std::int64_t next = 1;
  const std::size_t tets = mesh.tetrahedra.size(), cells = tets + mesh.hexahedra.size();
  for (std::size_t c = 0; geometrical && c < cells; ++c)
    next = std::max(next, label(geometrical, c) + 1);
  for (std::size_t c = 0; c < cells; ++c) {
    const std::pair<std::int64_t, std::int64_t> key{label(geometrical, c), label(physical, c)};
    const auto [found, isNew] = tagOf.try_emplace(key, 0);
    if (isNew) {
      const bool free = geometrical && key.first > 0 && volumes.count(key.first) == 0;
      found->second = free ? key.first : next++;
      volumes[found->second].physical = key.second;
    }
    Volume& volume = volumes[found->second];
    (c < tets ? volume.tets : volume.hexes).push_back(c);
  }
  return volumes;
}

void writeEntities(BinaryWriter& out, const std::map<std::int64_t, Volume>& volumes,
                   const Box3& box) {
  out.text("$Entities\n");
  for (int dimension = 0; dimension < 3; ++dimension) out.size(0);
  out.size(volumes.size());
  for (const auto& [tag, volume] : volumes) {
    out.integer(tag);
    for (int a = 0; a < 3; ++a) out.real(box.lower[a]);
    for (int a = 0; a < 3; ++a) out.real(box.upper[a]);
    out.size(volume.physical != 0);
    if (volume.physical != 0) out.integer(volume.physical);
    out.size(0);
  }
  out.text("\n$EndEntities\n");
}

void writeNodes(BinaryWriter& out, const Points& vertices, std::int64_t entity) {
  out.text("$Nodes\n");
  out.size(1);
  out.size(vertices.size());
  out.size(1);
  out.size(vertices.size());
  out.integer(3);
  out.integer(entity);
  out.integer(0);
  out.size(vertices.size());
  for (std::size_t v = 1; v <= vertices.size(); ++v) out.size(v);
  for (const Vec3& p : vertices)
    for (int a = 0; a < 3; ++a) out.real(p[a]);
  out.text("\n$EndNodes\n");
}

template <class Cells>
void writeBlock(BinaryWriter& out, std::int64_t entity, int type, const Cells& cells,
                const std::vector<std::size_t>& rows, std::size_t firstRow) {
  if (rows.empty()) return;
  out.integer(3);
  out.integer(entity);
  out.integer(type);
  out.size(rows.size());
  for (const std::size_t row : rows) {
    out.size(row + 1);
    for (const int v : cells[row - firstRow]) out.size(static_cast<std::uint64_t>(v) + 1);
  }
}

void writeElements(BinaryWriter& out, const CellMesh& mesh,
                   const std::map<std::int64_t, Volume>& volumes) {
  const std::size_t tets = mesh.tetrahedra.size(), cells = tets + mesh.hexahedra.size();
  std::size_t blocks = 0;
  for (const auto& [tag, volume] : volumes) blocks += !volume.tets.empty() + !volume.hexes.empty();
  out.text("$Elements\n");
  out.size(blocks);
  out.size(cells);
  out.size(1);
  out.size(cells);
  for (const auto& [tag, volume] : volumes) {
    writeBlock(out, tag, 4, mesh.tetrahedra, volume.tets, 0);
    writeBlock(out, tag, 5, mesh.hexahedra, volume.hexes, tets);
  }
  out.text("\n$EndElements\n");
}

// Gmsh knows scalars, vectors and tensors: 1, 3 and 9 components. 0: too many.
int componentsOf(const CellField& field) {
  for (const int known : {1, 3, 9})
    if (field.components <= known) return known;
  return 0;
}

void writeField(BinaryWriter& out, const char* section, const CellField& field) {
  const auto width = static_cast<std::size_t>(field.components);
  const int components = componentsOf(field);
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row * width < field.values.size(); ++row)
    if (!std::all_of(&field.values[row * width], &field.values[row * width] + width,
                     [](double value) { return std::isnan(value); }))
      rows.push_back(row);
  std::string name = field.name;
  std::replace(name.begin(), name.end(), '"', '\'');
  out.text(
      fmt::format("${}\n1\n\"{}\"\n1\n0\n3\n0\n{}\n{}\n", section, name, components, rows.size()));
  for (const std::size_t row : rows) {
    out.integer(static_cast<std::int64_t>(row) + 1);
    for (std::size_t k = 0; k < static_cast<std::size_t>(components); ++k)
      out.real(k < width ? field.values[row * width + k] : 0.0);
  }
  out.text(fmt::format("\n$End{}\n", section));
}

void writeFields(BinaryWriter& out, const char* section, const std::vector<CellField>& fields,
                 LostFields& lost) {
  for (const CellField& field : fields) {
    if (field.name == kGmshPhysical || field.name == kGmshGeometrical) continue;
    if (componentsOf(field) == 0)
      lost.push_back(field.name);
    else
      writeField(out, section, field);
  }
}

}  // namespace

LostFields writeMsh(std::ostream& stream, const CellMesh& mesh) {
  BinaryWriter out(stream);
  const std::map<std::int64_t, Volume> volumes = volumesOf(mesh);
  out.text("$MeshFormat\n4.1 1 8\n");
  out.integer(1);
  out.text("\n$EndMeshFormat\n");
  writeEntities(out, volumes, boundingBox(mesh.vertices));
  writeNodes(out, mesh.vertices, volumes.empty() ? 1 : volumes.begin()->first);
  writeElements(out, mesh, volumes);
  LostFields lost;
  writeFields(out, "NodeData", mesh.vertexFields, lost);
  writeFields(out, "ElementData", mesh.cellFields, lost);
  return lost;
}

}  // namespace innermap
