// Options that say how fine the grids that a command writes are, and what they are called.
#pragma once

#include <openvdb/openvdb.h>

#include <string>

#include "command.h"
#include "innermap/evaluate/grids.h"
#include "innermap/io/vdb_file.h"
#include "innermap/levelset/level_set.h"

namespace innermap::tool {

void writeGridFile(const std::string& path, const openvdb::GridPtrVec& grids,
                   const NamingScheme& names, Context& context,
                   const openvdb::MetaMap& metadata = {});

// What `evaluate`, `map` and `sequence` share.
struct EvaluationOptions {
  LatticeChoice grid;
  LameConstants lame;
  RepairFolds repair = RepairFolds::automatic;
  NamingScheme names = NamingScheme::innermap;
};

void addEvaluationOptions(Command& command, EvaluationOptions& options);

MapGridSettings mapGridSettings(const EvaluationOptions& options);

}  // namespace innermap::tool
