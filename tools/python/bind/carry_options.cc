#include "bind/carry_options.h"

#include "bind/arrays.h"
#include "bind/errors.h"
#include "bind/lists.h"
#include "innermap/transfer/geometry.h"
#include "report/figures.h"

namespace py = pybind11;
using namespace py::literals;

namespace innermap::python {
namespace {

RigidMotion motionFrom(const py::object& object) {
  const Matrix m = matrixFrom(object, "fade_to");
  if (m.columns() != 4 || (m.rows() != 3 && m.rows() != 4))
    wrongValue("fade_to", "expects 'cut', 'identity', 'fitted' or a 3 x 4 or 4 x 4 matrix");
  RigidMotion motion;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) motion.rotation[r][c] = m(r, c);
    motion.translation[static_cast<int>(r)] = m(r, 3);
  }
  if (!isRigid(motion)) wrongValue("fade_to", "is no rigid motion");
  return motion;
}

}  // namespace

void describeOutside(Keywords& k, double* outside, py::object* fadeTo) {
  k.setting(outsideSetting(outside));
  k.object("fade_to", fadeTo, "str or array",
           "what the map fades to with outside: 'cut' (it ends there, the default), 'identity', "
           "'fitted' (the best rigid motion of the surface), or a rigid motion, (3, 4) or (4, 4)");
}

void CarryOptions::describe(Keywords& k) {
  k.object("grids", &grids, "str or Sequence[str]",
           "names of the grids to carry; all if not given");
  k.object("densities", &densities, "bool or Sequence[str]",
           "scalars that are densities, divided by the change of volume; pushed, their mass is "
           "kept; True: all scalars");
  k.object("stresses", &stresses, "str or Sequence[str]",
           "Cauchy stresses: NAME stands for the six grids NAME.xx, .yy, .zz, .xy, .yz, .xz or the "
           "rows NAME.x, .y, .z");
  k.object("strains", &strains, "str or Sequence[str]", "the same for covariant strains");
  k.settings(innermap::describe(carrySettings));
  describeOutside(k, &outside, &fadeTo);
  k.object("vectors", &vectors, "str or Sequence[str]",
           "of geometry: properties or fields that are vectors, turned by the Jacobian");
  k.object(
      "normals", &normals, "str or Sequence[str]",
      "of geometry: those that are normals, which the inverse transpose of the Jacobian turns");
  k.setting(splatsSetting(&splats));
  k.settings(innermap::describe(lattice, "the solid", "as fine as those of the grids"));
  k.setting(namesSetting(&names));
  call.describe(k);
}

CarrySettings CarryOptions::carry() const {
  CarrySettings out = carrySettings;
  if (py::isinstance<py::bool_>(densities))
    out.allDensities = py::cast<bool>(densities);
  else
    out.densities = textsFrom(densities, "densities");
  out.stresses = textsFrom(stresses, "stresses");
  out.strains = textsFrom(strains, "strains");
  return out;
}

FadeTo fadeToFrom(double outside, const py::object& fadeTo) {
  const bool isText = py::isinstance<py::str>(fadeTo);
  const std::string text = isText ? textFrom(fadeTo, "fade_to") : "cut";
  if (fadeTo.is_none() || (isText && text == "cut")) return {};
  if (!(outside > 0)) wrongValue("fade_to", "is for what lies outside; give outside too");
  if (!isText) return {motionFrom(fadeTo)};
  if (text == "identity") return {RigidMotion()};
  if (text == "fitted") return {{}, true};
  wrongValue("fade_to", "expects 'cut', 'identity', 'fitted' or a rigid motion's matrix");
}

py::dict totalsOf(const PushResult& result) {
  py::dict out, masses;
  for (const CarriedMass& mass : result.masses) {
    py::dict of("before"_a = mass.before, "after"_a = mass.after, "left"_a = mass.left,
                "cut"_a = mass.cut, "largest_ratio"_a = mass.largestRatio);
    masses[mass.name.c_str()] = of;
  }
  out["mass"] = masses;
  if (result.inverted) {
    out["voxels"] = result.statistics.voxels;
    out["inverted_fraction"] = result.statistics.invertedInside();
    out["not_inverted"] = result.statistics.failedInside;
  }
  out["coarser_share"] = result.resampling.coarserShare;
  out["warnings"] = result.warnings;
  return out;
}

ReadGeometrySettings geometrySettings(const CarryOptions& o) {
  ReadGeometrySettings out;
  out.vectors = textsFrom(o.vectors, "vectors");
  out.normals = textsFrom(o.normals, "normals");
  return out;
}

Figures carryFile(const std::string& from, const std::string& to,
                  const ReadGeometrySettings& reading, const CarryGeometrySettings& settings,
                  const PointCarry& carry) {
  const auto file = readGeometry(from, reading);
  const CarriedGeometry carried = carryGeometry(*file, carry, settings);
  Figures out = figures(carried);
  out.emplace_back("fields_lost", writeGeometry(to, *file, carried), "fields lost");
  return out;
}

}  // namespace innermap::python
