// VTK's XML image data, for ParaView: "VTK File Formats", XML formats, in the VTK User's Guide.
#include <fmt/format.h>

#include <ostream>

#include "core/file.h"
#include "core/markup.h"
#include "core/output_buffer.h"
#include "io/volume/detail/dense_types.h"
#include "io/volume/detail/volume_formats.h"

namespace innermap {
namespace {

// VTK: point = origin + direction * (spacing * index), the direction's rows one after the other.
std::string placeOf(const VolumeLattice& lattice) {
  const openvdb::Vec3d origin = lattice.indexToWorld.transform(lattice.origin.asVec3d());
  openvdb::Vec3d axes[3];
  std::string spacing, direction;
  for (int a = 0; a < 3; ++a) {
    for (int r = 0; r < 3; ++r) axes[a][r] = lattice.indexToWorld(a, r);
    spacing += fmt::format("{}{}", a ? " " : "", axes[a].length());
  }
  for (int r = 0; r < 3; ++r)
    for (int a = 0; a < 3; ++a)
      direction += fmt::format("{}{}", r + a ? " " : "", axes[a][r] / axes[a].length());
  return fmt::format("Origin=\"{} {} {}\" Spacing=\"{}\" Direction=\"{}\"", origin.x(), origin.y(),
                     origin.z(), spacing, direction);
}

std::uint64_t bytesOf(const VolumePlan& plan, const VolumeGrid& grid) {
  return plan.lattice.voxels() * grid.channels.size() * denseType(grid.type).bytes;
}

void writeHeader(std::ostream& stream, const VolumePlan& plan) {
  const openvdb::Coord& size = plan.lattice.size;
  const std::string extent =
      fmt::format("0 {} 0 {} 0 {}", size.x() - 1, size.y() - 1, size.z() - 1);
  stream << "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" "
            "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
         << fmt::format("  <ImageData WholeExtent=\"{}\" {}>\n    <Piece Extent=\"{}\">\n", extent,
                        placeOf(plan.lattice), extent);
  stream << "      <PointData";
  for (const bool vector : {false, true})
    for (const VolumeGrid& grid : plan.grids)
      if (grid.isVector() == vector) {
        stream << fmt::format(" {}=\"{}\"", vector ? "Vectors" : "Scalars", markupText(grid.name));
        break;
      }
  stream << ">\n";
  std::uint64_t offset = 0;
  for (const VolumeGrid& grid : plan.grids) {
    stream << fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" "
        "format=\"appended\" offset=\"{}\"/>\n",
        denseType(grid.type).vtk, markupText(grid.name), grid.channels.size(), offset);
    offset += sizeof(std::uint64_t) + bytesOf(plan, grid);
  }
  stream << "      </PointData>\n    </Piece>\n  </ImageData>\n"
            "  <AppendedData encoding=\"raw\">\n_";
}

}  // namespace

VolumeTextureResult planVti(const std::string& path, const openvdb::GridPtrVec& grids,
                            const VolumeTextureSettings& settings) {
  return denseResult(path, makeDensePlan(grids, settings));
}

std::uint64_t vtiMemory(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings) {
  return sliceMemory(makeDensePlan(grids, settings)) + (std::uint64_t(4) << 20);
}

VolumeTextureResult writeVti(const std::string& path, const openvdb::GridPtrVec& grids,
                             const VolumeTextureSettings& settings) {
  const VolumePlan plan = makeDensePlan(grids, settings);
  writeWholeFile(path, [&](std::ostream& stream) {
    writeHeader(stream, plan);
    for (std::size_t g = 0; g < plan.grids.size(); ++g) {
      const VolumeGrid& grid = plan.grids[g];
      const DenseType& type = denseType(grid.type);
      OutputBuffer out(stream);
      out.number(std::uint64_t{bytesOf(plan, grid)});
      forSlices(plan, g, g + 1, "writing the VTK file", [&](int, const SliceValues& values) {
        char number[8];
        for (std::size_t i = 0; i < values[0].size(); ++i)
          for (const std::vector<double>& channel : values) {
            type.put(channel[i], number);
            out.raw({number, type.bytes});
          }
      });
    }
    stream << "\n  </AppendedData>\n</VTKFile>\n";
  });
  return denseResult(path, plan);
}

}  // namespace innermap
