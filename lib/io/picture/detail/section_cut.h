// A cross-section of grids: what section_image draws.
#pragma once

#include <openvdb/openvdb.h>

#include <optional>
#include <string>
#include <vector>

#include "innermap/io/pictures.h"

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

// What of a vector grid is shown: a component (0, 1, 2), its length when unset, or all three as a
// colour. Scalars are shown as they are.
struct SectionPart {
  std::optional<int> component;
  bool colour = false;
};

// The cut at a layer, which may lie between two, through `grid`; `needed` holds it and the solid's
// grids.
SectionCut cutThrough(const openvdb::GridBase::Ptr& grid, const openvdb::GridPtrVec& needed,
                      const SliceFrame& frame, double layer, const SectionPart& part);

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
