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

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/core/version.h"
#include "innermap/correspond/mesh_correspondence.h"
#include "innermap/evaluate/grids.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/frame_fitter.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/fit/surface_problem.h"
#include "innermap/io/cell_file.h"
#include "innermap/io/geometry_file.h"
#include "innermap/io/pictures.h"
#include "innermap/io/vdb_file.h"
#include "innermap/levelset/level_set.h"
#include "innermap/mesh/check.h"
#include "innermap/mesh/mesh_file.h"
#include "innermap/texture/solid_texture.h"
#include "innermap/transfer/carry.h"
#include "innermap/transfer/geometry.h"
#include "innermap/transfer/inverse_map.h"
#include "innermap/transfer/push_pull.h"
