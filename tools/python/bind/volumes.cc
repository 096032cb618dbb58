// Grids out of arrays, .vdb files, solids; pictures of them; distances through a map.
#include "bind/volumes.h"

#include <fmt/format.h>
#include <openvdb/tools/Dense.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "bind/arrays.h"
#include "bind/errors.h"
#include "bind/figures.h"
#include "bind/grids.h"
#include "bind/keywords.h"
#include "bind/lists.h"
#include "bind/map.h"
#include "bind/meshes.h"
#include "innermap/core/memory.h"
#include "innermap/evaluate/grids.h"
#include "innermap/io/exr_slices.h"
#include "innermap/io/pictures.h"
#include "innermap/levelset/level_set.h"
#include "innermap/transfer/distance_transfer.h"
#include "report/figures.h"

namespace py = pybind11;
using namespace py::literals;

namespace innermap::python {
namespace {

struct FromArraysOptions {
  std::optional<double> background;
  py::object levelSets, fogs;
  double tolerance = 0;
  CallOptions call;

  void describe(Keywords& k) {
    k.number("background", &background, {-1e30, 1e30},
             "value of voxels that are not active: those that have it; 0 if not given");
    k.number("tolerance", &tolerance, {0, 1e30}, "how near to the background a voxel has it");
    k.object("level_sets", &levelSets, "str or Sequence[str]",
             "names of those that are level sets, negative inside");
    k.object("fogs", &fogs, "str or Sequence[str]", "names of those that are fog volumes");
    call.describe(k);
  }
};

// Of voxel centres: matrix @ [i, j, k, 1].
openvdb::math::Transform::Ptr transformFrom(const py::object& object) {
  const Matrix m = matrixFrom(object, "matrix", 4);
  if (m.columns() != 4) wrongValue("matrix", "expects shape (4, 4)");
  // OpenVDB's vectors are rows.
  openvdb::math::Mat4d rows;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      rows(c, r) = m(static_cast<std::size_t>(r), static_cast<std::size_t>(c));
  const bool affine = m(3, 0) == 0 && m(3, 1) == 0 && m(3, 2) == 0 && m(3, 3) == 1;
  if (!affine || !(std::abs(rows.det()) > 0))
    wrongValue("matrix", "is no affine map with an inverse: last row 0, 0, 0, 1");
  return openvdb::math::Transform::createLinearTransform(rows);
}

template <class Grid, class Number>
openvdb::GridBase::Ptr gridFrom(const py::array& array, double background, double tolerance) {
  using Value = typename Grid::ValueType;
  if constexpr (std::is_integral_v<Number>)
    for (const double given : {background, tolerance})
      if (!(std::abs(given) < static_cast<double>(std::numeric_limits<Number>::max())))
        wrongValue("background", fmt::format("{:g} is more than these whole numbers hold", given));
  const py::array_t<Number, py::array::c_style | py::array::forcecast> plain(array);
  const auto ground = static_cast<Number>(background);
  const auto grid = Grid::create(Value(ground));
  const openvdb::CoordBBox box(
      openvdb::Coord(0),
      openvdb::Coord(static_cast<int>(array.shape(0)) - 1, static_cast<int>(array.shape(1)) - 1,
                     static_cast<int>(array.shape(2)) - 1));
  // Dense takes no constant values; copyFromDense() only reads them.
  auto* values = reinterpret_cast<Value*>(const_cast<Number*>(plain.data()));
  const py::gil_scoped_release unlocked;
  const openvdb::tools::Dense<Value> dense(box, values);
  openvdb::tools::copyFromDense(dense, *grid, Value(static_cast<Number>(tolerance)));
  return grid;
}

openvdb::GridBase::Ptr gridOf(const py::handle& item, const std::string& name, double background,
                              double tolerance) {
  const py::array array = py::array::ensure(py::reinterpret_borrow<py::object>(item));
  if (!array) wrongType(name, "expects an array");
  const bool vector = array.ndim() == 4 && array.shape(3) == 3;
  if (!vector && array.ndim() != 3)
    wrongValue(name, "expects an array of shape (nx, ny, nz) or (nx, ny, nz, 3)");
  if (array.size() == 0) wrongValue(name, "is empty");
  for (int axis = 0; axis < 3; ++axis)
    if (array.shape(axis) > 65536) wrongValue(name, "has over 65536 voxels along a side");
  const char kind = array.dtype().kind();
  if (kind == 'f') {
    if (vector) return gridFrom<openvdb::Vec3SGrid, float>(array, background, tolerance);
    if (array.itemsize() >= 8)
      return gridFrom<openvdb::DoubleGrid, double>(array, background, tolerance);
    return gridFrom<openvdb::FloatGrid, float>(array, background, tolerance);
  }
  if (vector || (kind != 'i' && kind != 'u'))
    wrongType(name, "expects floats, or whole numbers for one value a voxel");
  if (kind == 'u' && array.itemsize() == 8)
    wrongType(name, "is of uint64, which no grid holds; convert it to int64");
  if (array.itemsize() == (kind == 'u' ? 4 : 8))
    return gridFrom<openvdb::Int64Grid, std::int64_t>(array, background, tolerance);
  return gridFrom<openvdb::Int32Grid, std::int32_t>(array, background, tolerance);
}

py::object grids(const Arguments& a, FromArraysOptions& o) {
  if (!py::isinstance<py::dict>(a[0])) wrongType("arrays", "expects a dict of arrays by name");
  const auto transform = transformFrom(a[1]);
  const double background = o.background.value_or(0);
  const auto levelSets = textsFrom(o.levelSets, "level_sets"), fogs = textsFrom(o.fogs, "fogs");
  openvdb::GridPtrVec made;
  for (const auto& [key, array] : py::dict(a[0])) {
    const std::string name = textOf(key, "arrays");
    openvdb::GridBase::Ptr grid = gridOf(array, name, background, o.tolerance);
    grid->setName(name);
    grid->setTransform(transform->copy());
    if (std::find(levelSets.begin(), levelSets.end(), name) != levelSets.end())
      grid->setGridClass(openvdb::GRID_LEVEL_SET);
    if (std::find(fogs.begin(), fogs.end(), name) != fogs.end())
      grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    made.push_back(std::move(grid));
  }
  return gridsObject(std::move(made), {}, o.call);
}

struct ReadOptions {
  py::object names;
  CallOptions call;

  void describe(Keywords& k) {
    k.object("names", &names, "str or Sequence[str]", "of the grids to read; all if not given");
    call.describe(k);
  }
};

struct VoxelizeOptions {
  LatticeChoice grid;
  LevelSetSettings levelSet;
  bool fog = false, attributes = false;
  CallOptions call;

  void describe(Keywords& k) {
    k.settings(innermap::describe(grid));
    k.settings(innermap::describe(levelSet));
    k.flag("fog", &fog, "also density: 1 inside, 0 outside, shares along the surface");
    k.flag("attributes", &attributes,
           "also texture coordinates (uv) and vertex colours (Cd) of a mesh that was read from a "
           "file");
    call.describe(k);
  }
};

py::object voxelize(const Arguments& a, VoxelizeOptions& o) {
  const Mesh mesh = onlyMesh(a, "voxelize");
  openvdb::GridPtrVec made;
  const LevelSetCheck check = call(o.call, [&]() {
    LevelSetSettings settings = o.levelSet;
    settings.resolution = o.grid.resolution.value_or(0);
    settings.voxelSize = o.grid.voxelSize.value_or(0);
    const Solid solid(mesh);
    requireMemory({"voxelizing", voxelizeMemory(solid, settings, mesh, o.fog, o.attributes),
                   "use larger voxels"});
    const openvdb::FloatGrid::Ptr surface = makeLevelSet(solid, settings);
    made.push_back(surface);
    if (o.fog) made.push_back(makeFog(*surface));
    if (o.attributes)
      for (const auto& grid : makeAttributeGrids(*surface, solid, mesh)) made.push_back(grid);
    return checkLevelSet(*surface, solid);
  });
  py::dict totals = dictOf(figures(check));
  totals["warnings"] = check.warnings;
  return gridsObject(std::move(made), totals, o.call);
}

using DistanceOptions = SettingsOptions<LatticeChoice>;

py::object distance(const Arguments& a, DistanceOptions& o) {
  if (!py::isinstance<PyMap>(a[0])) wrongType("map", "expects an innermap.Map");
  const MappedSolid& mapped = *py::cast<const PyMap&>(a[0]).mapped;
  const DistanceTransfer made = call(o.call, [&]() {
    auto settings = o.settings.in(DistanceTransferSettings{});
    settings.resolution = o.settings.resolution.value_or(0);
    settings.accuracy = sumAccuracy(mapped);
    const Solid target = makeTargetSolid(mapped.boundary);
    requireMemory({"transferring the distance",
                   distanceTransferMemory(mapped.solid(), target, settings),
                   "use a lower resolution"});
    return transferDistance(mapped.map, mapped.solid(), target, settings);
  });
  const openvdb::GridPtrVec source{made.source.surface, made.through, made.source.depth},
      target{made.target.surface, made.target.depth};
  describeMap(source, mapped);
  describeMap(target, mapped);
  return py::make_tuple(gridsObject(source, dictOf(figures(made)), o.call),
                        gridsObject(target, {}, o.call));
}

struct SliceOptions {
  ExrSliceSettings slices;
  py::object names;
  CallOptions call;

  void describe(Keywords& k) {
    k.settings(innermap::describe(slices));
    k.object("names", &names, "str or Sequence[str]", "of the grids; all if not given");
    call.describe(k);
  }
};

py::object writeSlices(const Arguments& a, SliceOptions& o) {
  const std::string path = pathFrom(a[0], "path");
  const openvdb::GridPtrVec given = takeGrids(a[1], "grids", textsFrom(o.names, "names"), o.call);
  const ExrSliceResult made = call(o.call, [&]() {
    requireMemory({"slices", exrSliceMemory(given, o.slices), "slice fewer grids"});
    return writeExrSlices(path, given, o.slices);
  });
  return py::dict("slices"_a = made.slices, "width"_a = made.columns, "height"_a = made.rows,
                  "clamped"_a = made.clamped);
}

struct SectionOptions {
  SectionSettings section;
  py::object grid, range;
  CallOptions call;

  void describe(Keywords& k) {
    k.object("grid", &grid, "str",
             "that is shown: jacobian, else the first energy, map, density or surface there is");
    k.settings(innermap::describe(section));
    k.object("range", &range, "tuple[float, float]",
             "values at the ends of the colours; all but the outermost 0.5% on each side if not "
             "given");
    call.describe(k);
  }
};

py::object writeSection(const Arguments& a, SectionOptions& o) {
  const std::string path = pathFrom(a[0], "path");
  const openvdb::GridPtrVec given = takeGrids(a[1], "grids", {}, o.call);
  const auto shown = textsFrom(o.grid, "grid");
  if (!shown.empty()) o.section.grid = shown.front();
  if (!o.range.is_none()) o.section.range = pairFrom(o.range, "range");
  return dictOf(figures(call(o.call, [&]() { return writeSectionImage(path, given, o.section); })));
}

}  // namespace

void bindVolumes(py::module_& m) {
  define<FromArraysOptions>(
      m,
      {"grids", "arrays, matrix",
       "Makes grids of arrays: an innermap.Grids.\n\narrays: a dict by name of (nx, ny, nz) or "
       "(nx, "
       "ny, nz, 3), floats or whole numbers. matrix: (4, 4), matrix @ [i, j, k, 1] is the centre "
       "of voxel [i, j, k], world units; that of another Grids, or a nifti image's affine. Voxels "
       "that have the background are not active. Raises DataError."},
      grids);
  define<ReadOptions>(m,
                      {"read_vdb", "path",
                       "Reads grids of one lattice from an OpenVDB file of any program: an "
                       "innermap.Grids. Files are not trusted. Raises FileError, MemoryError, "
                       "DataError for grids of several lattices; read those by their names."},
                      [](const Arguments& a, ReadOptions& o) {
                        if (!isPath(a[0])) wrongType("path", "expects a path");
                        return gridsObject(
                            takeGrids(a[0], "path", textsFrom(o.names, "names"), o.call), {},
                            o.call);
                      });
  define<VoxelizeOptions>(
      m,
      {"voxelize", "*mesh",
       "A mesh as a level set, the grid surface of an innermap.Grids: signed distance, negative "
       "inside, exact in the band, world units. Open, dirty and overlapping meshes work. totals "
       "has its check against the mesh. Raises DataError, MemoryError."},
      voxelize);
  define<DistanceOptions>(
      m,
      {"transfer_distance", "map",
       "The distance field of a map's target, seen through the map: (source, target), two "
       "innermap.Grids.\n\nsource has surface, distance, how deep the image of each voxel lies in "
       "the target, and source_distance, how deep the voxel in the source; target has surface and "
       "distance. World units, positive inside. Raises MemoryError."},
      distance);
  define<SliceOptions>(m,
                       {"write_slices", "path, grids",
                        "Cuts grids into parallel slices, a part each of an EXR file. grids: an "
                        "innermap.Grids or the path of a .vdb file. Returns slices, width, height "
                        "and how many values did not fit. Raises FileError, DataError, "
                        "MemoryError."},
                       writeSlices);
  define<SectionOptions>(m,
                         {"write_section", "path, grids",
                          "Draws a cross-section of a grid as a PNG. grids: an innermap.Grids or "
                          "the path of a .vdb file. Returns grid, position, least, most and range. "
                          "Raises FileError, DataError."},
                         writeSection);
}

}  // namespace innermap::python
