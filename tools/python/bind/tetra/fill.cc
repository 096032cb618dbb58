// Solids filled with tetrahedra and hexahedra, and stood in for by cubes.

#include "bind/cells.h"
#include "bind/figures.h"
#include "bind/keywords.h"
#include "bind/meshes.h"
#include "innermap/correspond/mesh_correspondence.h"
#include "innermap/tetra/hexahedralize.h"
#include "innermap/tetra/tetrahedralize.h"
#include "jobs/tetra/cell_needs.h"
#include "report/figures.h"

namespace py = pybind11;
using namespace py::literals;

namespace innermap::python {
namespace {

using TetrahedralizeOptions = SettingsOptions<TetrahedralizeSettings>;

py::object tetrahedra(const Arguments& a, TetrahedralizeOptions& o) {
  const Mesh mesh = onlyMesh(a, "tetrahedralize");
  Tetrahedralization made =
      call(o.call, [&]() { return tetrahedralization(Solid(mesh), o.settings); });
  const CellQuality quality = call(o.call, [&]() { return cellQuality(made.mesh); });
  setQualityFields(made.mesh, quality);
  py::dict figures("edge"_a = made.edge, "components"_a = made.topology.components,
                   "cavities"_a = made.topology.cavities, "handles"_a = made.topology.handles,
                   "least_dihedral"_a = quality.dihedral.least,
                   "greatest_dihedral"_a = quality.greatestAngle,
                   "inverted"_a = quality.invertedTetrahedra);
  figures["proof"] =
      dictOf(innermap::figures(call(o.call, [&]() { return proveCells(made.mesh); })));
  figures["notes"] = made.notes;
  figures["warnings"] = made.warnings;
  return cellsObject(std::move(made.mesh), figures);
}

// What hexahedralize() and polycube() take.
struct BlockOptions {
  PolycubeSettings polycube;
  bool close = false;
  LayOutSettings surface;
  CallOptions call;

  void describe(Keywords& k) {
    k.settings(innermap::describe(polycube));
    k.settings(innermap::describe(surface));
    describeClose(k, &close);
    call.describe(k);
  }

  Mesh surfaceToFill(Mesh mesh) const {
    CleanSurface clean = cleanSurface(mesh, surface);
    return clean.outer ? std::move(clean.outer->mesh) : std::move(mesh);
  }
};

py::dict figuresOf(const Polycube& cube) {
  py::dict out = dictOf(figures(cube));
  out["notes"] = cube.notes;
  out["warnings"] = cube.warnings;
  return out;
}

struct HexahedralizeOptions : BlockOptions {
  HexahedralizeSettings settings;

  void describe(Keywords& k) {
    k.settings(without(innermap::describe(settings), {"blocks"}));
    BlockOptions::describe(k);
    call.describeTime(k);
  }
};

py::object hexahedra(const Arguments& a, HexahedralizeOptions& o) {
  const Mesh mesh = onlyMesh(a, "hexahedralize");
  o.settings.polycube = o.polycube;
  Hexahedralization made = call(o.call, [&]() {
    const Mesh surface = o.surfaceToFill(mesh);
    requireMemory(hexahedraNeed(mesh.name, surface, o.settings));
    return hexahedralize(surface, o.settings);
  });
  py::dict figures("proven"_a = made.after.proven(), "inverted"_a = made.after.inverted,
                   "inverted_before"_a = made.before.inverted,
                   "proof"_a = dictOf(innermap::figures(made.proof)),
                   "scaled_jacobian_least"_a = made.quality.jacobian.least,
                   "scaled_jacobian_mean"_a = made.quality.jacobian.mean,
                   "polycube"_a = figuresOf(made.polycube),
                   "polycube_surface"_a = blockSurface(made.polycube.blocks, made.pieces),
                   "in_blocks"_a = cellsObject(std::move(made.inBlocks)), "notes"_a = made.notes,
                   "warnings"_a = made.warnings);
  return cellsObject(std::move(made.mesh), figures);
}

struct PolycubeOptions : BlockOptions {
  std::optional<int> pieces;

  void describe(Keywords& k) {
    k.number("pieces", &pieces, {1, static_cast<double>(kMostBlockPieces)},
             "squares along a block's edge, of two triangles each; as many as give about 3000 "
             "vertices if not given");
    BlockOptions::describe(k);
  }
};

py::object polycube(const Arguments& a, PolycubeOptions& o) {
  const Mesh mesh = onlyMesh(a, "polycube");
  Mesh surface;
  const Polycube made = call(o.call, [&]() {
    const Mesh toFill = o.surfaceToFill(mesh);
    requireMemory(polycubeNeed(mesh.name, toFill, o.polycube));
    Polycube cube = makePolycube(toFill, o.polycube);
    surface = blockSurface(cube.blocks, o.pieces.value_or(usualPieces(cube.blocks)));
    return cube;
  });
  return py::make_tuple(std::make_shared<Mesh>(std::move(surface)), figuresOf(made));
}

}  // namespace

void bindFill(py::module_& m) {
  define<TetrahedralizeOptions>(
      m,
      {"tetrahedralize", "*mesh",
       "Fills a solid with tetrahedra: an innermap.Cells whose cell_data has each cell's "
       "least_dihedral and greatest_dihedral, degrees.\n\nDihedral angles lie in 10 to 165 "
       "degrees, with features in 5 to 170 (isosurface stuffing; Labelle and Shewchuk 2007). mesh: "
       "V, F or anything that stands for a mesh. Raises DataError where the topology cannot be "
       "kept, naming a resolution that does; MemoryError."},
      tetrahedra);
  define<HexahedralizeOptions>(
      m,
      {"hexahedralize", "*mesh",
       "Fills a solid with hexahedra by way of a polycube: an innermap.Cells whose cell_data has "
       "each cell's scaled_jacobian.\n\nfigures has proven, whether all are proven right side out "
       "everywhere; polycube_surface, a Mesh; in_blocks, the same hexahedra in the polycube, a "
       "Cells. mesh: one closed body. Raises DataError, MemoryError."},
      hexahedra);
  define<PolycubeOptions>(
      m,
      {"polycube", "*mesh",
       "Stands equal cubes in for a solid: (surface, figures), the surface of the cubes as an "
       "innermap.Mesh, fine enough to be mapped, and a dict: across, blocks, edge (world units), "
       "handles, cavities, and of the solid's volume the shares that are missed and in surplus. "
       "mesh: one closed body. Raises DataError, naming a number of blocks that has the mesh's "
       "topology."},
      polycube);
}

}  // namespace innermap::python
