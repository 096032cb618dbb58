#include "io/picture/detail/section_cut.h"

#include <algorithm>
#include <cmath>

namespace innermap {
namespace {

// One channel of the layer: a scalar, a component, the length; or all three of a colour.
std::vector<std::vector<float>> channelsOf(const openvdb::GridBase& grid, const SliceFrame& frame,
                                           int layer, const SectionPart& part) {
  std::vector<SliceChannel> slices = sliceGrid(grid, frame, layer);
  std::vector<std::vector<float>> out;
  if (slices.size() == 1 || part.colour) {
    for (SliceChannel& slice : slices) out.push_back(std::move(slice.values));
    return out;
  }
  if (part.component) return {std::move(slices[static_cast<std::size_t>(*part.component)].values)};
  std::vector<float> lengths(slices[0].values.size());
  for (std::size_t i = 0; i < lengths.size(); ++i)
    lengths[i] = std::hypot(slices[0].values[i], slices[1].values[i], slices[2].values[i]);
  return {std::move(lengths)};
}

// The grid at a layer that may lie between two: both, weighted where active.
SectionField fieldAt(const openvdb::GridBase::Ptr& grid, const SliceFrame& frame, double layer,
                     const SectionPart& part = {}) {
  const int below = static_cast<int>(std::floor(layer));
  const float share = static_cast<float>(layer - below);
  const bool everywhere = grid->getGridClass() == openvdb::GRID_LEVEL_SET;
  const std::size_t size = frame.rows() * frame.columns();
  SectionField field;
  field.weights.assign(size, 0.0f);
  for (int k = 0; k < 2; ++k) {
    const float weight = k == 0 ? 1 - share : share;
    if (weight == 0) continue;
    const auto channels = channelsOf(*grid, frame, below + k, part);
    field.channels.resize(channels.size(), std::vector<float>(size, 0.0f));
    const std::vector<float> mask =
        everywhere ? std::vector<float>(size, 1.0f) : sliceMask({grid}, frame, below + k);
    for (std::size_t i = 0; i < size; ++i) {
      if (!(mask[i] > 0)) continue;
      for (std::size_t c = 0; c < channels.size(); ++c)
        field.channels[c][i] += weight * channels[c][i];
      field.weights[i] += weight;
    }
  }
  return field;
}

// Positive inside, about 1 per voxel of depth near the surface.
std::vector<float> insideAt(const openvdb::GridPtrVec& grids, const SectionCut& cut) {
  if (const auto surface = gridNamed(grids, "surface")) {
    const double voxel = cut.frame.transform->voxelSize().x();
    SectionField f = fieldAt(surface, cut.frame, cut.layer);
    for (float& v : f.channels[0]) v = static_cast<float>(-v / voxel);
    return std::move(f.channels[0]);
  }
  if (const auto density = gridNamed(grids, "density")) {
    SectionField f = fieldAt(density, cut.frame, cut.layer);
    for (float& v : f.channels[0]) v -= 0.5f;
    return std::move(f.channels[0]);
  }
  return {};
}

}  // namespace

openvdb::GridBase::Ptr gridNamed(const openvdb::GridPtrVec& grids, const std::string& name) {
  for (const auto& grid : grids)
    if (grid->getName() == name) return grid;
  return nullptr;
}

SectionCut cutThrough(const openvdb::GridBase::Ptr& grid, const openvdb::GridPtrVec& needed,
                      const SliceFrame& frame, double layer, const SectionPart& part) {
  SectionCut cut;
  cut.frame = frame;
  cut.layer = layer;
  cut.shown = fieldAt(grid, frame, layer, part);
  cut.inside = insideAt(needed, cut);
  return cut;
}

std::vector<float> valuesInside(const SectionCut& cut) {
  std::vector<float> values;
  for (const std::vector<float>& channel : cut.shown.channels)
    for (std::size_t i = 0; i < channel.size(); ++i) {
      const bool inside = cut.inside.empty() || cut.inside[i] > 0;
      if (!inside || !(cut.shown.weights[i] > 0)) continue;
      const float v = channel[i] / cut.shown.weights[i];
      if (std::isfinite(v)) values.push_back(v);
    }
  std::sort(values.begin(), values.end());
  return values;
}

float SectionSampler::at(const std::vector<float>& values, const std::vector<float>* weights,
                         double x, double y, float* weight) const {
  const auto columns = static_cast<int>(cut_.frame.columns());
  const auto rows = static_cast<int>(cut_.frame.rows());
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  float sum = 0, total = 0;
  for (int k = 0; k < 4; ++k) {
    const int xi = std::clamp(x0 + (k & 1), 0, columns - 1);
    const int yi = std::clamp(y0 + (k >> 1), 0, rows - 1);
    const double wx = (k & 1) ? x - x0 : 1 - (x - x0), wy = (k >> 1) ? y - y0 : 1 - (y - y0);
    const std::size_t i = static_cast<std::size_t>(yi) * columns + xi;
    const float w = static_cast<float>(wx * wy) * (weights ? (*weights)[i] : 1.0f);
    if (w == 0) continue;
    // Values with weights are already weighted over the layers.
    sum += weights ? static_cast<float>(wx * wy) * values[i] : w * values[i];
    total += w;
  }
  if (weight) *weight = total;
  return total > 0 ? sum / total : 0.0f;
}

bool SectionSampler::inside(double x, double y) const {
  if (!cut_.inside.empty()) return at(cut_.inside, nullptr, x, y, nullptr) > 0;
  float weight = 0;
  at(cut_.shown.channels[0], &cut_.shown.weights, x, y, &weight);
  return weight >= 0.5f;
}

std::optional<float> SectionSampler::value(double x, double y, std::size_t channel) const {
  float weight = 0;
  const float v = at(cut_.shown.channels[channel], &cut_.shown.weights, x, y, &weight);
  return weight > 0 ? std::optional<float>(v) : std::nullopt;
}

}  // namespace innermap
