#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/base64.h"
#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/animation/detail/gltf_scene.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using Json = nlohmann::json;
using testing::TemporaryFolder;

// A file under construction: accessors of one buffer.
class Builder {
 public:
  int floats(const std::string& type, const std::vector<float>& values, int width) {
    return add(type, 5126, values.data(), 4 * values.size(), values.size() / width);
  }
  int bytes(const std::string& type, const std::vector<std::uint8_t>& values, int width) {
    return add(type, 5121, values.data(), values.size(), values.size() / width);
  }

  std::string text() {
    std::ostringstream data;
    { Base64Writer(data).addBytes(buffer_); }
    json["buffers"] = {{{"byteLength", buffer_.size()},
                        {"uri", "data:application/octet-stream;base64," + data.str()}}};
    return json.dump();
  }
  std::string binary() {
    json["buffers"] = {{{"byteLength", buffer_.size()}}};
    std::string body = json.dump();
    body.resize((body.size() + 3) / 4 * 4, ' ');
    std::string data = buffer_;
    data.resize((data.size() + 3) / 4 * 4, '\0');
    const auto word = [](std::size_t n) {
      const auto value = static_cast<std::uint32_t>(n);
      return std::string(reinterpret_cast<const char*>(&value), 4);
    };
    return "glTF" + word(2) + word(28 + body.size() + data.size()) + word(body.size()) + "JSON" +
           body + word(data.size()) + std::string("BIN\0", 4) + data;
  }

  Json json = {{"asset", {{"version", "2.0"}}}};

 private:
  int add(const std::string& type, int component, const void* bytes, std::size_t size,
          std::size_t count) {
    buffer_.resize((buffer_.size() + 3) / 4 * 4);
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", size}});
    buffer_.append(static_cast<const char*>(bytes), size);
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"count", count},
                                 {"type", type}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  std::string buffer_;
};

// A tetrahedron whose faces have vertices of their own: 12 in the file. Its apex (0, 0, 1) hangs on
// joint 1, the rest on joint 0; target 0 moves the apex by (0, 1, 0).
Builder tetrahedron() {
  const float p[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  std::vector<float> places, weights, target;
  std::vector<std::uint8_t> joints, corners;
  for (const auto& face : faces)
    for (const int v : face) {
      places.insert(places.end(), p[v], p[v] + 3);
      target.insert(target.end(), {0.0f, v == 3 ? 1.0f : 0.0f, 0.0f});
      joints.insert(joints.end(), {static_cast<std::uint8_t>(v == 3), 0, 0, 0});
      weights.insert(weights.end(), {0.5f, 0, 0, 0});
      corners.push_back(static_cast<std::uint8_t>(corners.size()));
    }
  Builder b;
  const int position = b.floats("VEC3", places, 3), joint = b.bytes("VEC4", joints, 4),
            weight = b.floats("VEC4", weights, 4), moved = b.floats("VEC3", target, 3),
            index = b.bytes("SCALAR", corners, 1);
  b.json["meshes"] = {
      {{"name", "tetra"},
       {"primitives",
        {{{"attributes", {{"POSITION", position}, {"JOINTS_0", joint}, {"WEIGHTS_0", weight}}},
          {"indices", index},
          {"targets", {{{"POSITION", moved}}}}}}}}};
  b.json["nodes"] = {{{"name", "body"}, {"mesh", 0}, {"translation", {5, 0, 0}}},
                     {{"name", "root"}, {"children", {2}}},
                     {{"name", "tip"}}};
  return b;
}

void animate(Builder& b, const std::string& name, int node, const std::string& path,
             const std::string& how, const std::vector<float>& times,
             const std::vector<float>& values, int width) {
  const int input = b.floats("SCALAR", times, 1);
  const int output = b.floats(width == 1 ? "SCALAR" : "VEC" + std::to_string(width), values, width);
  b.json["animations"].push_back(
      {{"name", name},
       {"samplers", {{{"input", input}, {"output", output}, {"interpolation", how}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}}});
}

// Of the joints: the first at rest, the second's place over time.
Builder skinned() {
  Builder b = tetrahedron();
  b.json["skins"] = {{{"joints", {1, 2}}}};
  b.json["nodes"][0]["skin"] = 0;
  animate(b, "lift", 2, "translation", "LINEAR", {0, 1}, {0, 0, 0, 0, 0, 4}, 3);
  return b;
}

class Gltf : public ::testing::Test {
 protected:
  Vec3 apex(const std::string& path, std::int64_t number, AnimationSettings settings = {}) const {
    const auto source = openFrames({path}, settings);
    const auto at = std::find(source->numbers.begin(), source->numbers.end(), number);
    const Mesh rest = readRestPose(path, settings);
    return source->read(static_cast<std::size_t>(at - source->numbers.begin()), rest)
        .vertices[apexOf(path)];
  }

  // By its place as bound: the one with z = 1.
  std::size_t apexOf(const std::string& path) const {
    const Mesh mesh = readRestPose(path);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      if (mesh.vertices[v].z > 0.9) return v;
    return 0;
  }

  std::string refusal(const Builder& builder) {
    Builder b = builder;
    return refusalOf(b.text());
  }
  std::string refusalOf(const std::string& content) {
    const std::string path = folder_.write("a.gltf", content);
    return test::refusalOf([&] { openFrames({path})->read(0, readRestPose(path)); });
  }

  TemporaryFolder folder_;
};

void expectPlace(const Vec3& p, double x, double y, double z) {
  EXPECT_NEAR(p.x, x, 1e-6);
  EXPECT_NEAR(p.y, y, 1e-6);
  EXPECT_NEAR(p.z, z, 1e-6);
}

TEST_F(Gltf, SplitVerticesAreOneAndTheMeshCloses) {
  Builder b = skinned();
  for (const std::string& path :
       {folder_.write("a.gltf", b.text()), folder_.write("a.GLB", b.binary())}) {
    const Mesh mesh = readRestPose(path);
    EXPECT_EQ(mesh.vertices.size(), 4u);
    EXPECT_EQ(mesh.triangles.size(), 4u);
    EXPECT_NEAR(signedVolume(mesh), 1.0 / 6, 1e-12);
    const AnimationInfo info = readAnimationInfo(path);
    ASSERT_EQ(info.meshes.size(), 1u);
    EXPECT_EQ(info.meshes[0].stored, 12u);
    EXPECT_EQ(info.meshes[0].joints, 2u);
    ASSERT_EQ(info.animations.size(), 1u);
    EXPECT_EQ(info.animations[0].end, 1);
  }
}

// The weights are 0.5 each: shares of their sum. The node's own place does not count.
TEST_F(Gltf, JointsPull) {
  const std::string path = folder_.write("a.gltf", skinned().text());
  const auto source = openFrames({path});
  ASSERT_EQ(source->numbers.size(), 25u);
  EXPECT_EQ(source->numbers.front(), 0);
  expectPlace(apex(path, 0), 0, 0, 1);
  expectPlace(apex(path, 6), 0, 0, 2);
  expectPlace(apex(path, 24), 0, 0, 5);
  AnimationSettings settings;
  settings.space.up = UpAxis::z;
  settings.firstFrame = 100;
  expectPlace(apex(path, 112, settings), 0, -3, 0);
  settings = {};
  settings.restFrame = 24;
  EXPECT_NEAR(boundingBox(readRestPose(path, settings)).upper.z, 5, 1e-6);
  settings.restFrame = 25;
  EXPECT_THROW(readRestPose(path, settings), SettingError);
}

// Without a skin the node and those above it place the mesh; targets go with their weights.
TEST_F(Gltf, NodesAndMorphTargetsMove) {
  Builder b = tetrahedron();
  b.json["nodes"][1]["children"] = {0};
  const float half = std::sqrt(0.5f);
  animate(b, "turn", 1, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, half, half}, 4);
  animate(b, "bulge", 0, "weights", "STEP", {0, 0.5f}, {0.25f, 1}, 1);
  const std::string path = folder_.write("a.gltf", b.text());
  expectPlace(apex(path, 0), 5, 0.25, 1);
  // 45 degrees about z of (5, 1, 1), as the step is at frame 12.
  expectPlace(apex(path, 12), 4 * std::sqrt(0.5), 6 * std::sqrt(0.5), 1);
  expectPlace(apex(path, 24), -1, 5, 1);
}

TEST_F(Gltf, SplinesFollowTheirTangents) {
  Builder b = skinned();
  b.json.erase("animations");
  // Tangent in, value, tangent out of each: from 0 with slope 6 to 1 with slope 0, in 2 seconds.
  std::vector<float> keys(18, 0.0f);
  keys[8] = 6;
  keys[14] = 1;
  animate(b, "wave", 2, "translation", "CUBICSPLINE", {1, 3}, keys, 3);
  const std::string path = folder_.write("a.gltf", b.text());
  EXPECT_EQ(openFrames({path})->numbers.front(), 24);
  // Hermite at the middle: 0.5 + 2 * 6 / 8.
  expectPlace(apex(path, 48), 0, 0, 1 + 0.5 + 1.5);
  expectPlace(apex(path, 72), 0, 0, 2);
}

TEST_F(Gltf, SparseNumbersStandInForOthers) {
  Builder b = skinned();
  const int where = b.bytes("SCALAR", {0}, 1), what = b.floats("VEC3", {0, 0, -1}, 3);
  const int moved = b.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"];
  Json& accessor = b.json["accessors"][moved];
  accessor.erase("bufferView");
  accessor["sparse"] = {
      {"count", 1},
      {"indices",
       {{"bufferView", b.json["accessors"][where]["bufferView"]}, {"componentType", 5121}}},
      {"values", {{"bufferView", b.json["accessors"][what]["bufferView"]}}}};
  b.json["meshes"][0]["weights"] = {1};
  const Mesh mesh = readRestPose(folder_.write("a.gltf", b.text()));
  EXPECT_EQ(mesh.vertices[0].z, -1);  // it moves apart from the others at its place
  EXPECT_EQ(mesh.vertices.size(), 5u);
  accessor["sparse"]["indices"]["byteOffset"] = 1;
  EXPECT_NE(refusal(b), "accepted");
}

TEST_F(Gltf, OneOfSeveralMeshesAndAnimationsIsChosen) {
  Builder b = skinned();
  b.json["nodes"].push_back({{"name", "twin"}, {"mesh", 0}});
  EXPECT_NE(refusal(b).find("--mesh"), std::string::npos);
  animate(b, "drop", 2, "translation", "LINEAR", {0, 2}, {0, 0, 0, 0, 0, -1}, 3);
  const std::string path = folder_.write("a.gltf", b.text());
  test::expectRefused<FileError>([&] { openFrames({path}, {.mesh = "body"}); }, "--animation");
  EXPECT_EQ(openFrames({path}, {.mesh = "body", .animation = "drop"})->numbers.back(), 48);
}

TEST_F(Gltf, DamagedFilesAreRefused) {
  const Builder good = skinned();
  EXPECT_EQ(refusal(good), "accepted");
  const std::vector<std::pair<const char*, Json>> changes{
      {"/asset/version", "1.0"},
      {"/accessors/0/count", 1000000},
      {"/accessors/0/count", -1},
      {"/accessors/0/bufferView", 99},
      {"/accessors/0/byteOffset", 1000000},
      {"/bufferViews/0/byteLength", 1000000},
      {"/bufferViews/0/byteStride", 1 << 30},
      {"/bufferViews/0/buffer", 1},
      {"/meshes/0/primitives/0/attributes/POSITION", 99},
      {"/meshes/0/primitives/0/mode", 1},
      {"/nodes/0/skin", 1},
      {"/nodes/0/mesh", -1},
      {"/nodes/2/children", {1}},
      {"/nodes/2/children", {77}},
      {"/nodes/0/children", {2}},
      {"/nodes/2/matrix", {1, 2}},
      {"/skins/0/joints", {1}},
      {"/skins/0/joints", {1, 99}},
      {"/skins/0/inverseBindMatrices", 0},
      {"/animations/0/samplers/0/input", 0},
      {"/animations/0/channels/0/target/path", "scale "},
      {"/extensionsRequired", {"KHR_draco_mesh_compression"}},
      {"/buffers/0/uri", "../secret.bin"},
      {"/buffers/0/uri", "/etc/hosts"},
      {"/buffers/0/uri", "http://a.b/c.bin"},
      {"/buffers/0/uri", "%2e%2e/secret.bin"},
      {"/buffers/0/uri", "none.bin"}};
  Builder copy = good;
  const Json whole = Json::parse(copy.text());
  for (const auto& [where, value] : changes) {
    Json json = whole;
    json[Json::json_pointer(where)] = value;
    EXPECT_NE(refusalOf(json.dump()), "accepted") << where << " " << value;
  }
  for (const std::string& text : {std::string("{"), std::string("[]"), std::string("glTF")})
    EXPECT_NE(refusalOf(text), "accepted");
  std::string cut = copy.binary();
  cut.resize(cut.size() - 9);
  EXPECT_NE(refusalOf(cut).find("cut short"), std::string::npos);
}

// What a recursive reader's stack does not hold.
TEST_F(Gltf, DeepNestingIsRead) {
  Builder b = skinned();
  std::string text = b.text();
  const std::string deep = std::string(200000, '[') + std::string(200000, ']');
  text.insert(1, "\"extras\":" + deep + ",");
  EXPECT_EQ(refusalOf(text), "accepted");
}

TEST_F(Gltf, OtherMeshesAreRefused) {
  const std::string path = folder_.write("a.gltf", skinned().text());
  const auto source = openFrames({path});
  EXPECT_THROW(source->requireLike(testing::cube()), DataError);
  Mesh turned = readRestPose(path);
  std::reverse(turned.vertices.begin(), turned.vertices.end());
  const Mesh last = source->read(24, turned);
  EXPECT_NEAR(last.vertices[3 - apexOf(path)].z, 5, 1e-6);
}

// Frames that Blender exported, against the vertices that it had.
class GltfExports : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << folder_ << " is not there";
    rest_ = readMesh(folder_ + "cylinder_rest.obj");
    std::ifstream file(folder_ + "cylinder_expected_frames.npy", std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
  }

  // number: from 1.
  Points expected(std::int64_t number) const {
    const std::size_t points = rest_.vertices.size(), frame = points * 12;
    Points out;
    for (std::size_t v = 0; v < points; ++v) {
      float p[3];
      const std::size_t at = bytes_.size() - static_cast<std::size_t>(11 - number) * frame + v * 12;
      std::memcpy(p, bytes_.data() + at, 12);
      out.push_back({p[0], p[1], p[2]});
    }
    return out;
  }

  // The largest distance, fractions of the diagonal, of these frames.
  double error(const std::string& name, UpAxis up, const std::vector<std::int64_t>& numbers) const {
    AnimationSettings settings;
    settings.space.up = up;
    const auto source = openFrames({folder_ + name}, settings);
    EXPECT_EQ(readRestPose(folder_ + name, settings).vertices.size(), rest_.vertices.size());
    double worst = 0;
    for (const std::int64_t number : numbers) {
      const auto at = std::find(source->numbers.begin(), source->numbers.end(), number);
      const Mesh frame =
          source->read(static_cast<std::size_t>(at - source->numbers.begin()), rest_);
      const Points wanted = expected(number);
      for (std::size_t v = 0; v < wanted.size(); ++v)
        worst = std::max(worst, norm(frame.vertices[v] - wanted[v]));
    }
    return worst / boundingBox(rest_).diagonal();
  }

  const std::string folder_ = std::string(INNERMAP_MODELS) + "/../hosts/exports/";
  Mesh rest_;
  std::string bytes_;
};

TEST_F(GltfExports, SkinsAreBlendersOwn) {
  for (const char* name :
       {"cylinder_skin.glb", "cylinder_skin.gltf", "cylinder_skin_embedded.gltf"})
    EXPECT_LT(error(name, UpAxis::z, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}), 1e-6) << name;
  EXPECT_LT(error("cylinder_skin_zup.glb", UpAxis::y, {1, 5, 10}), 1e-6);
}

// Its shape is that of frame 10, its targets are frames 4, 7 and 10.
TEST_F(GltfExports, MorphTargetsAreBlendersOwn) {
  rest_.vertices = expected(10);
  EXPECT_LT(error("cylinder_morph.glb", UpAxis::z, {4, 7, 10}), 1e-6);
}

}  // namespace
}  // namespace innermap
