#include "surface/detail/refining/laid_out_shell.h"

#include <utility>

#include "surface/detail/sphere/sphere_layout.h"
#include "surface/detail/torus/torus_layout.h"

namespace innermap {
namespace {

Layout layOut(const ClosedSurface& surface) {
  if (surface.genus == 1) return layOutTorus(surface);
  return layOutSphere(surface);
}

}  // namespace

LaidOutShell::LaidOutShell(const ClosedSurface& shell) : LaidOutShell(shell, layOut(shell)) {}

LaidOutShell::LaidOutShell(const ClosedSurface& shell, Layout laidOut)
    : surface(shell),
      layout(std::move(laidOut)),
      metric(surface, layout),
      tips(layout.space == ModelSpace::sphere ? limbTips(surface, layout, 800) : LimbTips{}) {}

DataError noMapWithoutFlips(const ClosedSurface& surface) {
  return DataError(surface.name +
                   ": no map without flips was found; remove slivers from the mesh, or give "
                   "landmarks");
}

}  // namespace innermap
