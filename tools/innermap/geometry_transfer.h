// Geometry in place of volumes: what `pull`, `push` and `deform` share.
#pragma once

#include <memory>
#include <string>

#include "command.h"
#include "innermap/io/geometry_file.h"
#include "innermap/transfer/inverse_map.h"
#include "transfer_options.h"

namespace innermap::tool {

struct GeometryOptions {
  std::string vectors, normals;  // names with commas between
  double subdivide = 0;          // fraction of the diagonal of what is carried to
  SplatOpacity splats = SplatOpacity::look;
};

// subdivide: whether edges may be split.
void addGeometryOptions(Command& command, GeometryOptions& options, bool subdivide);

// Throws UsageError for options of volumes given with geometry and the other way round, and
// FileError for an output of another kind than the input.
void requireFitting(const std::string& input, const std::string& output,
                    const TransferOptions& transfer, const GeometryOptions& geometry);

// Timed, with its notes.
std::unique_ptr<GeometryFile> readGeometryFile(const std::string& path,
                                               const GeometryOptions& options, Context& context);

// Warns of what went wrong. part: "frame 7: " or nothing.
void warnOf(const CarriedGeometry& carried, const TransferOptions& options, const std::string& part,
            Context& context);

// Fills the report's "geometry"; the lines for the terminal.
std::string reportGeometry(const CarriedGeometry& carried, Context& context);

// Timed; fields that the format cannot hold are warned of.
void writeGeometryFile(const std::string& path, const GeometryFile& file,
                       const CarriedGeometry& carried, Context& context);

}  // namespace innermap::tool
