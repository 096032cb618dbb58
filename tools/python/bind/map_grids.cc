// A map on the voxels of its solid.
#include <fmt/format.h>

#include "bind/arrays.h"
#include "bind/grids.h"
#include "bind/keywords.h"
#include "bind/map.h"
#include "bind/meshes.h"
#include "innermap/core/memory.h"
#include "innermap/evaluate/grids.h"
#include "innermap/levelset/level_set.h"

namespace py = pybind11;
using namespace py::literals;

namespace innermap::python {
namespace {

struct MapGridOptions {
  LatticeChoice grid;
  LameConstants lame;
  RepairFolds repair = RepairFolds::automatic;
  CallOptions call;

  void describe(Keywords& k) {
    k.settings(innermap::describe(grid));
    k.settings(innermap::describe(lame));
    k.setting(repairSetting(&repair));
    call.describe(k);
  }
};

struct WriteMapOptions : MapGridOptions {
  NamingScheme names = NamingScheme::innermap;

  void describe(Keywords& k) {
    k.setting(namesSetting(&names));
    MapGridOptions::describe(k);
  }
};

SolidGrids gridsOf(const PyMap& map, const MapGridOptions& o) {
  return call(o.call, [&]() {
    auto settings = o.grid.in(MapGridSettings{});
    settings.lame = o.lame;
    settings.repair = o.repair;
    requireMemory(mapGridNeed(map.mapped->solid(), o.grid, mapGridKind(*map.mapped)));
    return evaluateOnGrid(*map.mapped, settings);
  });
}

py::object evaluateMap(const Arguments& a, MapGridOptions& o) {
  const SolidGrids grids = gridsOf(py::cast<const PyMap&>(a[0]), o);
  py::dict totals("harmonic_energy"_a = grids.values.harmonicTotal,
                  "deformation_energy"_a = grids.values.deformationTotal,
                  "volume"_a = grids.values.volume, "jacobian_min"_a = grids.values.jacobianMin,
                  "jacobian_max"_a = grids.values.jacobianMax,
                  "folded_fraction"_a = grids.values.foldedFraction,
                  "folded_voxels"_a = grids.values.foldedVoxels,
                  "folded_voxels_left"_a = grids.values.foldedVoxelsLeft,
                  "outside_fraction"_a = grids.outsideFraction,
                  "interior_voxels"_a = grids.values.interiorVoxels,
                  "one_to_one"_a = injectivityStatement(grids.injectivity));
  return gridsObject(grids.all(), totals, o.call);
}

py::object writeMapVdb(const Arguments& a, WriteMapOptions& o) {
  const std::string path = pathFrom(a[1], "path");
  const SolidGrids grids = gridsOf(py::cast<const PyMap&>(a[0]), o);
  return writeGrids(path, grids.all(), o.names, o.call);
}

struct Folds {
  double share = 0, leastJacobian = 0;
  std::uint64_t folded = 0, checked = 0;
  Points places;
};

using FoldOptions = SettingsOptions<LatticeChoice>;

Folds foldsOf(const PyMap& map, const FoldOptions& o) {
  const MappedSolid& mapped = *map.mapped;
  requireMemory(mapGridNeed(mapped.solid(), o.settings, mapGridKind(mapped)));
  const auto levelSet = makeLevelSet(mapped.solid(), o.settings.in(LevelSetSettings{}));
  EvaluateSettings settings;
  settings.map = settings.harmonicEnergy = settings.deformationEnergy = false;
  const MapGrids grids = evaluateMap(mapped.map, mapped.solid(), *levelSet, settings);
  Folds out{grids.foldedFraction, grids.jacobianMin, grids.foldedVoxels, grids.interiorVoxels, {}};
  if (!grids.folded) return out;
  for (auto it = grids.folded->cbeginValueOn(); it; ++it) {
    const openvdb::Vec3d p = grids.folded->indexToWorld(it.getCoord());
    out.places.push_back({p.x(), p.y(), p.z()});
  }
  return out;
}

}  // namespace

void bindMapGrids(py::module_& m) {
  const py::object map = m.attr("Map");
  define<MapGridOptions>(
      map,
      {"evaluate", "self",
       "The map on the voxels of its solid: an innermap.Grids with surface (level set), density "
       "(fog of the inside), map (where each voxel goes, world units of the target), jacobian (its "
       "change of volume), harmonic_energy, deformation_energy, and where there are such, folded, "
       "outside, repaired and map_local. totals of it has the energies' integrals, the least "
       "Jacobian, the folded share. Raises MemoryError before the work."},
      evaluateMap);
  define<WriteMapOptions>(map,
                          {"write_vdb", "self, path",
                           "Evaluates the map as evaluate() does and writes an OpenVDB file, the "
                           "program's map.vdb. Raises FileError, MemoryError."},
                          writeMapVdb);
  py::class_<Folds>(m, "Folds", "Where a map turns its inside out, on the voxels of a grid.")
      .def_readonly("share", &Folds::share, "Share of the volume whose Jacobian is not above 0.")
      .def_readonly("least_jacobian", &Folds::leastJacobian,
                    "The least determinant at a voxel inside.")
      .def_readonly("folded", &Folds::folded, "Voxels inside whose Jacobian is not above 0.")
      .def_readonly("checked", &Folds::checked, "Voxels inside.")
      .def_property_readonly(
          "places", [](const Folds& f) { return arrayOf(f.places); },
          "(folded, 3): their centres, world units of the source.")
      .def("__repr__", [](const Folds& f) {
        return fmt::format(
            "<innermap.Folds: {} of {} voxels, {:.3g}% of the volume, least "
            "Jacobian {:.3g}>",
            f.folded, f.checked, 100 * f.share, f.leastJacobian);
      });
  define<FoldOptions>(map,
                      {"folds", "self",
                       "Where the map folds, an innermap.Folds, looked for at the voxels of a grid "
                       "inside the solid. Raises MemoryError."},
                      [](const Arguments& a, FoldOptions& o) {
                        const auto& self = py::cast<const PyMap&>(a[0]);
                        return py::cast(call(o.call, [&]() { return foldsOf(self, o); }));
                      });
}

}  // namespace innermap::python
