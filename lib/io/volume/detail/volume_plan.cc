#include "io/volume/detail/volume_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>

#include "evaluate/topology.h"
#include "innermap/core/error.h"
#include "innermap/io/pictures.h"

namespace innermap {
namespace {

constexpr std::int64_t kLongestSide = 65536;     // of a slice, pixels
constexpr std::int64_t kLongestAtlas = 1 << 20;  // pixels

void checkSettings(const VolumeTextureSettings& s) {
  if (s.axis < 0 || s.axis > 2) throw SettingError("axis", "is not one of x, y, z");
  requireDescribed(s);
  if (s.tiles && (s.tiles->first < 1 || s.tiles->second < 1))
    throw SettingError("tiles", "must be 1 at least in each direction");
  if (s.tiles && s.layout != VolumeLayout::atlas)
    throw SettingError("tiles", "is for the layout atlas");
}

// Sides of the box in voxels of the lattice, and its place.
struct DenseBox {
  openvdb::Vec3d lower;  // least corner, index space of the grids
  openvdb::Vec3d side;   // voxels of the grids
  std::array<std::int64_t, 3> size{0, 0, 0};
  double scale = 1;

  // Grows to more voxels about the middle; by whole voxels, so that a lattice of the grids stays.
  void grow(int a, std::int64_t voxels) {
    const std::int64_t before = (voxels - size[a]) / 2;
    lower[a] -= scale * static_cast<double>(before);
    size[a] = voxels;
    side[a] = scale * static_cast<double>(voxels);
  }
};

DenseBox denseBox(const openvdb::CoordBBox& active, const VolumeTextureSettings& s) {
  DenseBox box;
  for (int a = 0; a < 3; ++a) {
    box.size[a] = std::int64_t(active.max()[a]) - active.min()[a] + 1 + 2 * s.pad;
    box.lower[a] = active.min()[a] - s.pad - 0.5;
    box.side[a] = static_cast<double>(box.size[a]);
  }
  const std::int64_t longest = *std::max_element(box.size.begin(), box.size.end());
  if (s.cube)
    for (int a = 0; a < 3; ++a) box.grow(a, longest);
  if (s.resolution > 0) {
    box.scale = static_cast<double>(longest) / s.resolution;
    for (int a = 0; a < 3; ++a) {
      const double middle = box.lower[a] + 0.5 * box.side[a];
      box.size[a] =
          std::max<std::int64_t>(1, std::llround(std::ceil(box.side[a] / box.scale - 1e-6)));
      box.side[a] = box.scale * static_cast<double>(box.size[a]);
      box.lower[a] = middle - 0.5 * box.side[a];
    }
  }
  for (int a = 0; a < 3; ++a) {
    if (box.size[a] > kLongestSide)
      throw DataError(fmt::format("the box has {} voxels along {}; at most {} can be exported",
                                  box.size[a], axisName(a), kLongestSide));
    if (s.powerOfTwo) box.grow(a, powerOfTwo(static_cast<int>(box.size[a])));
  }
  return box;
}

void placeLattice(const SliceFrame& frame, const VolumeTextureSettings& s, VolumeLattice& lattice,
                  VolumeResampling& resampling) {
  const DenseBox box = denseBox(frame.box, s);
  lattice.size = {static_cast<int>(box.size[0]), static_cast<int>(box.size[1]),
                  static_cast<int>(box.size[2])};
  const openvdb::Mat4d gridToWorld = frame.transform->baseMap()->getAffineMap()->getMat4();
  if (s.resolution == 0) {
    lattice.origin = openvdb::Coord::round(box.lower + openvdb::Vec3d(0.5));
    lattice.indexToWorld = gridToWorld;
    return;
  }
  resampling.copies = false;
  resampling.scale = box.scale;
  resampling.offset = box.lower + openvdb::Vec3d(0.5 * box.scale);
  openvdb::Mat4d toGrid = openvdb::Mat4d::identity();
  toGrid.setToScale(openvdb::Vec3d(box.scale));
  toGrid.postTranslate(resampling.offset);
  lattice.indexToWorld = toGrid * gridToWorld;
}

void placeTiles(const VolumeTextureSettings& s, VolumeLattice& lattice) {
  if (s.layout != VolumeLayout::atlas) return;
  const int slices = lattice.slices();
  std::tie(lattice.tileColumns, lattice.tileRows) =
      s.tiles ? *s.tiles : nearSquareTiles(lattice.width(), lattice.height(), slices);
  if (std::int64_t(lattice.tileColumns) * lattice.tileRows < slices)
    throw SettingError("tiles", fmt::format("{}x{} are too few for {} slices", lattice.tileColumns,
                                            lattice.tileRows, slices));
  if (s.powerOfTwo && s.tiles &&
      (powerOfTwo(lattice.tileColumns) != lattice.tileColumns ||
       powerOfTwo(lattice.tileRows) != lattice.tileRows))
    throw SettingError("tiles", "must be powers of two if the picture's sides are");
  const std::int64_t longest = std::max(std::int64_t(lattice.width()) * lattice.tileColumns,
                                        std::int64_t(lattice.height()) * lattice.tileRows);
  if (longest > kLongestAtlas)
    throw DataError(
        fmt::format("an atlas of {} pixels along a side is larger than any program "
                    "reads; lower the resolution",
                    longest));
}

VolumeGrid describe(const openvdb::GridBase& grid) {
  VolumeGrid d;
  d.name = grid.getName();
  d.type = grid.isType<openvdb::MaskGrid>() ? "mask" : grid.valueType();
  d.gridClass = openvdb::GridBase::gridClassToString(grid.getGridClass());
  d.vectorType = openvdb::GridBase::vecTypeToString(grid.getVectorType());
  d.channels = channelNames(grid);
  grid.apply<GridTypes>([&](const auto& typed) {
    const auto background = typed.background();
    if constexpr (openvdb::VecTraits<std::decay_t<decltype(background)>>::IsVec)
      d.background = openvdb::Vec3d(background);
    else
      d.background[0] = static_cast<double>(background);
  });
  return d;
}

// R, G, B, A or Y in place of the layers' names, as VolumeChannels says.
void nameAsColours(std::vector<VolumeGrid>& grids) {
  std::vector<std::string> names{"R", "G", "B", "A"};
  std::size_t vectors = 0, components = 0;
  for (const VolumeGrid& grid : grids) {
    vectors += grid.isVector();
    components += grid.channels.size();
  }
  if (components == 1) names = {"Y"};
  std::size_t next = 0;
  for (VolumeGrid& grid : grids) {
    if (vectors == 1 && !grid.isVector()) {
      grid.channels = {"A"};
      continue;
    }
    for (std::string& channel : grid.channels) channel = names[next++];
  }
}

void nameChannels(const VolumeTextureSettings& s, std::vector<VolumeGrid>& grids) {
  std::size_t components = 0;
  for (const VolumeGrid& grid : grids) components += grid.channels.size();
  if (s.channels == VolumeChannels::rgba && components > 4)
    throw SettingError("channels", fmt::format("the grids have {} components, which do not fit "
                                               "R, G, B, A; choose fewer grids or layers",
                                               components));
  if (s.channels != VolumeChannels::layers && components <= 4) nameAsColours(grids);
  if (s.active)
    for (VolumeGrid& grid : grids) grid.activeChannel = grid.name + ".active";
}

void listChannels(VolumePlan& plan) {
  for (const VolumeGrid& grid : plan.grids) {
    for (std::size_t c = 0; c < grid.channels.size(); ++c) {
      plan.channels.push_back(grid.channels[c]);
      plan.fill.push_back(pixelValue(grid.background[static_cast<int>(c)], plan.half));
    }
    if (!grid.activeChannel.empty()) {
      plan.channels.push_back(grid.activeChannel);
      plan.fill.push_back(0);
    }
  }
  if (std::set<std::string>(plan.channels.begin(), plan.channels.end()).size() !=
      plan.channels.size())
    throw DataError("two grids have the same name; rename one");
  for (const std::string& name : plan.channels)
    if (name.size() > 255)
      throw DataError("the grid name '" + name + "' is too long for an EXR channel; shorten it");
}

VolumePlan planOf(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings,
                  PixelType pixel) {
  checkSettings(settings);
  if (grids.empty()) throw DataError("there are no grids to export");
  VolumePlan plan;
  plan.half = settings.half;
  plan.lattice.setAxis(settings.axis);
  plan.lattice.rowsUp = settings.rowsUp;
  VolumeResampling resampling;
  placeLattice(sliceFrame(grids, settings.axis), settings, plan.lattice, resampling);
  placeTiles(settings, plan.lattice);
  for (const auto& grid : grids) {
    plan.samplers.push_back(makeVolumeSampler(*grid, resampling, pixel));
    plan.grids.push_back(describe(*grid));
    if (plan.grids.back().name.empty())
      throw DataError("a grid has no name, by which it could be read back; name it");
  }
  nameChannels(settings, plan.grids);
  listChannels(plan);
  return plan;
}

}  // namespace

VolumePlan makeVolumePlan(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings) {
  return planOf(grids, settings, settings.half ? PixelType::half : PixelType::single);
}

VolumePlan makeExactPlan(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings) {
  return planOf(grids, settings, PixelType::number);
}

std::vector<Setting> describe(VolumeTextureSettings& s) {
  return {
      Setting("layout", "NAME",
              choiceOf<VolumeLayout>(&s.layout, {{"atlas", VolumeLayout::atlas},
                                                 {"slices", VolumeLayout::slices},
                                                 {"parts", VolumeLayout::parts}}),
              "atlas: one picture of tiles; slices: a file each; parts: one multi-part file"),
      Setting("half", &s.half, "half floats: half the size, three digits"),
      Setting(
          "channels", "NAMES",
          choiceOf<VolumeChannels>(&s.channels, {{"auto", VolumeChannels::automatic},
                                                 {"rgba", VolumeChannels::rgba},
                                                 {"layers", VolumeChannels::layers}}),
          "rgba: Y or R, G, B, A; layers: by the grids' names; auto: rgba where four are enough")
          .rare(),
      Setting("resolution", "N", &s.resolution,
              "resample to N voxels along the longest side: linear, the mean where voxels grow")
          .from(1, 8192)
          .otherwise(0, "the grids' own voxels"),
      Setting("pad", "N", &s.pad, "voxels about the active box").from(0, 4096).rare(),
      Setting("cube", &s.cube, "widen the box to a cube").rare(),
      Setting("power_of_two", &s.powerOfTwo,
              "widen the box until the number and sides of the slices, and the picture's sides, "
              "are powers of two")
          .rare(),
      axisSetting("axis", &s.axis, "direction across the slices"),
      Setting("active", &s.active, "also write NAME.active: 1 where a voxel is active").rare(),
      Setting("zip", &s.zip, "compress NanoVDB files with zlib, which not all programs read")
          .rare()};
}

std::vector<Setting> describe(VolumeTextureReadSettings& s) {
  return {
      Setting("layout", "NAME",
              choiceOf<std::optional<VolumeLayout>>(&s.layout, {{"atlas", VolumeLayout::atlas},
                                                                {"slices", VolumeLayout::slices},
                                                                {"parts", VolumeLayout::parts}}),
              "what the pictures are")
          .otherwise("from the file"),
      Setting("slices", "N", &s.slices, "number of slices, if fewer than tiles, parts or files")
          .from(1, 65536)
          .otherwise("from the file, else all")
          .rare(),
      Setting("voxel_size", "L", &s.voxelSize, "edge of a voxel, in place of the file's matrix")
          .in("world units")
          .above(0, 1e12)
          .otherwise("from the file"),
      Setting("axis", "AXIS", choiceOf<std::optional<int>>(&s.axis, {{"x", 0}, {"y", 1}, {"z", 2}}),
              "direction across the slices")
          .otherwise("from the file, else z"),
      Setting("background", "V", &s.background, "value of what is not active")
          .from(-1e30, 1e30)
          .otherwise("from the file, else 0")
          .rare(),
      Setting("as_voxels", &s.asVoxels,
              "take the voxels of a NIfTI file along x, y, z from the origin, wherever it says")
          .rare()};
}

}  // namespace innermap
