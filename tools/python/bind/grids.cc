#include "bind/grids.h"

#include <fmt/format.h>
#include <openvdb/tools/Dense.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <type_traits>

#include "bind/arrays.h"
#include "bind/errors.h"
#include "bind/keywords.h"
#include "bind/lists.h"
#include "bind/meshes.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

using openvdb::CoordBBox;
using openvdb::GridBase;

struct PyGrids {
  openvdb::GridPtrVec grids;
  CoordBBox box;  // of all active voxels
  py::dict totals;
  std::uint64_t maxMemory = 0;

  const GridBase& named(const std::string& name) const {
    for (const GridBase::Ptr& grid : grids)
      if (grid->getName() == name) return *grid;
    throw py::key_error(name);
  }
  // Where array index `ijk` is, world units.
  Vec3 place(double i, double j, double k) const {
    const openvdb::Vec3d p =
        grids.front()->transform().indexToWorld(openvdb::Vec3d(i, j, k) + box.min().asVec3d());
    return {p.x(), p.y(), p.z()};
  }
};

// Of which there are arrays.
using ArrayGrids = openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid,
                                     openvdb::Int64Grid, openvdb::BoolGrid, openvdb::Vec3SGrid,
                                     openvdb::Vec3DGrid, openvdb::Vec3IGrid>;

template <class Grid>
py::array denseOf(const Grid& grid, const CoordBBox& box) {
  using Value = typename Grid::ValueType;
  using Number = typename openvdb::VecTraits<Value>::ElementType;
  constexpr std::size_t kWidth = sizeof(Value) / sizeof(Number);
  const openvdb::Coord size = box.dim();
  std::vector<py::ssize_t> shape{size.x(), size.y(), size.z()};
  if (kWidth > 1) shape.push_back(kWidth);
  py::array_t<Number> out(shape);
  auto* values = reinterpret_cast<Value*>(out.mutable_data());
  {
    const py::gil_scoped_release unlocked;
    openvdb::tools::Dense<Value> dense(box, values);
    openvdb::tools::copyToDense(grid, dense);
  }
  return std::move(out);
}

py::array arrayNamed(const PyGrids& grids, const std::string& name) {
  const GridBase& grid = grids.named(name);
  const openvdb::Coord size = grids.box.dim();
  py::array out;
  const bool known = grid.apply<ArrayGrids>([&](const auto& typed) {
    using Value = typename std::decay_t<decltype(typed)>::ValueType;
    innermap::requireMemory(
        fmt::format("the array of '{}', {} x {} x {} voxels,", name, size.x(), size.y(), size.z()),
        processMemory(grids.box.volume() * sizeof(Value)), grids.maxMemory,
        "use a lower resolution, or write_vdb()");
    out = denseOf(typed, grids.box);
  });
  if (!known)
    throw DataError(
        fmt::format("grid '{}' is of type {}, which has no array", grid.getName(), grid.type()));
  return out;
}

py::array matrixOf(const PyGrids& grids) {
  py::array_t<double> out({4, 4});
  auto m = out.mutable_unchecked<2>();
  const Vec3 origin = grids.place(0, 0, 0);
  for (int c = 0; c < 3; ++c) {
    const Vec3 step = grids.place(c == 0, c == 1, c == 2) - origin;
    for (int r = 0; r < 3; ++r) {
      m(r, c) = step[r];
      m(r, 3) = origin[r];
    }
    m(3, c) = 0;
  }
  m(3, 3) = 1;
  return out;
}

py::array boundsOf(const PyGrids& grids) {
  const openvdb::Coord size = grids.box.dim();
  return arrayOf(
      Points{grids.place(0, 0, 0), grids.place(size.x() - 1, size.y() - 1, size.z() - 1)});
}

py::object valueOf(const openvdb::Metadata& data) {
  if (data.typeName() == "string")
    return py::str(static_cast<const openvdb::StringMetadata&>(data).value());
  if (data.typeName() == "double")
    return py::float_(static_cast<const openvdb::DoubleMetadata&>(data).value());
  if (data.typeName() == "float")
    return py::float_(static_cast<const openvdb::FloatMetadata&>(data).value());
  if (data.typeName() == "int32")
    return py::int_(static_cast<const openvdb::Int32Metadata&>(data).value());
  if (data.typeName() == "int64")
    return py::int_(static_cast<const openvdb::Int64Metadata&>(data).value());
  if (data.typeName() == "bool")
    return py::bool_(static_cast<const openvdb::BoolMetadata&>(data).value());
  return py::str(data.str());
}

py::dict metadataOf(const GridBase& grid) {
  py::dict out;
  for (auto it = grid.beginMeta(); it != grid.endMeta(); ++it)
    out[it->first.c_str()] = valueOf(*it->second);
  return out;
}

py::list namesOf(const PyGrids& grids) {
  py::list out;
  for (const GridBase::Ptr& grid : grids.grids) out.append(grid->getName());
  return out;
}

std::string gridsText(const PyGrids& grids) {
  const openvdb::Coord size = grids.box.dim();
  return fmt::format("<innermap.Grids of {} x {} x {} voxels: {}>", size.x(), size.y(), size.z(),
                     py::cast<std::string>(py::str(", ").attr("join")(namesOf(grids))));
}

struct WriteOptions {
  NamingScheme names = NamingScheme::innermap;
  CallOptions call;

  void describe(Keywords& k) {
    k.setting(namesSetting(&names));
    call.describe(k);
  }
};

py::object writeFile(const Arguments& a, WriteOptions& o) {
  const openvdb::GridPtrVec grids = py::cast<const PyGrids&>(a[0]).grids;
  const std::string path = pathFrom(a[1], "path");
  return writeGrids(path, grids, o.names, o.call);
}

}  // namespace

py::object writeGrids(const std::string& path, const openvdb::GridPtrVec& grids, NamingScheme names,
                      const CallOptions& call) {
  runCall(call, [&]() {
    VdbWriteSettings settings;
    settings.names = names;
    writeVdb(path, grids, {}, settings);
  });
  return py::none();
}

py::object gridsObject(openvdb::GridPtrVec grids, const py::dict& totals, const CallOptions& call) {
  auto out = std::make_shared<PyGrids>();
  for (const GridBase::Ptr& grid : grids) {
    if (grid->transform() != grids.front()->transform())
      throw DataError("grid '" + grid->getName() + "' has another transform than the first");
    out->box.expand(grid->evalActiveVoxelBoundingBox());
  }
  if (grids.empty() || out->box.empty()) throw DataError("there is no active voxel in any grid");
  out->grids = std::move(grids);
  out->totals = totals;
  out->maxMemory = call.maxMemory;
  return py::cast(out);
}

bool isGrids(py::handle object) { return py::isinstance<PyGrids>(object); }

openvdb::GridPtrVec takeGrids(const py::object& grids, const std::string& argument,
                              const std::vector<std::string>& names, const CallOptions& options) {
  if (isGrids(grids)) {
    const auto& own = py::cast<const PyGrids&>(grids);
    if (names.empty()) return own.grids;
    openvdb::GridPtrVec out;
    for (const GridBase::Ptr& grid : own.grids)
      if (std::find(names.begin(), names.end(), grid->getName()) != names.end())
        out.push_back(grid);
    for (const std::string& name : names) own.named(name);
    return out;
  }
  if (!isPath(grids)) wrongType(argument, "expects an innermap.Grids or the path of a .vdb file");
  const std::string path = pathFrom(grids, argument);
  openvdb::GridPtrVec out = call(options, [&]() {
    VdbReadSettings settings;
    settings.names = names;
    requireMemory(
        {"reading " + path, readMemory(readVdbInfo(path), names), "read fewer of its grids"});
    return readVdb(path, settings).grids;
  });
  if (out.empty()) throw FileError(path, "holds no grid");
  return out;
}

void bindGrids(py::module_& m) {
  py::class_<PyGrids, std::shared_ptr<PyGrids>> grids(
      m, "Grids",
      "Grids by their names, sparse inside. grids['map'] makes a dense array over the box of all "
      "active voxels, the same box for each of them, (nx, ny, nz) or (nx, ny, nz, 3), with the "
      "grid's background where it has no voxels; its memory is checked against max_memory first. "
      "Index [i, j, k] is the voxel whose centre is at matrix @ [i, j, k, 1], world units.\n\n"
      "To pyopenvdb as an array and the matrix: g = pyopenvdb.FloatGrid(); "
      "g.copyFromArray(grids['jacobian']); "
      "g.transform = pyopenvdb.createLinearTransform(grids.matrix.T.tolist()); or sparse, as a "
      "file: write_vdb(path).");
  grids
      .def(
          "__getitem__",
          [](const PyGrids& g, const py::str& name) {
            return arrayNamed(g, textFrom(name, "name"));
          },
          documented("__getitem__(self, name)",
                     "The grid as a new dense array: float32 as in the grid. Raises KeyError, "
                     "MemoryError.")
              .c_str())
      .def("__iter__", [](const PyGrids& g) { return py::iter(namesOf(g)); })
      .def("__len__", [](const PyGrids& g) { return g.grids.size(); })
      .def("__contains__",
           [](const PyGrids& g, const py::object& name) { return namesOf(g).contains(name); })
      .def("keys", &namesOf, documented("keys(self)", "The names of the grids.").c_str())
      .def(
          "metadata",
          [](const PyGrids& g, const py::str& name) {
            return metadataOf(g.named(textFrom(name, "name")));
          },
          documented("metadata(self, name)", "What the grid says of itself, by key.").c_str())
      .def_property_readonly("matrix", &matrixOf,
                             "(4, 4) float64: from an array's indices to the world, for columns.")
      .def_property_readonly("bounds", &boundsOf,
                             "(2, 3) float64: centres of an array's first and last voxel, world "
                             "units.")
      .def_property_readonly(
          "voxel_size", [](const PyGrids& g) { return g.grids.front()->voxelSize()[0]; },
          "Edge of a voxel, world units.")
      .def_property_readonly(
          "shape",
          [](const PyGrids& g) {
            const openvdb::Coord size = g.box.dim();
            return py::make_tuple(size.x(), size.y(), size.z());
          },
          "(nx, ny, nz) of the arrays.")
      .def_readonly("totals", &PyGrids::totals, "Numbers about the grids, by name.")
      .def("__repr__", &gridsText);
  define<WriteOptions>(grids,
                       {"write_vdb", "self, path",
                        "Writes the grids to an OpenVDB file, with their metadata. It appears "
                        "whole or not at all. Raises FileError."},
                       writeFile);
}

}  // namespace innermap::python
