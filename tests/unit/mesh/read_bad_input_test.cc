// Broken, lying and hostile files: always a one-line FileError, quickly; never a crash.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cstring>
#include <filesystem>

#include "core/expect.h"
#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using testing::TemporaryFolder;

std::string ply(const std::string& vertices, const std::string& faces, const std::string& body,
                const std::string& format = "ascii") {
  return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n" + body;
}

std::string stlHeader(std::uint32_t count) {
  std::string bytes(84, '\0');
  std::memcpy(&bytes[80], &count, 4);
  return bytes;
}

struct BadFile {
  const char* name;
  std::string content;
  const char* expected;  // the place or number that the message names
};

std::vector<BadFile> badFiles() {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const std::string facet = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n";
  const std::string noise("\x7f\x45\x4c\x46\x02\x00\x00\xff\xfe\x0a\x00garbage\x00", 20);
  return {
      {"empty.obj", "", ""},
      {"noise.obj", noise, ""},
      {"nan.obj", v + "v nan 0 0\nf 1 2 3\n", "line 4"},
      {"inf.obj", v + "v 0 -inf 0\nf 1 2 3\n", ""},
      {"huge.obj", v + "v 0 1e999 0\nf 1 2 3\n", ""},
      {"malformed.obj", v + "v 1 2,5 3\nf 1 2 3\n", "line 4"},
      {"short.obj", v + "v 1 2\nf 1 2 3\n", "line 4"},
      {"uv.obj", v + "vt x 0\nf 1 2 3\n", "'x'"},
      {"uvnan.obj", v + "vt nan 0\nf 1 2 3\n", ""},
      {"range.obj", v + "f 1 2 4\nf 1 2 3\n", "line 4"},
      {"zero.obj", v + "f 0 1 2\n", "line 4"},
      {"negative.obj", v + "f -4 1 2\n", "-4"},
      {"overflow.obj", v + "f 1 2 99999999999999999999999\n", ""},
      {"wide.obj", v + "f 1 2 4294967297\n", ""},
      {"uvrange.obj", v + "vt 0 0\nf 1/1 2/1 3/2\n", "2"},
      {"letters.obj", v + "f a b c\n", "'a'"},
      {"two.obj", v + "f 1 2\n", "line 4"},
      {"points.obj", v, ""},
      {"long.obj", v + "f 1 2 " + std::string(100000, '7') + "\n", ""},
      {"magic.ply", "plyx\n", "'ply'"},
      {"noise.ply", noise, ""},
      {"cut.ply", "ply\nformat ascii 1.0\n", ""},
      {"format.ply", "ply\nformat ternary 1.0\nend_header\n", ""},
      {"noformat.ply", "ply\nelement vertex 1\nend_header\n", ""},
      {"type.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n", ""},
      {"lying.ply", ply("4000000000", "1", body), ""},
      {"lyingfaces.ply", ply("3", "4000000000", body), ""},
      {"lyingbig.ply", ply("18446744073709551615", "1", body, "binary_big_endian"), ""},
      {"count.ply", ply("99999999999999999999999", "1", body), ""},
      {"minus.ply", ply("-3", "1", body), ""},
      {"list.ply", ply("3", "1", "0 0 0 1 0 0 0 1 0 255 0 1 2"), ""},
      {"listminus.ply", ply("3", "1", "0 0 0 1 0 0 0 1 0 -1 0 1 2"), ""},
      {"listhalf.ply", ply("3", "1", "0 0 0 1 0 0 0 1 0 2.5 0 1 2"), ""},
      {"short.ply", ply("3", "2", body), ""},
      {"range.ply", ply("3", "1", "0 0 0 1 0 0 0 1 0 3 0 1 3"), "3"},
      {"rangeminus.ply", ply("3", "1", "0 0 0 1 0 0 0 1 0 3 0 1 -1"), "-1"},
      {"index.ply", ply("3", "1", "0 0 0 1 0 0 0 1 0 3 0 1 3e9"), ""},
      {"nan.ply", ply("3", "1", "0 0 0 1 nan 0 0 1 0 3 0 1 2"), ""},
      {"nanbinary.ply", ply("1", "0", std::string(12, '\xff'), "binary_little_endian"),
       "not finite"},
      {"two.ply", ply("3", "1", "0 0 0 1 0 0 0 1 0 2 0 1"), ""},
      {"points.ply", ply("3", "0", "0 0 0 1 0 0 0 1 0"), ""},
      {"noxyz.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n",
       "no x, y and z"},
      {"void.ply", "ply\nformat ascii 1.0\nelement void 18446744073709551615\nend_header\n",
       "no vertices"},
      {"magic.off", "FOO\n3 1 0\n", ""},
      {"binary.off", "OFF BINARY\n", ""},
      {"four.off", "4OFF\n3 1 0\n", ""},
      {"empty.off", "# nothing\n", ""},
      {"cut.off", "OFF\n", ""},
      {"lying.off", "OFF\n4000000000 1 0\n0 0 0\n", ""},
      {"minus.off", "OFF\n-1 1 0\n", ""},
      {"short.off", "OFF\n3 2 0\n" + body, ""},
      {"range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "line 6"},
      {"nan.off", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "line 4"},
      {"corners.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2000000000 0 1 2\n", ""},
      {"colour.off", "COFF\n3 1 0\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n", ""},
      {"noise.stl", noise, ""},
      {"lying.stl", stlHeader(4000000000u), "200000000084"},
      {"short.stl", stlHeader(2) + std::string(50, '\0'), ""},
      {"zero.stl", stlHeader(0), ""},
      {"nan.stl", stlHeader(1) + std::string(50, '\xff'), ""},
      {"cut.stl", facet, ""},
      {"corners.stl", facet + "endloop\nendfacet\nendsolid\n", "1"},
      {"keyword.stl", "solid a\nfacets\n", ""},
      {"number.stl", "solid a\nfacet normal 0 0 1\nvertex 0 zero 0\n", "'zero'"},
      {"facet.stl", "solid a\nvertex 0 0 0\n", "line 2"},
      {"mesh.xyz", "0 0 0\n", ""},
      {"mesh", "0 0 0\n", ""},
  };
}

std::string messageOf(const std::string& path) {
  return test::refusalOf<FileError>([&] { readMesh(path); });
}

TEST(ReadBadInput, EachIsRefusedWithTheReason) {
  const TemporaryFolder folder;
  for (const BadFile& bad : badFiles()) {
    SCOPED_TRACE(bad.name);
    const std::string path = folder.write(bad.name, bad.content);
    const auto start = std::chrono::steady_clock::now();
    const std::string message = messageOf(path);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
    EXPECT_EQ(message.substr(0, path.size()), path) << message;
    EXPECT_NE(message.find(bad.expected, path.size()), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
    EXPECT_LT(message.size(), path.size() + 300);
  }
  EXPECT_LT(peakMemory(), 2000000000u);
}

TEST(ReadBadInput, MissingFilesFoldersAndPipes) {
  const TemporaryFolder folder;
  EXPECT_NE(messageOf(folder.file("none.obj")).find("none.obj"), std::string::npos);
  std::filesystem::create_directory(folder.file("dir.obj"));
  EXPECT_NE(messageOf(folder.file("dir.obj")).find("dir.obj"), std::string::npos);
  ASSERT_EQ(mkfifo(folder.file("pipe.obj").c_str(), 0600), 0);
  EXPECT_NE(messageOf(folder.file("pipe.obj")).find("pipe.obj"), std::string::npos);
  EXPECT_NE(messageOf(""), "accepted");
}

// What stands after a list: the list's own length is checked where it begins.
TEST(ReadBadInput, ABinaryPlyIsRefusedWhereverItIsCut) {
  const TemporaryFolder folder;
  const std::string head =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
      "property double quality\nend_header\n";
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::int32_t face[3] = {0, 1, 2};
  const double quality = 0.5;
  std::string bytes = head + std::string(reinterpret_cast<const char*>(corners), sizeof corners);
  for (int f = 0; f < 2; ++f) {
    bytes += '\3';
    bytes.append(reinterpret_cast<const char*>(face), sizeof face);
    bytes.append(reinterpret_cast<const char*>(&quality), sizeof quality);
  }
  EXPECT_EQ(readMesh(folder.write("whole.ply", bytes)).triangles.size(), 2u);
  for (std::size_t size = head.size(); size < bytes.size(); ++size)
    EXPECT_THROW(readMesh(folder.write("cut.ply", bytes.substr(0, size))), FileError) << size;
}

TEST(ReadBadInput, AFileLargerThanTheMemoryIsRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.write("huge.stl", "solid");
  std::error_code error;
  std::filesystem::resize_file(path, 8 * availableMemory(), error);  // sparse
  if (error) GTEST_SKIP() << "no sparse files here: " << error.message();
  EXPECT_THROW(readMesh(path), MemoryError);
}

std::vector<std::pair<std::string, std::string>> validFiles(const TemporaryFolder& folder) {
  Mesh mesh = testing::cube();
  mesh.colours.assign(8, {0.5f, 0.25f, 1});
  mesh.uvs = {{0, 0}, {1, 0}, {0.5, 1}};
  mesh.uvTriangles.assign(mesh.triangles.size(), {0, 1, 2});
  writeMesh(folder.file("a.obj"), mesh);
  writeMesh(folder.file("a.ply"), mesh);
  std::string off = "STCOFF\n8 12 0\n", facets = "solid a\n", binary = stlHeader(12);
  std::string strips =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n6 0 1 2 -1 1 3\n";
  const auto number = [](double x) { return " " + std::to_string(x); };
  for (const Vec3& p : mesh.vertices)
    off += number(p.x) + number(p.y) + number(p.z) + " 255 0 3 0.5 0.5\n";
  for (const Triangle& t : mesh.triangles) {
    facets += "facet normal 0 0 1\nouter loop\n";
    binary += std::string(12, '\0');
    off += "3";
    for (const int v : t) {
      const Vec3& p = mesh.vertices[v];
      off += " " + std::to_string(v);
      facets += "vertex" + number(p.x) + number(p.y) + number(p.z) + "\n";
      for (int a = 0; a < 3; ++a) {
        const float c = static_cast<float>(p[a]);
        binary.append(reinterpret_cast<const char*>(&c), 4);
      }
    }
    off += "\n";
    facets += "endloop\nendfacet\n";
    binary += std::string(2, '\0');
  }
  return {{"b.obj", test::contents(folder.file("a.obj"))},
          {"b.ply", test::contents(folder.file("a.ply"))},
          {"c.ply", strips},
          {"b.off", off},
          {"b.stl", facets + "endsolid a\n"},
          {"c.stl", binary}};
}

// Flips, inserts, removes and cuts bytes at random. What still reads must be a valid mesh.
TEST(ReadBadInput, RandomCorruption) {
  const TemporaryFolder folder;
  int refused = 0, read = 0;
  for (const auto& [name, original] : validFiles(folder)) {
    ASSERT_NO_THROW(readMesh(folder.write(name, original))) << name;
    for (int seed = 0; seed < 600; ++seed) {
      SCOPED_TRACE(name + " seed " + std::to_string(seed));
      const CounterRandom random(seed, original.size());
      std::string bytes = original;
      const int changes = 1 + static_cast<int>(random.bits(0) % 4);
      for (int c = 0; c < changes && !bytes.empty(); ++c) {
        const std::size_t at = random.bits(10 * c + 1) % bytes.size();
        static const char kDigits[] = "0123456789-+.eE \n/nf#\\";
        switch (random.bits(10 * c + 2) % 6) {
          case 0:
            bytes[at] = static_cast<char>(random.bits(10 * c + 3));
            break;
          case 1:
            bytes.erase(at, 1 + random.bits(10 * c + 4) % 3);
            break;
          case 2:
            bytes.insert(at, 1, static_cast<char>(random.bits(10 * c + 3)));
            break;
          case 3:
            bytes.resize(at);
            break;
          default:
            bytes[at] = kDigits[random.bits(10 * c + 3) % (sizeof kDigits - 1)];
        }
      }
      try {
        validate(readMesh(folder.write(name, bytes)));
        ++read;
      } catch (const FileError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 500);  // the corruption is real
  EXPECT_GT(read, 100);     // and not all of it fatal
}

}  // namespace
}  // namespace innermap
