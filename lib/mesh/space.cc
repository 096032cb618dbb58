// Axes and units of files.
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"

namespace innermap {
namespace {

Similarity between(UpAxis fromUp, double fromUnit, UpAxis toUp, double toUnit) {
  Similarity out;
  out.quarters = fromUp == toUp ? 0 : toUp == UpAxis::z ? 1 : -1;
  out.scale = fromUnit / toUnit;
  return out;
}

}  // namespace

std::vector<Setting> describe(SpaceSettings& s) {
  const std::vector<std::pair<std::string, std::optional<UpAxis>>> axes{{"y", UpAxis::y},
                                                                        {"z", UpAxis::z}};
  constexpr double kMost = 1e9;
  return {
      Setting("up", "AXIS", choiceOf(&s.up, axes),
              "axis that points up in the input files; glTF, which has y up, is turned to match")
          .otherwise("y"),
      Setting("unit_scale", "L", &s.unitScale,
              "length of one unit in the input files; glTF, in metres, is scaled to match")
          .in("metres")
          .above(0, kMost)
          .otherwise("1"),
      Setting("out_up", "AXIS", choiceOf(&s.outUp, axes), "axis that points up in the output files")
          .otherwise("as {up}"),
      Setting("out_unit_scale", "L", &s.outUnitScale, "length of one unit in the output files")
          .in("metres")
          .above(0, kMost)
          .otherwise("as {unit_scale}")};
}

Mat3 Similarity::matrix() const {
  Mat3 out{};
  for (int column = 0; column < 3; ++column) {
    Vec3 unit;
    unit[column] = 1;
    const Vec3 image = (*this)(unit);
    for (int row = 0; row < 3; ++row) out[row][column] = image[row];
  }
  return out;
}

Similarity inputToOutput(const SpaceSettings& s) {
  requireDescribed(s);
  return between(s.up.value_or(UpAxis::y), s.unitScale.value_or(1), s.upOfOutput(),
                 s.unitOfOutput());
}

Similarity gltfToOutput(const SpaceSettings& s) {
  requireDescribed(s);
  return between(UpAxis::y, 1, s.upOfOutput(), s.unitOfOutput());
}

void move(Points& points, const Similarity& by) {
  if (by.isIdentity()) return;
  for (Vec3& p : points) p = by(p);
}

Mesh readMesh(const std::string& path, const SpaceSettings& space) {
  if (isGltf(path)) {
    AnimationSettings settings;
    settings.space = space;
    return readRestPose(path, settings);
  }
  Mesh mesh = readMesh(path);
  move(mesh.vertices, inputToOutput(space));
  requireNearOrigin(mesh);
  return mesh;
}

}  // namespace innermap
