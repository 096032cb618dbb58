#include "levelset/detail/solid_body.h"

namespace innermap {

SolidBody::SolidBody(RepairedMesh mesh, ExposedSurface surface)
    : repaired_(std::move(mesh)),
      exposed_(std::move(surface)),
      box_(boundingBox(this->surface())),
      area_(surfaceArea(this->surface())),
      tree_(this->surface().vertices, this->surface().triangles) {}

bool SolidBody::closedWellEnough() const {
  return exposed_.doubledArea <= 1e-4 * area_ && exposed_.gap <= box_.diagonal() / 64;
}

}  // namespace innermap
