#include <gtest/gtest.h>

#include "core/expect.h"
#include "fit/blobs.h"
#include "innermap/core/error.h"
#include "innermap/correspond/mesh_correspondence.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using testing::TemporaryFolder;

struct Balls {
  LaidOutMesh a = layOutMesh(shapes::blob("a.obj", 1, 0.3));
  LaidOutMesh b = layOutMesh(shapes::blob("b.obj", 2, 0.5));
};

// What reading and placing says of a file of this text.
std::string refusalOf(const std::string& text) {
  static const Balls balls;
  const TemporaryFolder folder;
  const std::string path = folder.write("pairs.txt", text);
  return test::refusalOf<FileError>([&] { placeLandmarks(readLandmarks(path), balls.a, balls.b); });
}

TEST(ReadLandmarks, TakesVerticesPointsAndBoth) {
  const TemporaryFolder folder;
  const LandmarkList list =
      readLandmarks(folder.write("pairs.txt",
                                 "# A, B\n1 2\r\n\n0.5, 1e-3; -2 4 5 6  # points\nv3 1 2 3\n"
                                 "1 2 3 V4\n"));
  EXPECT_EQ(list.name, folder.file("pairs.txt"));
  ASSERT_EQ(list.pairs.size(), 4u);
  EXPECT_EQ(list.pairs[0].line, 2u);
  EXPECT_EQ(list.pairs[0].onA.vertex, 1);
  EXPECT_EQ(list.pairs[0].onB.vertex, 2);
  EXPECT_EQ(list.pairs[1].line, 4u);
  EXPECT_FALSE(list.pairs[1].onA.vertex);
  EXPECT_EQ(list.pairs[1].onA.point.y, 1e-3);
  EXPECT_EQ(list.pairs[1].onB.point.z, 6);
  EXPECT_EQ(list.pairs[2].onA.vertex, 3);
  EXPECT_EQ(list.pairs[2].onB.point.x, 1);
  EXPECT_EQ(list.pairs[3].onA.point.z, 3);
  EXPECT_EQ(list.pairs[3].onB.vertex, 4);
}

TEST(Landmarks, FileAndLineOfWhatIsRefusedAreNamed) {
  const std::vector<std::vector<std::string>> cases = {
      {"", "is empty"},
      {"# nothing\n", "no landmarks"},
      {"1 2\n3\n", "line 2", "1 numbers"},
      {"1 2 3\n", "line 1"},
      {"1 2 3 4\n", "line 1", "v12"},
      {"1 x\n", "line 1", "'x'"},
      {"1 \x7f\x01\n", "line 1", "'?'"},
      {"-1 2\n", "line 1", "counted from 0"},
      {"1.5 2\n", "line 1", "1.5"},
      {"99999999999999999999 2\n", "line 1"},
      {"nan 0 0 1 0 0\n", "line 1", "nan"},
      {std::string(5000, '1') + " 2\n", "line 1", "too long"},
      // Places that cannot be.
      {"42 1\n", "line 1", "42", "a.obj"},
      {"# c\n1 162\n", "line 2", "162", "b.obj"},
      {"0 0 0 0 0 0\n", "line 1", "away from", "a.obj"},
      {"1 2\n1 3\n", "line 2", "line 1", "a.obj"},
      {"1 2\n\n3 2\n", "line 3", "line 1", "b.obj"}};
  for (const std::vector<std::string>& words : cases) {
    const std::string message = refusalOf(words[0]);
    EXPECT_NE(message.find("pairs.txt: "), std::string::npos) << words[0];
    for (std::size_t i = 1; i < words.size(); ++i)
      EXPECT_NE(message.find(words[i]), std::string::npos) << words[i] << " in " << message;
  }
  EXPECT_THROW(readLandmarks("no such file.txt"), FileError);
}

TEST(PlaceLandmarks, CountsThePairsOfAListThatIsFromNoFile) {
  const Balls balls;
  LandmarkList list;
  list.pairs.resize(2);
  list.pairs[0].onA.vertex = list.pairs[0].onB.vertex = 0;
  list.pairs[1].onA.vertex = 1;
  list.pairs[1].onB.vertex = 5000;
  const std::string said =
      test::refusalOf<FileError>([&] { placeLandmarks(list, balls.a, balls.b); });
  EXPECT_EQ(said.find("landmarks: pair 2: "), 0u) << said;
}

TEST(PlaceLandmarks, FindsVerticesExactlyAndPointsAtTheNearestVertex) {
  const Balls balls;
  const Mesh &a = balls.a.mesh, &b = balls.b.mesh;
  LandmarkList list;
  list.pairs.resize(2);
  list.pairs[0].onA.vertex = 7;
  list.pairs[0].onB.vertex = 30;
  const Triangle& t = a.triangles[5];
  list.pairs[1].onA.point =
      0.8 * a.vertices[t[0]] + 0.1 * a.vertices[t[1]] + 0.1 * a.vertices[t[2]];
  list.pairs[1].onB.point = positionOf(b, {9, {0.2, 0.3, 0.5}});
  const PlacedLandmarks placed = placeLandmarks(list, balls.a, balls.b);
  ASSERT_EQ(placed.landmarks.size(), 2u);
  EXPECT_EQ(placed.landmarks[0].vertex, 7);
  EXPECT_EQ(norm(positionOf(b, placed.landmarks[0].onTarget) - b.vertices[30]), 0);
  EXPECT_EQ(placed.landmarks[1].vertex, t[0]);
  EXPECT_LT(norm(positionOf(b, placed.landmarks[1].onTarget) - list.pairs[1].onB.point), 1e-12);
  EXPECT_NE(placed.note.find("a.obj"), std::string::npos) << placed.note;
  EXPECT_NE(placed.note.find("pair 2"), std::string::npos) << placed.note;
  EXPECT_TRUE(placed.far);
}

}  // namespace
}  // namespace innermap
