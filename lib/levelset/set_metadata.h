// Metadata of grids that may have some already.
#pragma once

#include <openvdb/openvdb.h>

#include <string>

namespace innermap {

// MetaMap::insertMeta() throws where there is a value of another type: a grid that is carried
// through one map may have been made with another, or by any program.
inline void setMetadata(openvdb::MetaMap& map, const std::string& name,
                        const openvdb::Metadata& value) {
  map.removeMeta(name);
  map.insertMeta(name, value);
}

}  // namespace innermap
