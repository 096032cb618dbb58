// innermap.Grids: grids of one lattice, sparse until they are asked for as arrays.
#pragma once

#include <openvdb/openvdb.h>
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "bind/call.h"
#include "innermap/io/vdb_file.h"
#include "innermap/levelset/level_set.h"

namespace innermap::python {

class Keywords;

void bindGrids(pybind11::module_& m);

// None, once the file is there. Throws as writeVdb().
pybind11::object writeGrids(const std::string& path, const openvdb::GridPtrVec& grids,
                            NamingScheme names, const CallOptions& call);

// The grids, which have one transform, as an innermap.Grids. totals: numbers about them.
pybind11::object gridsObject(openvdb::GridPtrVec grids, const pybind11::dict& totals,
                             const CallOptions& call);

// An innermap.Grids or the path of a .vdb file; those of these names (none: all) in their order.
// Throws DataError, as readVdb().
openvdb::GridPtrVec takeGrids(const pybind11::object& grids, const std::string& argument,
                              const std::vector<std::string>& names, const CallOptions& call);
bool isGrids(pybind11::handle object);

}  // namespace innermap::python
