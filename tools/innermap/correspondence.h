// What the commands that lay surfaces out share: options, and results in the report.
#pragma once

#include <functional>
#include <string>

#include "command.h"
#include "innermap/correspond/mesh_correspondence.h"

namespace innermap::tool {

struct SurfaceOptions {
  LayOutSettings layOut;
  bool close = false;  // holes are closed anyway
};

struct CorrespondOptions {
  MeshCorrespondenceSettings map;  // the landmarks are not read yet
  std::string landmarks;
  bool close = false;  // holes are closed anyway
};

void addSurfaceOptions(Command& command, SurfaceOptions& options);
// Without --seed.
void addCorrespondOptions(Command& command, CorrespondOptions& options);

// Lays the mesh out and tells: notes, seconds.
LaidOutMesh layOut(Mesh mesh, const SurfaceOptions& options, Context& context);

// The mesh, or the outer surface of its solid where that is needed; tells as layOut(), with the
// report's "outer_surface".
Mesh takeCleanSurface(Mesh mesh, const LayOutSettings& settings, Context& context);
Mesh readCleanSurface(const std::string& path, const SurfaceOptions& options, Context& context);

// The report's "source" or "target".
void reportLaidOut(const std::string& section, const LaidOutMesh& mesh, Report& report);

// The picture of a correspondence at `path`; where there is another way that is about as good, its
// picture at otherPicture(path). Both through `write`, which is given a path and what writes there.
using WritePicture =
    std::function<void(const std::string& path, const std::function<void(const std::string&)>&)>;
void writeCorrespondencePictures(const std::string& path, const MeshCorrespondence& map,
                                 const WritePicture& write);
// picture.png -> picture.other.png
std::string otherPicture(const std::string& path);

// Maps A onto B and tells: notes, the report's "correspondence" and "seconds", a text for the
// terminal.
MeshCorrespondence correspondMeshes(Mesh a, Mesh b, const CorrespondOptions& options,
                                    Context& context);

}  // namespace innermap::tool
