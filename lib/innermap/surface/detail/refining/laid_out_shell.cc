#include "innermap/surface/detail/refining/laid_out_shell.h"

#include <utility>

#include "innermap/surface/detail/sphere/sphere_layout.h"
#include "innermap/surface/detail/torus/torus_layout.h"

namespace innermap {
namespace {

Layout layOut(const ClosedSurface& surface, Progress* progress) {
  if (surface.genus == 1) return layOutTorus(surface, progress);
  SphereLayoutSettings settings;
  settings.progress = progress;
  return layOutSphere(surface, settings);
}

}  // namespace

LaidOutShell::LaidOutShell(const ClosedSurface& shell, Progress* progress)
    : LaidOutShell(shell, layOut(shell, progress), progress) {}

LaidOutShell::LaidOutShell(const ClosedSurface& shell, Layout laidOut, Progress* progress)
    : surface(shell),
      layout(std::move(laidOut)),
      metric(surface, layout),
      tips(layout.space == ModelSpace::sphere ? limbTips(surface, layout, 800, progress)
                                              : LimbTips{}) {}

DataError noMapWithoutFlips(const ClosedSurface& surface) {
  return DataError(surface.name +
                   ": no map without flips was found; remove slivers from the mesh, or give "
                   "landmarks");
}

}  // namespace innermap
