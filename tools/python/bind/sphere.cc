// Surfaces laid out on the unit sphere.
#include <memory>

#include "bind/figures.h"
#include "bind/keywords.h"
#include "bind/meshes.h"
#include "innermap/core/memory.h"
#include "innermap/correspond/mesh_correspondence.h"
#include "report/figures.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

struct SphereOptions {
  LayOutSettings settings;
  bool close = false;
  CallOptions call;

  void describe(Keywords& k) {
    k.settings(innermap::describe(settings));
    describeClose(k, &close);
    call.describe(k);
  }
};

py::object sphere(const Arguments& a, SphereOptions& o) {
  const Mesh mesh = onlyMesh(a, "sphere");
  MeshOnSphere made = call(o.call, [&]() {
    requireMemory({"the layout", layOutMemory(mesh.vertices.size()), "use a coarser mesh"});
    return onSphere(layOutMesh(mesh, o.settings));
  });
  return py::make_tuple(std::make_shared<Mesh>(std::move(made.mesh)),
                        dictOf(figures(made.quality)));
}

}  // namespace

void bindSphere(py::module_& m) {
  define<SphereOptions>(
      m,
      {"sphere", "*mesh",
       "Lays a closed surface without handles out on the unit sphere about the origin, one-to-one, "
       "areas near their share: (surface, figures), an innermap.Mesh with the mesh's own vertices "
       "and faces, or those of the outer surface where the mesh runs through itself, and a dict: "
       "flips, degree (1: covered once), area_ratio_log10 (of the smallest triangle to its "
       "share).\n\nEach shell, a cavity say, covers the sphere by itself. mesh: V, F or anything "
       "that stands for a mesh. Raises DataError for handles, MemoryError."},
      sphere);
}

}  // namespace innermap::python
