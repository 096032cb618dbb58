// What most programs need of innermap, in one header. See docs/cpp.md for a tour.
//
//   const Mesh rest = readMesh("rest.obj"), pose = readMeshLike("pose.obj", rest);
//   const MapFit fit = fitMap(rest, pose);            // fit.error is the certificate
//   writeVdb("map.vdb", evaluateOnGrid(fit).all());
//
// Lengths among settings are fractions of the source's bounding-box diagonal unless a name says
// voxel or world; errors are fractions of the target's. All functions throw exceptions derived from
// innermap::Error. Progress, cancelling and time limits are a RunContext's, which the caller enters
// (core/run.h).
#pragma once

#include "innermap/boundary/certificate.h"
#include "innermap/boundary/fit_map.h"
#include "innermap/boundary/frame_fitter.h"
#include "innermap/boundary/mapped_solid.h"
#include "innermap/boundary/mesh_correspondence.h"
#include "innermap/boundary/surface_problem.h"
#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/core/version.h"
#include "innermap/evaluate/map_grids.h"
#include "innermap/io/cells/cell_file.h"
#include "innermap/io/geometry/geometry_file.h"
#include "innermap/io/picture/texture_images.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/levelset/level_set.h"
#include "innermap/mesh/check.h"
#include "innermap/mesh/read.h"
#include "innermap/mesh/write.h"
#include "innermap/texture/solid_texture.h"
#include "innermap/transfer/carry_geometry.h"
#include "innermap/transfer/carry_memory.h"
#include "innermap/transfer/carry_points.h"
#include "innermap/transfer/pull.h"
#include "innermap/transfer/push.h"
