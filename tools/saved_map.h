// A map from its file, with the solid that it was made for.
#pragma once

#include <openvdb/openvdb.h>

#include <string>

#include "boundary_pair.h"
#include "innermap/field/field_file.h"

namespace innermap::tool {

// Throws FileError for what is not the file of a map with its boundary.
FieldFile readMap(const std::string& path, Context& context);

// The boundaries that the fit had, which stand in the file.
BoundaryPair boundaryOf(const FieldFile& file, const std::string& path, Context& context);

// The solid that the target bounds.
Solid targetSolid(const BoundaryPair& pair, Context& context);

// The map's settings and certificate as metadata of grids made with it (prefix innermap_).
void describeMap(const openvdb::GridPtrVec& grids, const FieldFile& file);

// Accuracy of sums of charges, well below the map's own error as its file states that; a fraction
// of the target's diagonal.
double sumAccuracy(const FieldFile& file);

// The same for a map whose boundary error has that root mean square.
double sumAccuracy(double boundaryErrorRms);

}  // namespace innermap::tool
