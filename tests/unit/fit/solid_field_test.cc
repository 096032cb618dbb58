#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "innermap/fit/fit_harmonic.h"
#include "mesh/shapes.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using testing::TemporaryFolder;

SolidField known() {
  SourceBoundary boundary = makeSourceBoundary(shapes::icosphere(2));
  BoundaryConditions conditions;
  conditions.function = [](const Points& points) {
    Matrix out(points.size(), 2);
    for (std::size_t i = 0; i < points.size(); ++i) {
      out(i, 0) = points[i].x * points[i].y;
      out(i, 1) = points[i].z;
    }
    return out;
  };
  const HarmonicFit fit = fitHarmonic(boundary, conditions, {.tolerance = 1e-2, .seed = 7});
  Facts facts =
      harmonicFacts(fit, {.tolerance = 1e-2, .seed = 7}, "ball.obj", {"saddle", "height"});
  return {fit.field, std::move(boundary), {"saddle", "height"}, std::move(facts)};
}

HarmonicFit fitOf(const SolidField& field) {
  return {field.field, 1, {}, 0, true, AdaptiveEnd::met, 0, 0, 0, {}, {}, {}};
}

TEST(SolidField, ComesBackFromItsFile) {
  const TemporaryFolder folder;
  const std::string path = folder.file("field.ply");
  const SolidField field = known();
  writeSolidField(path, field);
  const SolidField back = readSolidField(path);
  EXPECT_EQ(back.names, field.names);
  EXPECT_EQ(back.facts, field.facts);
  EXPECT_EQ(back.boundary.mesh.name, "ball.obj");
  EXPECT_EQ(back.boundary.mesh.triangles, field.boundary.mesh.triangles);
  EXPECT_TRUE(tellOfField(back.facts));
  const Points at = {{0.1, 0.2, 0.3}};
  const Matrix a = field.field.evaluate(at).values, b = back.field.evaluate(at).values;
  EXPECT_DOUBLE_EQ(a(0, 0), b(0, 0));
  EXPECT_NEAR(b(0, 0), 0.02, 1e-2);
  EXPECT_NEAR(b(0, 1), 0.3, 1e-2);
}

TEST(SolidField, RefusesOtherFiles) {
  const TemporaryFolder folder;
  const std::string path = folder.file("field.ply");
  SolidField field = known();
  EXPECT_THROW(harmonicFacts(fitOf(field), {}, "ball.obj", {"one"}), DataError);
  EXPECT_THROW(harmonicFacts(fitOf(field), {}, "ball.obj", {"a,b", "c"}), DataError);
  Facts facts = field.facts;
  for (auto& [key, value] : field.facts)
    if (key == "channels") value = "one";
  writeSolidField(path, field);
  EXPECT_THROW(readSolidField(path), FileError);
  facts.erase(facts.begin() + 2);
  field.facts = facts;
  writeSolidField(path, field);
  EXPECT_FALSE(tellOfField(readField(path).facts));
  EXPECT_THROW(readSolidField(path), FileError);
}

}  // namespace
}  // namespace innermap
