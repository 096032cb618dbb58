// push() and pull(): grids, meshes, cells, files and points through a map, and back.
#include "innermap/transfer/carry.h"

#include <fmt/format.h>

#include <algorithm>

#include "bind/arrays.h"
#include "bind/carry_options.h"
#include "bind/cells.h"
#include "bind/errors.h"
#include "bind/lists.h"
#include "bind/map.h"
#include "bind/meshes.h"
#include "innermap/core/memory.h"
#include "innermap/evaluate/grids.h"
#include "innermap/io/cell_file.h"
#include "innermap/io/geometry_file.h"
#include "innermap/transfer/inverse_map.h"
#include "innermap/transfer/push_pull.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct WayOptions : CarryOptions {
  py::object through;
  double subdivide = 0;
  bool jacobian = false;

  void describe(Keywords& k) {
    k.flag("jacobian", &jacobian, "of points: also the derivative at each");
    k.object("through", &through, "cells",
             "go by the piecewise linear map of the cells that remesh() made with the map instead: "
             "nowhere folded");
    k.setting(subdivideSetting(&subdivide));
    CarryOptions::describe(k);
  }
};

// One call of push() or pull().
class Job {
 public:
  Job(bool push, const PyMap& map, const WayOptions& o)
      : push_(push), map_(map), o_(o), way_(map.mapped->map) {
    const MappedSolid& mapped = *map.mapped;
    outside_ = outsideSettings(o.outside, fadeToFrom(o.outside, o.fadeTo), mapped);
    if (!o.through.is_none()) way_ = linearMapOf(cellsFrom(o.through, "through", o.call), mapped);
  }

  py::object grids(const py::object& what, const py::object& path) const;
  py::object points(const py::object& what) const;
  py::object mesh(const Mesh& mesh) const;
  py::object cells(CellMesh mesh) const;
  py::object file(const std::string& from, const py::object& path) const;

 private:
  struct Grids {
    openvdb::GridPtrVec made;
    PushResult pushed;
    PullResult pulled;
  };

  void carryGrids(const openvdb::GridPtrVec& given, const CarrySettings& carry, Grids& out) const;
  PointCarry carryOf() const;
  CarriedPoints carryPoints(const Points& points, bool jacobians) const {
    return carryOf()(points, jacobians);
  }

  const bool push_;
  const PyMap& map_;
  const WayOptions& o_;
  OutsideSettings outside_;
  SolidMap way_;
};

void Job::carryGrids(const openvdb::GridPtrVec& given, const CarrySettings& carry,
                     Grids& out) const {
  const CarryJob job{push_,    map_.mapped, makeTargetSolid(map_.mapped->boundary),
                     way_,     given,       carry,
                     outside_, o_.lattice};
  requireMemory(job.need());
  const openvdb::FloatGrid::Ptr levelSet = makeLevelSet(job.to(), job.output());
  if (push_) {
    out.pushed = pusherOf(job).push(way_, *levelSet);
    out.made = out.pushed.grids;
  } else {
    out.pulled = pullerOf(job).puller.pull(*levelSet);
    out.made = out.pulled.grids;
  }
  describeMap(out.made, *map_.mapped);
}

py::object Job::grids(const py::object& what, const py::object& path) const {
  const openvdb::GridPtrVec given = takeGrids(what, "grids", textsFrom(o_.grids, "grids"), o_.call);
  const std::string to = path.is_none() ? "" : pathFrom(path, "path");
  const CarrySettings carry = o_.carry();
  Grids out;
  runCall(o_.call, [&]() {
    carryGrids(given, carry, out);
    if (to.empty()) return;
    VdbWriteSettings writing;
    writing.names = o_.names;
    writeVdb(to, out.made, {}, writing);
  });
  py::dict totals;
  if (push_) {
    totals = totalsOf(out.pushed);
  } else {
    totals["voxels"] = out.pulled.voxels;
    totals["warnings"] = out.pulled.warnings;
  }
  return gridsObject(std::move(out.made), totals, o_.call);
}

PointCarry Job::carryOf() const { return pointCarry(way_, *map_.mapped, push_, outside_); }

py::object Job::points(const py::object& what) const {
  const Points points = pointsFrom(what, push_ ? "X" : "Y");
  return carriedTuple(call(o_.call, [&]() { return carryPoints(points, o_.jacobian); }),
                      o_.jacobian);
}

// Meshes and cells are whole: all of their points have a place, or none.
void requireAll(const CarriedPoints& carried, const std::string& what) {
  if (carried.cut > 0)
    wrongValue(what, fmt::format("{} points lie too far outside the solid; give outside to keep "
                                 "them, or carry a file, where they are left out",
                                 carried.cut));
}

py::object Job::mesh(const Mesh& given) const {
  auto out = std::make_shared<Mesh>(given);
  runCall(o_.call, [&]() {
    CarriedPoints carried = carryPoints(out->vertices, false);
    requireAll(carried, "mesh");
    out->vertices = std::move(carried.points);
  });
  return py::cast(out);
}

// Directions of a field, at points [first, ...) of those carried.
void turn(CellField& field, const CarriedPoints& carried, std::size_t first) {
  if (field.kind == CellField::Kind::scalar) return;
  for (std::size_t i = 0; 3 * i < field.values.size(); ++i) {
    double* v = &field.values[3 * i];
    const Mat3& jacobian = carried.jacobians[first + i];
    const Vec3 turned = field.kind == CellField::Kind::vector
                            ? carriedVector(jacobian, {v[0], v[1], v[2]})
                            : carriedNormal(jacobian, {v[0], v[1], v[2]});
    for (int a = 0; a < 3; ++a) v[a] = turned[a];
  }
}

template <class Cell>
Vec3 middle(const Points& vertices, const Cell& cell) {
  Vec3 sum;
  for (const int v : cell) sum = sum + vertices[static_cast<std::size_t>(v)];
  return sum * (1.0 / static_cast<double>(cell.size()));
}

py::object Job::cells(CellMesh mesh) const {
  const auto turns = [](const std::vector<CellField>& fields) {
    return std::any_of(fields.begin(), fields.end(),
                       [](const CellField& f) { return f.kind != CellField::Kind::scalar; });
  };
  Points points = mesh.vertices;
  const std::size_t own = points.size();
  if (turns(mesh.cellFields)) {
    for (const Tetrahedron& cell : mesh.tetrahedra) points.push_back(middle(mesh.vertices, cell));
    for (const Hexahedron& cell : mesh.hexahedra) points.push_back(middle(mesh.vertices, cell));
  }
  const bool jacobians = points.size() > own || turns(mesh.vertexFields);
  runCall(o_.call, [&]() {
    const CarriedPoints carried = carryPoints(points, jacobians);
    requireAll(carried, "cells");
    for (CellField& field : mesh.vertexFields) turn(field, carried, 0);
    for (CellField& field : mesh.cellFields) turn(field, carried, own);
    mesh.vertices.assign(carried.points.begin(),
                         carried.points.begin() + static_cast<std::ptrdiff_t>(own));
  });
  return cellsObject(std::move(mesh));
}

py::object Job::file(const std::string& from, const py::object& path) const {
  const std::string to = pathFrom(path, "path");
  requireWritableAs(from, to);
  ReadGeometrySettings reading = geometrySettings(o_);
  return dictOf(call(o_.call, [&]() {
    return carryFile(from, to, reading,
                     carryGeometrySettings(*map_.mapped, push_, o_.subdivide, o_.splats),
                     carryOf());
  }));
}

py::object carry(bool push, const Arguments& a, const WayOptions& o) {
  if (!py::isinstance<PyMap>(a[0])) wrongType("map", "expects an innermap.Map");
  const Job job(push, py::cast<const PyMap&>(a[0]), o);
  const py::object &what = a[1], &path = a[2];
  const std::string from = isPath(what) ? pathFrom(what, "inside") : "";
  if (!from.empty() && isGeometryFile(from)) {
    if (!path.is_none()) return job.file(from, path);
    if (isCellFile(from))
      return job.cells(cellsFrom(what, "inside", o.call, textsFrom(o.vectors, "vectors"),
                                 textsFrom(o.normals, "normals")));
    return job.mesh(meshFrom(what, "inside"));
  }
  if (!from.empty() || isGrids(what)) return job.grids(what, path);
  if (!path.is_none())
    wrongValue("path", "is for grids and for files; write what comes back with its own functions");
  if (isArrayLike(what)) return job.points(what);
  if (isCells(what))
    return job.cells(cellsFrom(what, "inside", o.call, textsFrom(o.vectors, "vectors"),
                               textsFrom(o.normals, "normals")));
  return job.mesh(meshFrom(what, "inside"));
}

}  // namespace

void bindCarry(py::module_& m) {
  const char* kinds =
      " inside: the path of a .vdb file or an innermap.Grids, which comes back as Grids and is "
      "written to path if given; the path of a file of geometry or cells (.obj, .ply, .off, .stl, "
      ".vtu, .msh, .mesh), written to path with figures coming back as a dict, or without path as "
      "Mesh or Cells; a mesh, (V, F) say, as an innermap.Mesh; cells as an innermap.Cells, their "
      "vector fields turned; or points, an array (n, 3), as (places, found): NaN and False where "
      "a point lies too far outside, with jacobian=True also (n, 3, 3).\n\nDensities keep their "
      "mass, vectors move by their vector type, level sets become distances again. Grids.totals "
      "has what became of each mass, and warnings. Raises DataError, SettingError, FileError, "
      "MemoryError.";
  const std::string push =
      std::string("Carries grids, geometry or points inside a map's source to its target.\n\n") +
      (kinds + 1);
  const std::string pull =
      std::string(
          "Brings grids, geometry or points inside a map's target back to its source.\n\n") +
      (kinds + 1);
  define<WayOptions>(m, {"push", "map, inside, path=None", push.c_str()},
                     [](const Arguments& a, WayOptions& o) { return carry(true, a, o); });
  define<WayOptions>(m, {"pull", "map, inside, path=None", pull.c_str()},
                     [](const Arguments& a, WayOptions& o) { return carry(false, a, o); });
}

}  // namespace innermap::python
