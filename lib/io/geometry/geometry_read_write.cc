#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/file.h"
#include "core/file_bytes.h"
#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/io/cell_file.h"
#include "innermap/io/geometry_file.h"
#include "innermap/mesh/mesh_file.h"
#include "io/geometry/detail/geometry_formats.h"
#include "io/geometry/detail/ply_splats.h"

namespace innermap {
namespace {

bool endsIn(const std::string& path, const char* extension) {
  return equalsIgnoringCase(extensionOf(path), extension);
}

bool isMeshFile(const std::string& path) {
  const auto& all = meshExtensions();
  return std::any_of(all.begin(), all.end(),
                     [&](const std::string& one) { return endsIn(path, one.c_str()); });
}

std::unique_ptr<GeometryFile> readMeshGeometry(const std::string& path,
                                               const ReadGeometrySettings& settings) {
  FileBytes file = readFileBytes(path, "a file of geometry");
  if (endsIn(path, ".obj")) return readObjGeometry(std::move(file));
  if (endsIn(path, ".ply")) return readPlyGeometry(std::move(file), settings);
  if (endsIn(path, ".off")) return readOffGeometry(std::move(file));
  return readStlGeometry(std::move(file));
}

// Of one pass over the points.
constexpr std::uint64_t kOnTheWay = 25'000'000;

// Bytes in memory for each of the file, measured: dense files, and those with directions, whose
// Jacobians are kept, take more.
double bytesPerByte(const std::string& path, const std::string& head) {
  if (endsIn(path, ".stl")) return head.compare(0, 5, "solid") ? 18 : 5;
  if (endsIn(path, ".ply")) return head.find(" nx") != head.npos ? 9.5 : 5;
  return 4.2;
}

std::string headOf(const std::string& path) {
  std::string head(16384, ' ');
  std::ifstream(path, std::ios::binary)
      .read(head.data(), static_cast<std::streamsize>(head.size()));
  return head;
}

}  // namespace

bool isGeometryFile(const std::string& path) { return isMeshFile(path) || isCellFile(path); }

void requireWritableAs(const std::string& input, const std::string& output) {
  if (isCellFile(input) ? isCellFile(output)
                        : equalsIgnoringCase(extensionOf(input), extensionOf(output)))
    return;
  throw FileError(output,
                  isCellFile(input)
                      ? "cells are written as .vtu, .msh or .mesh; give one of these endings"
                      : "must end as " + input + " does, in " + extensionOf(input));
}

std::unique_ptr<GeometryFile> readGeometry(const std::string& path,
                                           const ReadGeometrySettings& settings) {
  const std::uint64_t limit = std::min(memoryLimit(), availableMemory());
  requireMemory("carrying " + path, geometryMemory(path), limit, "cut the file into parts");
  if (isCellFile(path)) return readCellGeometry(path, settings);
  if (!isMeshFile(path))
    throw FileError(path,
                    "unknown extension " + inQuotes(extensionOf(path)) +
                        "; geometry is read from .obj, .ply, .off, .stl, .vtu, .msh and .mesh "
                        "files");
  auto file = readMeshGeometry(path, settings);
  if (file->geometry.points.empty()) throw FileError(path, "has no points");
  return file;
}

CarriedGeometry carryGeometry(GeometryFile& file, const PointCarry& carry,
                              const CarryGeometrySettings& settings) {
  requireMemory("carrying the geometry", processMemory(carryGeometryMemory(file.geometry)),
                "cut the file into parts");
  CarriedGeometry out = carryGeometry(file.geometry, carry, settings);
  out.splats.capped = file.cappedOpacities(out);
  out.inverted = file.inverted(out);
  return out;
}

std::uint64_t geometryMemory(const std::string& path) {
  if (isCellFile(path)) return readCellsMemory(path) * 11 / 10 + kOnTheWay;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw FileError(path, "cannot be read (" + error.message() + "); check the name");
  const std::string head = headOf(path);
  if (const std::uint64_t splats = endsIn(path, ".ply") ? plySplatsMemory({path, head}, size) : 0)
    return splats + kOnTheWay;
  return static_cast<std::uint64_t>(bytesPerByte(path, head) * static_cast<double>(size)) +
         kOnTheWay;
}

std::vector<std::string> writeGeometry(const std::string& path, const GeometryFile& file,
                                       const CarriedGeometry& carried) {
  std::vector<std::string> lost;
  writeWholeFile(path, [&](std::ostream& stream) { lost = file.write(path, carried, stream); });
  return lost;
}

}  // namespace innermap
