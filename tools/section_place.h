// Where a section shows most of a solid.
#pragma once

#include <openvdb/openvdb.h>

#include "innermap/levelset/solid.h"

namespace innermap::tool {

// The axis along which the solid is thinnest shows most of it.
int thinnestAxis(const Solid& solid);

// The fraction along the axis of the layer nearest the middle that cuts nearly as much of the solid
// as any does. density: a fog volume.
double fullLayer(const openvdb::FloatGrid& density, int axis);

}  // namespace innermap::tool
