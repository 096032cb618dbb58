// What push(), pull() and deform() share.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "bind/figures.h"
#include "bind/grids.h"
#include "bind/keywords.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/io/geometry_file.h"
#include "innermap/levelset/level_set.h"
#include "innermap/transfer/inverse_map.h"
#include "innermap/transfer/push_pull.h"
#include "jobs/carry_job.h"

namespace innermap::python {

void bindCarry(pybind11::module_& m);  // after bindMap, bindGrids and bindCells

struct CarryOptions {
  pybind11::object grids, densities, stresses, strains, fadeTo, vectors, normals;
  CarrySettings carrySettings;  // but for the names
  SplatOpacity splats = SplatOpacity::look;
  double outside = 0;
  LatticeChoice lattice;
  NamingScheme names = NamingScheme::innermap;
  CallOptions call;

  void describe(Keywords& k);

  CarrySettings carry() const;
};

// Keywords outside and fade_to, and what the latter says.
void describeOutside(Keywords& k, double* outside, pybind11::object* fadeTo);
FadeTo fadeToFrom(double outside, const pybind11::object& fadeTo);

// What became of grids, for Grids.totals.
pybind11::dict totalsOf(const PushResult& result);

// What a file of geometry or cells is read with.
ReadGeometrySettings geometrySettings(const CarryOptions& o);

// A file carried and written, and what became of it. Without the lock of the interpreter.
Figures carryFile(const std::string& from, const std::string& to,
                  const ReadGeometrySettings& reading, const CarryGeometrySettings& settings,
                  const PointCarry& carry);

}  // namespace innermap::python
