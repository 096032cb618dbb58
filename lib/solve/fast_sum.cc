#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>

#include "core/random.h"
#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/solve/kernel_sum.h"
#include "solve/detail/charge_tree.h"
#include "solve/detail/descent.h"
#include "solve/detail/far_field.h"
#include "solve/detail/sum_plan.h"
#include "solve/detail/sum_reference.h"

namespace innermap {
namespace {

constexpr std::size_t kPointsPerLeaf = 400;
constexpr int kHalvings = 3;
constexpr std::size_t kSampled = 128, kSampledBlocks = 32;
constexpr double kLeastOrderGain = 0.5;  // of a higher order: less, and the highest is found
constexpr double kLeastBall = 1e-9;  // radius of a leaf of coincident points, of the charges' box

std::vector<std::size_t> evenly(std::size_t wanted, std::size_t count) {
  std::vector<std::size_t> out(std::min(wanted, count));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = i * count / out.size();
  return out;
}

void check(const FastSumSettings& settings) {
  requireNumber("accuracy", settings.accuracy, {1e-12, 0.1});
  requireNumber("accuracy", settings.absolute, {0});
}

bool useHierarchy(const SumSize& size, SumMethod method) {
  return method == SumMethod::cheapest ? hierarchyIsCheaper(size)
                                       : method == SumMethod::hierarchical;
}

FieldSamples samplesFor(std::size_t points, std::size_t channels, bool gradients) {
  FieldSamples out;
  out.values = Matrix(points, channels);
  if (gradients) out.gradients = Matrix(points, 3 * channels);
  return out;
}

using Block = LatticeBlocks::Block;

bool wanted(const Block& block, std::size_t place) {
  return block.wanted[place >> 6] >> (place & 63) & 1;
}

Vec3 pointOf(const LatticeBlocks& lattice, const Block& block, std::size_t place) {
  const Vec3 index{block.first[0] + static_cast<double>(place >> 6),
                   block.first[1] + static_cast<double>(place >> 3 & 7),
                   block.first[2] + static_cast<double>(place & 7)};
  return lattice.origin + lattice.spacing * index;
}

std::vector<std::uint16_t> placesOf(const Block& block) {
  std::vector<std::uint16_t> out;
  for (std::size_t i = 0; i < LatticeBlock::kPoints; ++i)
    if (wanted(block, i)) out.push_back(static_cast<std::uint16_t>(i));
  return out;
}

bool nothingWanted(const Block& block) {
  return std::all_of(block.wanted.begin(), block.wanted.end(),
                     [](std::uint64_t word) { return word == 0; });
}

std::size_t wantedPoints(const LatticeBlocks& lattice) {
  std::size_t count = 0;
  for (const Block& b : lattice.blocks)
    for (const std::uint64_t word : b.wanted)
      count += static_cast<std::size_t>(__builtin_popcountll(word));
  return count;
}

}  // namespace

struct SumPoints::Data {
  explicit Data(Points all) : points(std::move(all)) {}

  std::shared_ptr<const BallTree> tree() const {
    if (auto made = get()) return made;
    // Not under the lock: a thread that waits for parts of its tree may take up another sum at
    // these points.
    auto fresh = std::make_shared<const BallTree>(points, 0, kPointsPerLeaf, kHalvings);
    const std::lock_guard lock(mutex_);
    if (!balls_) balls_ = std::move(fresh);
    return balls_;
  }

  const Points points;

 private:
  std::shared_ptr<const BallTree> get() const {
    const std::lock_guard lock(mutex_);
    return balls_;
  }

  mutable std::mutex mutex_;
  mutable std::shared_ptr<const BallTree> balls_;
};

SumPoints::SumPoints(Points points) : data_(std::make_shared<const Data>(std::move(points))) {}
const Points& SumPoints::points() const { return data_->points; }

// The tree of targets, of their places in the charges' units.
using TargetTree = std::function<BallTree(const Points& local)>;

struct FastSum::Data {
  FieldSamples at(const Points& points, const TargetTree& targets,
                  const FastSumSettings& settings) const;

  Charges direct;
  ChargeTree tree;
};

FastSum::FastSum(const Points& sources, const Matrix& weights)
    : data_(std::make_shared<const Data>(
          Data{Charges(sources, weights), ChargeTree(sources, weights)})) {}

std::size_t FastSum::count() const { return data_->tree.count(); }
std::size_t FastSum::channels() const { return data_->tree.channels(); }
const Charges& FastSum::plain() const { return data_->direct; }

namespace {

// One try at a given order.
class Hierarchy {
 public:
  Hierarchy(const ChargeTree& tree, const FarFieldPlan& plan, const FastSumSettings& settings)
      : tree_(tree),
        settings_(settings),
        proxies_(tree, ExpansionBasis::get(plan.order)),
        field_(proxies_, plan) {}

  FieldSamples at(const Points& points, const TargetTree& targetTree) const;
  void onLattice(const LatticeBlocks& lattice, const BlockVisitor& visit,
                 std::string_view stage) const;

 private:
  const ChargeTree& tree_;
  const FastSumSettings& settings_;
  Proxies proxies_;
  FarField field_;
};

FieldSamples Hierarchy::at(const Points& points, const TargetTree& targetTree) const {
  Points local(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) local[i] = tree_.toLocal(points[i]);
  const BallTree targets = targetTree(local);
  const std::size_t channels = tree_.channels();
  FieldSamples out = samplesFor(points.size(), channels, settings_.gradients);
  descend(field_, targets,
          [&](const BallTree::Node& leaf, const Expansion& expansion, DescentWorkspace& work) {
            const std::uint32_t* order = targets.order().data() + leaf.begin;
            LeafSums& sums = work.sums;
            sums.atPoints(field_, local, order, leaf.count(), expansion, work.near,
                          settings_.gradients);
            for (std::size_t k = 0; k < channels; ++k)
              for (std::size_t i = 0; i < leaf.count(); ++i)
                out.values(order[i], k) = sums.values()[k * sums.stride() + i];
            for (std::size_t k = 0; settings_.gradients && k < 3 * channels; ++k)
              for (std::size_t i = 0; i < leaf.count(); ++i)
                out.gradients(order[i], k) = sums.gradients()[k * sums.stride() + i];
          },
          {});
  return out;
}

void Hierarchy::onLattice(const LatticeBlocks& lattice, const BlockVisitor& visit,
                          std::string_view stage) const {
  Points centers;
  std::vector<std::size_t> blocks;
  const std::vector<double> zeros(LatticeBlock::kPoints * tree_.channels() * 3, 0.0);
  for (std::size_t b = 0; b < lattice.blocks.size(); ++b) {
    const Block& block = lattice.blocks[b];
    if (nothingWanted(block)) {
      visit(b, zeros.data(), settings_.gradients ? zeros.data() : nullptr);
      continue;
    }
    blocks.push_back(b);
    centers.push_back(
        tree_.toLocal(0.5 * (pointOf(lattice, block, 0) + pointOf(lattice, block, 511))));
  }
  const double spacing = lattice.spacing * tree_.inverseScale();
  const BallTree targets(centers, LatticeBlock::radius() * spacing, 1, 3);
  const LatticeBlock polynomial(field_.basis().harmonics());
  descend(
      field_, targets,
      [&](const BallTree::Node& leaf, const Expansion& expansion, DescentWorkspace& work) {
        const std::size_t b = blocks[targets.order()[leaf.begin]];
        work.sums.atBlock(field_, polynomial, lattice.blocks[b].wanted, spacing, expansion,
                          work.near, settings_.gradients);
        visit(b, work.sums.values(), work.sums.gradients());
      },
      stage);
}

// A hierarchy, and how well it did at the points that are checked.
struct Checked {
  std::unique_ptr<const Hierarchy> hierarchy;               // null: plain sums are to be taken
  double excess = std::numeric_limits<double>::infinity();  // error over what is allowed
  double error = 0;                                         // in the values' units
};

// Orders are raised until what `sample(hierarchy)` gives is within the accuracy, or no better for
// it: where charges nearly cancel, rounding is most of the error, and no order reaches further.
// Then the best of them. keep() is called after the sample of each that is the best so far.
template <typename Sample, typename Keep>
Checked mostAccurate(const ChargeTree& tree, const SumSize& size, const FastSumSettings& settings,
                     const SumReference& reference, const Sample& sample, const Keep& keep) {
  Checked best;
  FarFieldPlan plan = planFor(reference.accuracy());
  while (plan.order <= ExpansionBasis::kMostOrder) {
    Checked now;
    now.hierarchy = std::make_unique<const Hierarchy>(tree, plan, settings);
    const FieldSamples got = sample(*now.hierarchy);
    now.excess = reference.excess(got);
    now.error = reference.error(got);
    const bool gains = now.excess < kLeastOrderGain * best.excess;
    plan = raised(plan, now.excess);
    if (now.excess < best.excess) {
      best = std::move(now);
      keep();
    }
    if (best.excess <= 1 || !gains) break;
  }
  if (best.excess > 1 && plainIsCheap(size)) best.hierarchy.reset();
  return best;
}

// Some blocks with a few wanted points each, spread over the lattice.
LatticeBlocks someOf(const LatticeBlocks& lattice) {
  LatticeBlocks out{lattice.origin, lattice.spacing, {}};
  std::size_t seed = 0;
  for (const std::size_t b : evenly(kSampledBlocks, lattice.blocks.size())) {
    const std::vector<std::uint16_t> places = placesOf(lattice.blocks[b]);
    if (places.empty()) continue;
    Block some{lattice.blocks[b].first, {}};
    const CounterRandom random(++seed, 5);
    for (std::size_t i = 0; i < kSampled / kSampledBlocks; ++i) {
      const std::size_t place = places[random.bits(i) % places.size()];
      some.wanted[place >> 6] |= std::uint64_t{1} << (place & 63);
    }
    out.blocks.push_back(some);
  }
  return out;
}

FieldSamples directAt(const Charges& charges, const LatticeBlocks& lattice, bool gradients) {
  Points points;
  for (const Block& b : lattice.blocks)
    for (const std::uint16_t place : placesOf(b)) points.push_back(pointOf(lattice, b, place));
  return sumCharges(charges, points, gradients);
}

// The wanted points of all blocks, in the order of directAt.
FieldSamples hierarchicalAt(const Hierarchy& hierarchy, const LatticeBlocks& lattice,
                            std::size_t channels, const FastSumSettings& settings) {
  std::vector<std::size_t> begin(lattice.blocks.size() + 1, 0);
  for (std::size_t b = 0; b < lattice.blocks.size(); ++b)
    begin[b + 1] = begin[b] + placesOf(lattice.blocks[b]).size();
  FieldSamples out = samplesFor(begin.back(), channels, settings.gradients);
  hierarchy.onLattice(lattice,
                      [&](std::size_t b, const double* values, const double* gradients) {
                        std::size_t row = begin[b];
                        for (const std::uint16_t place : placesOf(lattice.blocks[b])) {
                          for (std::size_t k = 0; k < channels; ++k)
                            out.values(row, k) = values[LatticeBlock::kPoints * k + place];
                          for (std::size_t k = 0; gradients && k < 3 * channels; ++k)
                            out.gradients(row, k) = gradients[LatticeBlock::kPoints * k + place];
                          ++row;
                        }
                      },
                      {});
  return out;
}

void directOnLattice(const Charges& charges, const LatticeBlocks& lattice,
                     const BlockVisitor& visit, const FastSumSettings& settings,
                     std::string_view stage) {
  parallelBlocks(
      lattice.blocks.size(), 1,
      [&](std::size_t b, std::size_t) {
        constexpr std::size_t kPoints = LatticeBlock::kPoints;
        const std::vector<std::uint16_t> places = placesOf(lattice.blocks[b]);
        const std::size_t n = places.size(), channels = charges.channels();
        Points points;
        for (const std::uint16_t p : places)
          points.push_back(pointOf(lattice, lattice.blocks[b], p));
        std::vector<double> sums(n * channels), slopes(settings.gradients ? 3 * n * channels : 0),
            values(kPoints * channels), gradients(settings.gradients ? 3 * kPoints * channels : 0);
        charges.addTo(points.data(), n, sums.data(), settings.gradients ? slopes.data() : nullptr);
        for (std::size_t k = 0; k < channels; ++k)
          for (std::size_t i = 0; i < n; ++i) values[kPoints * k + places[i]] = sums[n * k + i];
        for (std::size_t k = 0; settings.gradients && k < 3 * channels; ++k)
          for (std::size_t i = 0; i < n; ++i)
            gradients[kPoints * k + places[i]] = slopes[n * k + i];
        visit(b, values.data(), settings.gradients ? gradients.data() : nullptr);
      },
      stage);
}

}  // namespace

FieldSamples FastSum::at(const Points& points, const FastSumSettings& settings) const {
  const auto tree = [](const Points& local) {
    return BallTree(local, kLeastBall, kPointsPerLeaf, kHalvings);
  };
  return data_->at(points, tree, settings);
}

FieldSamples FastSum::at(const SumPoints& kept, const FastSumSettings& settings) const {
  const auto tree = [&](const Points& local) {
    return kept.data_->tree()->about(local, kLeastBall);
  };
  return data_->at(kept.points(), tree, settings);
}

FieldSamples FastSum::Data::at(const Points& points, const TargetTree& targets,
                               const FastSumSettings& settings) const {
  check(settings);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!isFinite(points[i]))
      throw DataError("sums: point " + std::to_string(i) + " is not finite");
  const auto plain = [&](const Points& some) {
    return sumCharges(direct, some, settings.gradients);
  };
  if (direct.count() == 0 || direct.channels() == 0 || points.empty()) return plain(points);
  SumSize size{direct.count(), points.size(), kPointsPerLeaf, kLeastOrder, settings.gradients};
  if (!useHierarchy(size, settings.method)) return plain(points);
  const std::vector<std::size_t> sample = evenly(kSampled, points.size());
  Points some;
  for (const std::size_t i : sample) some.push_back(points[i]);
  const SumReference reference(plain(some), sumCharges(direct.magnitudes(), some, false),
                               settings.accuracy, settings.absolute);
  size.order = planFor(reference.accuracy()).order;
  if (!useHierarchy(size, settings.method)) return plain(points);
  FieldSamples out, tried;
  const auto sampled = [&](const Hierarchy& hierarchy) {
    tried = hierarchy.at(points, targets);
    FieldSamples got = samplesFor(some.size(), direct.channels(), settings.gradients);
    for (std::size_t i = 0; i < sample.size(); ++i) {
      for (std::size_t k = 0; k < direct.channels(); ++k)
        got.values(i, k) = tried.values(sample[i], k);
      for (std::size_t k = 0; settings.gradients && k < 3 * direct.channels(); ++k)
        got.gradients(i, k) = tried.gradients(sample[i], k);
    }
    return got;
  };
  const Checked best =
      mostAccurate(tree, size, settings, reference, sampled, [&] { out = std::move(tried); });
  if (!best.hierarchy) return plain(points);
  out.error = best.error;
  return out;
}

double FastSum::onLattice(const LatticeBlocks& lattice, const BlockVisitor& visit,
                          const FastSumSettings& settings, std::string_view stage) const {
  check(settings);
  if (!(lattice.spacing > 0) || !isFinite(lattice.origin))
    throw SettingError("lattice", "needs a finite origin and a positive spacing");
  Checked best;
  if (count() > 0 && channels() > 0) {
    const LatticeBlocks some = someOf(lattice);
    const SumReference reference(directAt(data_->direct, some, settings.gradients),
                                 directAt(data_->direct.magnitudes(), some, false),
                                 settings.accuracy, settings.absolute);
    const SumSize size{count(), wantedPoints(lattice), LatticeBlock::kPoints,
                       planFor(reference.accuracy()).order, settings.gradients};
    if (useHierarchy(size, settings.method))
      best = mostAccurate(
          data_->tree, size, settings, reference,
          [&](const Hierarchy& tried) { return hierarchicalAt(tried, some, channels(), settings); },
          [] {});
  }
  if (!best.hierarchy) {
    directOnLattice(data_->direct, lattice, visit, settings, stage);
    return 0;
  }
  best.hierarchy->onLattice(lattice, visit, stage);
  return best.error;
}

}  // namespace innermap
