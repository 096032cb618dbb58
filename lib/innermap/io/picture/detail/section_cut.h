// A cross-section of grids: what section_image draws.
#pragma once

#include <openvdb/openvdb.h>

#include <optional>
#include <string>
#include <vector>

#include "innermap/io/picture/section_image.h"
#include "innermap/io/slice.h"

namespace innermap {

openvdb::GridBase::Ptr gridNamed(const openvdb::GridPtrVec& grids, const std::string& name);

// A layer's values between two voxel layers, weighted: weight 0 where no voxel is active. One
// channel, or the three of a colour.
struct SectionField {
  std::vector<std::vector<float>> channels;
  std::vector<float> weights;
};

struct SectionCut {
  SliceFrame frame;
  double layer = 0;
  SectionField shown;
  std::vector<float> inside;  // positive inside the solid; empty: the weights tell
};

// The cut that the settings mean through `grid`; `needed` holds it and the solid's grids. Throws
// SettingError for a position beyond the grids.
SectionCut cutThrough(const openvdb::GridBase::Ptr& grid, const openvdb::GridPtrVec& needed,
                      const SliceFrame& frame, const SectionSettings& settings);

// Finite values inside the solid, ascending; of a colour, of all its channels.
std::vector<float> valuesInside(const SectionCut& cut);

// Bilinear interpolation of the cut at image coordinates (voxel centres at whole numbers).
class SectionSampler {
 public:
  explicit SectionSampler(const SectionCut& cut) : cut_(cut) {}

  bool inside(double x, double y) const;
  // None where no voxel is active.
  std::optional<float> value(double x, double y, std::size_t channel = 0) const;

 private:
  float at(const std::vector<float>& values, const std::vector<float>* weights, double x, double y,
           float* weight) const;

  const SectionCut& cut_;
};

}  // namespace innermap
