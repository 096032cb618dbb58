#include "evaluate/visit_field.h"

#include <algorithm>
#include <utility>

#include "evaluate/detail/leaf_plan.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

// Leaves that are planned and summed together, of one block at most: bounds the memory for what is
// not visited yet, which of maps in steps is all that the first one gives.
constexpr std::size_t kLeavesTogether = 4096, kLeavesTogetherInSteps = 1024;
constexpr std::size_t kLeafPoints = 512;

// What one leaf hands to the visitor, gathered from the lattice sums and the skin's samples.
class LeafBuffer {
 public:
  explicit LeafBuffer(std::size_t channels) : channels_(channels) {
    values_.reserve(kLeafPoints * channels);
    gradients_.reserve(3 * kLeafPoints * channels);
  }

  void gather(const openvdb::Coord& origin, const LeafPlan& plan, const double* values,
              const double* gradients, const FieldSamples& skin, std::size_t firstRow) {
    origin_ = origin;
    hasGradients_ = gradients != nullptr;
    auto cut = plan.cut.begin();
    auto outside = plan.skin.begin();
    for (std::size_t i = 0; i < kLeafPoints; ++i) {
      if (plan.inside[i >> 6] >> (i & 63) & 1) {
        const bool isCut = cut != plan.cut.end() && cut->offset == i;
        addInside(i, isCut ? (cut++)->share : 1.0, values, gradients);
      } else if (outside != plan.skin.end() && outside->offset == i) {
        addOutside(*outside, skin,
                   firstRow + static_cast<std::size_t>(outside - plan.skin.begin()));
        ++outside;
      }
    }
  }

  LeafValues leaf() const {
    return {origin_,         offsets_.size(), channels_,
            offsets_.data(), shares_.data(),  beyond_.data(),
            inside_.data(),  values_.data(),  hasGradients_ ? gradients_.data() : nullptr};
  }

  std::size_t insideCount() const {
    return static_cast<std::size_t>(std::count(inside_.begin(), inside_.end(), 1));
  }

  // Calls `exchange` with each value and gradient of the voxels inside, and its place in `samples`,
  // whose rows from `row` on are theirs.
  template <class Exchange>
  void forInside(FieldSamples& samples, std::size_t row, const Exchange& exchange) {
    for (std::size_t i = 0; i < inside_.size(); ++i) {
      if (!inside_[i]) continue;
      for (std::size_t k = 0; k < channels_; ++k)
        exchange(values_[channels_ * i + k], samples.values(row, k));
      for (std::size_t k = 0; hasGradients_ && k < 3 * channels_; ++k)
        exchange(gradients_[3 * channels_ * i + k], samples.gradients(row, k));
      ++row;
    }
  }

 private:
  void add(std::size_t offset, double share, const Vec3& beyond, bool inside) {
    offsets_.push_back(static_cast<std::uint16_t>(offset));
    shares_.push_back(share);
    beyond_.push_back(beyond);
    inside_.push_back(inside);
  }

  void addInside(std::size_t i, double share, const double* values, const double* gradients) {
    add(i, share, {}, true);
    for (std::size_t k = 0; k < channels_; ++k) values_.push_back(values[kLeafPoints * k + i]);
    for (std::size_t k = 0; gradients && k < 3 * channels_; ++k)
      gradients_.push_back(gradients[kLeafPoints * k + i]);
  }

  void addOutside(const LeafPlan::Skin& voxel, const FieldSamples& skin, std::size_t row) {
    add(voxel.offset, voxel.share, voxel.beyond, false);
    for (std::size_t k = 0; k < channels_; ++k) {
      double value = skin.values(row, k);
      for (int a = 0; a < 3; ++a)
        value += skin.gradients(row, 3 * k + static_cast<std::size_t>(a)) * voxel.beyond[a];
      values_.push_back(value);
    }
    for (std::size_t k = 0; k < 3 * channels_; ++k) gradients_.push_back(skin.gradients(row, k));
  }

  std::size_t channels_;
  openvdb::Coord origin_;
  bool hasGradients_ = false;
  std::vector<std::uint16_t> offsets_;
  std::vector<std::uint8_t> inside_;
  std::vector<double> shares_, values_, gradients_;
  Points beyond_;
};

// The values that the first step gave to the voxels inside become those of the whole map.
void finishInside(const ComposedMap& map, std::vector<LeafBuffer>& buffers,
                  const EvaluateFieldSettings& settings) {
  std::vector<std::size_t> first{0};
  for (const LeafBuffer& b : buffers) first.push_back(first.back() + b.insideCount());
  FieldSamples all;
  all.values = Matrix(first.back(), 3);
  if (settings.gradients) all.gradients = Matrix(first.back(), 9);
  const auto exchange = [&](const auto& how) {
    parallelBlocks(buffers.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t l = begin; l < end; ++l) buffers[l].forInside(all, first[l], how);
    });
  };
  exchange([](double& voxel, double& row) { row = voxel; });
  map.finish(all, settings);
  exchange([](double& voxel, double& row) { voxel = row; });
}

// `field` is the first step of `map`, where there is one.
void visitLeaves(const HarmonicField& field, const ComposedMap* map, const FieldRegion& region,
                 std::size_t begin, std::size_t end, const LeafVisitor& visit,
                 const VisitSettings& settings) {
  const std::size_t count = end - begin;
  std::vector<LeafPlan> made;
  const LeafPlan* const plans = region.plans(begin, end, made);
  Points onSkin;
  std::vector<std::size_t> firstRow;
  LatticeBlocks lattice;
  lattice.spacing = region.levelSet().voxelSize()[0];
  const openvdb::Vec3d origin = region.levelSet().transform().indexToWorld(openvdb::Vec3d(0));
  lattice.origin = {origin.x(), origin.y(), origin.z()};
  for (std::size_t l = 0; l < count; ++l) {
    const openvdb::Coord first = region.origin(begin + l);
    lattice.blocks.push_back({{first.x(), first.y(), first.z()}, plans[l].inside});
    firstRow.push_back(onSkin.size());
    for (const LeafPlan::Skin& voxel : plans[l].skin) onSkin.push_back(voxel.at);
  }
  const auto leafCount = static_cast<double>(region.leafCount());
  const PartOfStage part(static_cast<double>(begin) / leafCount,
                         static_cast<double>(end) / leafCount);
  const EvaluateFieldSettings all{settings.accuracy, true},
      wanted{settings.accuracy, settings.gradients};
  FieldSamples skin = field.evaluate(onSkin, all);
  const auto gather = [&](LeafBuffer& buffer, std::size_t l, const double* values,
                          const double* gradients) {
    buffer.gather(region.origin(begin + l), plans[l], values, gradients, skin, firstRow[l]);
  };
  if (!map || map->steps().size() == 1)
    return field.onLattice(
        lattice,
        [&](std::size_t l, const double* values, const double* gradients) {
          LeafBuffer buffer(field.channels());
          gather(buffer, l, values, gradients);
          visit(begin + l, buffer.leaf());
        },
        wanted, settings.stage);
  map->finish(skin, all);
  std::vector<LeafBuffer> buffers(count, LeafBuffer(field.channels()));
  field.onLattice(
      lattice,
      [&](std::size_t l, const double* values, const double* gradients) {
        gather(buffers[l], l, values, gradients);
      },
      wanted, settings.stage);
  finishInside(*map, buffers, wanted);
  parallelBlocks(count, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t l = first; l < last; ++l) visit(begin + l, buffers[l].leaf());
  });
}

void requireAccuracy(const VisitSettings& settings) {
  if (!(settings.accuracy > 0)) throw SettingError("accuracy", "of the sums must be above 0");
}

// Of the leaves that are visited together from `begin` on, which are in their tree's order.
std::size_t endOfBatch(const FieldRegion& region, std::size_t begin, std::size_t most) {
  const openvdb::Coord block = blockOf(region.origin(begin));
  const std::size_t last = std::min(begin + most, region.leafCount());
  std::size_t end = begin + 1;
  while (end < last && blockOf(region.origin(end)) == block) ++end;
  return end;
}

void visitAll(const HarmonicField& field, const ComposedMap* map, const FieldRegion& region,
              const LeafVisitor& visit, const VisitSettings& settings) {
  requireAccuracy(settings);
  const std::size_t together =
      map && map->steps().size() > 1 ? kLeavesTogetherInSteps : kLeavesTogether;
  for (std::size_t begin = 0, end = 0; begin < region.leafCount(); begin = end) {
    end = endOfBatch(region, begin, together);
    visitLeaves(field, map, region, begin, end, visit, settings);
  }
}

// f: a field or a map.
template <class Function>
FieldSamples samplesAt(const Function& f, const ExtendedPlaces& places,
                       const VisitSettings& settings) {
  requireAccuracy(settings);
  FieldSamples out = f.evaluate(places.at, {settings.accuracy, true});
  Matrix& values = out.values;
  for (std::size_t k = 0; k < values.columns(); ++k)
    for (int a = 0; a < 3; ++a) {
      const double* gradient = out.gradients.column(3 * k + static_cast<std::size_t>(a));
      for (std::size_t i = 0; i < places.at.size(); ++i)
        values(i, k) += gradient[i] * places.beyond[i][a];
    }
  return out;
}

template <class Function>
ExtendedSamples extendedSamples(const Function& f, const Solid& solid,
                                const openvdb::FloatGrid& levelSet, const Points& points,
                                const VisitSettings& settings) {
  requireAccuracy(settings);
  ExtendedPlaces places = placeExtended(solid, levelSet, points);
  FieldSamples samples = samplesAt(f, places, settings);
  return {std::move(samples), std::move(places.beyond)};
}

}  // namespace

void visitField(const HarmonicField& field, const FieldRegion& region, const LeafVisitor& visit,
                const VisitSettings& settings) {
  visitAll(field, nullptr, region, visit, settings);
}

void visitField(const ComposedMap& map, const FieldRegion& region, const LeafVisitor& visit,
                const VisitSettings& settings) {
  visitAll(map.steps().front().field(), &map, region, visit, settings);
}

ExtendedSamples sampleExtended(const HarmonicField& field, const Solid& solid,
                               const openvdb::FloatGrid& levelSet, const Points& points,
                               const VisitSettings& settings) {
  return extendedSamples(field, solid, levelSet, points, settings);
}

ExtendedSamples sampleExtended(const ComposedMap& map, const Solid& solid,
                               const openvdb::FloatGrid& levelSet, const Points& points,
                               const VisitSettings& settings) {
  return extendedSamples(map, solid, levelSet, points, settings);
}

FieldSamples sampleExtended(const ComposedMap& map, const ExtendedPlaces& places,
                            const VisitSettings& settings) {
  return samplesAt(map, places, settings);
}

}  // namespace innermap
