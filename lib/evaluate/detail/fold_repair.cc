#include "evaluate/detail/fold_repair.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <vector>

#include "core/kuhn_cells.h"
#include "core/orientation.h"
#include "innermap/core/run.h"
#include "lattice/untangle.h"

namespace innermap {
namespace {

using openvdb::Coord;

constexpr std::array<int, 3> kRings{2, 4, 8};
constexpr std::array<int, 4> kReaches{1, 2, 3, 4};  // of what a voxel in no tetrahedron follows
// Folded voxels near one another that are repaired, and voxels that move for that: more of them
// are no blemish beside a surface but a map that folds, and would take minutes.
constexpr std::size_t kMost = 3000, kMostMoved = 6000;
// The least stretch that is wanted of a tetrahedron that is not folded, of the middle one, unless
// the map flattens most of them more; the middle one, of the largest; the largest, of what an
// undeformed one has.
constexpr double kFlattest = 0.3, kThinnest = 1e-3, kSmallestWanted = 1e-6;
// Of the springs that hold voxels beside the surface, but for those that are in folded tetrahedra
// alone. Softer ones let voxels out of the target: 0.4% of spot in homer at 3, 0.15% at 30.
constexpr double kSkinStiffness = 30;
// Voxels have to be right side out, not well shaped: over five maps between strangers a third of
// the seconds of UntangleSettings' own, for the same voxels repaired, moved as far.
constexpr double kHaste = 0.9, kLeastStepGain = 1e-4;
constexpr std::size_t kRepairedLeaves = 8;  // that a thread takes at a time

Mat3 restOf(const std::array<int, 4>& tet) {
  Mat3 edges{};
  for (std::size_t e = 0; e < 3; ++e)
    for (std::size_t r = 0; r < 3; ++r) edges[r][e] = (tet[e + 1] >> r & 1) - (tet[0] >> r & 1);
  return inverse(edges);
}

// A Jacobian by its singular values, the least of them negative where it turns over.
struct Stretched {
  Eigen::Matrix3d from, to;  // J = to * diagonal(by) * from^T
  Eigen::Vector3d by;

  explicit Stretched(const Mat3& j) {
    Eigen::Matrix3d m;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        m(r, c) = j[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
    // Of a size that the compiler does not know: else it warns of Eigen's own code.
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
    by = svd.singularValues();
    to = svd.matrixU();
    from = svd.matrixV();
    if (to.determinant() * from.determinant() > 0) return;
    to.col(2) *= -1;
    by[2] *= -1;
  }

  double flatness() const { return by[2] / by[1]; }

  bool folded() const { return !(by[2] > 0); }

  // Right side out, and hardly flatter than is usual about it.
  Mat3 rightened(double usual) const {
    Eigen::Vector3d s = by;
    s[0] = std::max(s[0], kSmallestWanted);
    s[1] = std::max(s[1], kThinnest * s[0]);
    s[2] = std::max(s[2], (folded() ? usual : std::min(usual, kFlattest)) * s[1]);
    const Eigen::Matrix3d m = to * s.asDiagonal() * from.transpose();
    Mat3 out;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        out[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = m(r, c);
    return out;
  }
};

// The median of those that are right side out.
double usualFlatness(const std::vector<Stretched>& all) {
  std::vector<double> found;
  for (const Stretched& s : all)
    if (!s.folded()) found.push_back(s.flatness());
  if (found.empty()) return 1;
  const auto middle = found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2);
  std::nth_element(found.begin(), middle, found.end());
  return *middle;
}

// Voxels that are near one another: those whose cells, so many voxels wide, touch.
std::vector<std::vector<Coord>> clustersOf(const std::vector<Coord>& voxels, int width) {
  const auto cellOf = [width](const Coord& c) {
    const auto down = [width](int x) { return x >= 0 ? x / width : -((width - 1 - x) / width); };
    return Coord(down(c.x()), down(c.y()), down(c.z()));
  };
  std::map<Coord, std::vector<Coord>> cells;
  for (const Coord& c : voxels) cells[cellOf(c)].push_back(c);
  std::vector<std::vector<Coord>> out;
  while (!cells.empty()) {
    std::vector<Coord> cluster, open{cells.begin()->first};
    while (!open.empty()) {
      const Coord at = open.back();
      open.pop_back();
      const auto found = cells.find(at);
      if (found == cells.end()) continue;
      cluster.insert(cluster.end(), found->second.begin(), found->second.end());
      cells.erase(found);
      for (int n = 0; n < 27; ++n) open.push_back(at.offsetBy(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
    }
    out.push_back(std::move(cluster));
  }
  return out;
}

int senseOf(const FoldRepairSettings& settings) { return settings.mirrored ? -1 : 1; }

using Positions = std::unordered_map<Coord, Vec3, CoordHash>;

// The voxels inside the solid with their images, some of them moved.
class Voxels {
 public:
  Voxels(const openvdb::Vec3fGrid& map, const openvdb::FloatGrid& levelSet,
         const FoldRepairSettings& settings, const Positions& moved)
      : map_(map.getConstAccessor()),
        distance_(levelSet.getConstAccessor()),
        sense_(senseOf(settings)),
        moved_(moved) {}

  bool inside(const Coord& c) const { return distance_.getValue(c) < 0 && map_.isValueOn(c); }

  // World units of the target; of a mirrored map the images' reflections in x = 0.
  Vec3 original(const Coord& c) const {
    const openvdb::Vec3f p = map_.getValue(c);
    return {sense_ * p.x(), p.y(), p.z()};
  }

  Vec3 now(const Coord& c) const {
    const auto found = moved_.find(c);
    return found == moved_.end() ? original(c) : found->second;
  }

  // Calls `add` with the corners of each tetrahedron of a cube whose corners are all inside.
  template <class Add>
  void forTets(const Coord& cube, const Add& add) const {
    std::array<bool, 8> in;
    for (int bits = 0; bits < 8; ++bits)
      in[static_cast<std::size_t>(bits)] = inside(cornerOf(cube, bits));
    for (std::size_t k = 0; k < kKuhnCells.size(); ++k) {
      std::array<Coord, 4> corners;
      bool all = true;
      for (std::size_t i = 0; i < 4; ++i) {
        all = all && in[static_cast<std::size_t>(kKuhnCells[k][i])];
        corners[i] = cornerOf(cube, kKuhnCells[k][i]);
      }
      if (all) add(k, corners);
    }
  }

 private:
  openvdb::Vec3fGrid::ConstAccessor map_;
  openvdb::FloatGrid::ConstAccessor distance_;
  int sense_;
  const Positions& moved_;
};

// The cubes that have the voxel as a corner.
template <class Visit>
void forCubesAround(const Coord& c, const Visit& visit) {
  for (int bits = 0; bits < 8; ++bits)
    visit(c.offsetBy(-(bits & 1), -(bits >> 1 & 1), -(bits >> 2 & 1)));
}

const std::array<Mat3, 6>& rests() {
  static const std::array<Mat3, 6> all = [] {
    std::array<Mat3, 6> out;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = restOf(kKuhnCells[k]);
    return out;
  }();
  return all;
}

// The tetrahedra that have a voxel that may move: one that is near one of the folded.
class Patch {
 public:
  // unit: a voxel's size where the map takes it, world units.
  Patch(const Voxels& voxels, const std::vector<Coord>& folded, int rings, double unit)
      : voxels_(voxels), unit_(unit) {
    for (const Coord& c : folded) {
      for (int x = -rings; x <= rings; ++x)
        for (int y = -rings; y <= rings; ++y)
          for (int z = -rings; z <= rings; ++z)
            if (const Coord at = c.offsetBy(x, y, z); voxels.inside(at)) number(at);
      moving_ = coords_.size();
      if (tooLarge()) return;  // seeds far apart would take gigabytes
    }
    std::set<Coord> cubes;
    for (const Coord& c : coords_)
      forCubesAround(c, [&](const Coord& cube) { cubes.insert(cube); });
    for (const Coord& cube : cubes)
      voxels.forTets(cube, [&](std::size_t k, const std::array<Coord, 4>& corners) {
        addTet(corners, rests()[k]);
      });
    tets_.free.assign(coords_.size(), 0);
    std::fill_n(tets_.free.begin(), moving_, 1);
  }

  bool tooLarge() const { return moving_ > kMostMoved; }

  // Whether no tetrahedron is left inside out.
  bool repair() {
    keepShapes();
    UntangleSettings settings;
    settings.leastSigma = kHaste;
    settings.leastStepGain = kLeastStepGain;
    return untangle(tets_, settings) > 0;
  }

  void collect(Positions& to) const {
    for (std::size_t v = 0; v < coords_.size(); ++v)
      if (tets_.free[v]) to[coords_[v]] = unit_ * tets_.vertices[v];
  }

 private:
  int number(const Coord& c) {
    const auto [at, fresh] = numbers_.try_emplace(c, static_cast<int>(coords_.size()));
    if (fresh) {
      coords_.push_back(c);
      tets_.vertices.push_back((1 / unit_) * voxels_.now(c));
    }
    return at->second;
  }

  // Each tetrahedron wants to be as it is, but right side out and not flat: else the patch would
  // even out what the map stretches, and draw the solid's skin along.
  void keepShapes() {
    if (tets_.tets.empty()) return;
    std::vector<Stretched> now;
    for (std::size_t t = 0; t < tets_.tets.size(); ++t) now.emplace_back(jacobianOf(tets_, t));
    const double usual = usualFlatness(now);
    std::vector<char> held(coords_.size(), 0);
    double logSum = 0;
    for (std::size_t t = 0; t < tets_.tets.size(); ++t) {
      if (!now[t].folded())
        for (const int v : tets_.tets[t]) held[static_cast<std::size_t>(v)] = 1;
      const Mat3 wanted = now[t].rightened(usual);
      logSum += std::log(determinant(wanted));
      tets_.rest[t] = product(tets_.rest[t], inverse(wanted));
    }
    const double size = std::exp(logSum / (3 * static_cast<double>(tets_.tets.size())));
    for (Vec3& p : tets_.vertices) p = (1 / size) * p;
    for (Mat3& rest : tets_.rest)
      for (auto& row : rest)
        for (double& x : row) x *= size;
    unit_ *= size;
    for (std::size_t v = 0; v < coords_.size(); ++v)
      if (held[v] && tets_.free[v] && onSkin(coords_[v]))
        tets_.springs.push_back({static_cast<int>(v), tets_.vertices[v], {}, kSkinStiffness});
  }

  // Whether a voxel about it is outside.
  bool onSkin(const Coord& c) const {
    for (int n = 0; n < 27; ++n)
      if (!voxels_.inside(c.offsetBy(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1))) return true;
    return false;
  }

  void addTet(const std::array<Coord, 4>& corners, const Mat3& rest) {
    const bool moves = std::any_of(corners.begin(), corners.end(), [&](const Coord& c) {
      const auto found = numbers_.find(c);
      return found != numbers_.end() && static_cast<std::size_t>(found->second) < moving_;
    });
    if (!moves) return;
    std::array<int, 4> tet;
    for (std::size_t i = 0; i < 4; ++i) tet[i] = number(corners[i]);
    tets_.tets.push_back(tet);
    tets_.rest.push_back(rest);
  }

  const Voxels& voxels_;
  double unit_;
  std::size_t moving_ = 0;  // the first of the vertices
  TetPatch tets_;
  std::unordered_map<Coord, int, CoordHash> numbers_;
  std::vector<Coord> coords_;
};

// For a voxel that is in no tetrahedron: where the affine map nearest to the images of those about
// it takes it, by least squares. As few of them as give one that is not folded; none where no
// neighbourhood does.
std::optional<RepairedVoxel> followedAt(const Voxels& voxels, const Coord& at, double spacing) {
  for (const int reach : kReaches) {
    std::vector<Vec3> from, to;
    for (int x = -reach; x <= reach; ++x)
      for (int y = -reach; y <= reach; ++y)
        for (int z = -reach; z <= reach; ++z) {
          const Coord c = at.offsetBy(x, y, z);
          if (c == at || !voxels.inside(c)) continue;
          from.push_back({spacing * x, spacing * y, spacing * z});
          to.push_back(voxels.now(c));
        }
    if (from.size() < 4) continue;
    Vec3 fromMean, toMean;
    for (std::size_t i = 0; i < from.size(); ++i) {
      fromMean += (1 / static_cast<double>(from.size())) * from[i];
      toMean += (1 / static_cast<double>(from.size())) * to[i];
    }
    Mat3 products{}, squares{};
    for (std::size_t i = 0; i < from.size(); ++i) {
      const Vec3 way = from[i] - fromMean, image = to[i] - toMean;
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) {
          products[r][c] += image[static_cast<int>(r)] * way[static_cast<int>(c)];
          squares[r][c] += way[static_cast<int>(r)] * way[static_cast<int>(c)];
        }
    }
    const Mat3 j = product(products, inverse(squares));
    if (const double det = determinant(j); det > 0 && std::isfinite(det))
      return RepairedVoxel{toMean - j * fromMean, j};
  }
  return {};
}

// Where the voxel is now, with the mean of the tetrahedra about it; where that is folded, though
// none of them is, the largest. spacing: of the voxels, world units. None where all are folded.
std::optional<RepairedVoxel> repairedAt(const Voxels& voxels, const Coord& at, double spacing) {
  std::vector<Mat3> all;
  forCubesAround(at, [&](const Coord& cube) {
    voxels.forTets(cube, [&](std::size_t k, const std::array<Coord, 4>& corners) {
      if (std::find(corners.begin(), corners.end(), at) == corners.end()) return;
      TetPatch one;
      for (const Coord& c : corners) one.vertices.push_back((1 / spacing) * voxels.now(c));
      one.tets = {{0, 1, 2, 3}};
      one.rest = {rests()[k]};
      all.push_back(jacobianOf(one, 0));
    });
  });
  if (all.empty()) return followedAt(voxels, at, spacing);
  Mat3 mean{}, largest{};
  for (const Mat3& j : all) {
    if (determinant(j) > determinant(largest)) largest = j;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) mean[r][c] += j[r][c] / static_cast<double>(all.size());
  }
  const Mat3& j = determinant(mean) > 0 ? mean : largest;
  if (!(determinant(j) > 0)) return {};
  return RepairedVoxel{voxels.now(at), j};
}

// Repairs clusters side by side, each moving voxels that no other one looks at; the voxels of those
// where that failed. pass: number of kRings.
std::vector<Coord> repairWith(std::size_t pass, const std::vector<Coord>& folded,
                              const openvdb::Vec3fGrid& map, const openvdb::FloatGrid& levelSet,
                              const FoldRepairSettings& settings, Positions& moved) {
  const int rings = kRings[pass];
  const auto clusters = clustersOf(folded, 2 * rings + 2);
  std::vector<Positions> parts(clusters.size());
  std::vector<char> done(clusters.size(), 0);
  std::atomic<std::size_t> passed{0};
  const auto pastCluster = [&](std::size_t c) {
    const double share =
        static_cast<double>(passed += clusters[c].size()) / static_cast<double>(folded.size());
    reportProgress(kRepairing, (static_cast<double>(pass) + share) / kRings.size());
  };
  parallelBlocks(clusters.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      if (clusters[c].size() > kMost) continue;
      const Voxels voxels(map, levelSet, settings, moved);
      Patch patch(voxels, clusters[c], rings, settings.growth * levelSet.voxelSize()[0]);
      if (patch.tooLarge()) continue;
      done[c] = patch.repair();
      patch.collect(parts[c]);
      pastCluster(c);
    }
  });
  std::vector<Coord> left;
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    for (const auto& [at, position] : parts[c]) moved[at] = position;
    if (!done[c]) left.insert(left.end(), clusters[c].begin(), clusters[c].end());
  }
  return left;
}

// Voxels inside whose Jacobian is not above 0, and the corners of cells that are inside out; each
// once, in order.
std::vector<Coord> foldedVoxels(const openvdb::Vec3fGrid& map, const openvdb::FloatGrid& jacobian,
                                const openvdb::FloatGrid& levelSet,
                                const FoldRepairSettings& settings) {
  std::vector<const openvdb::Vec3STree::LeafNodeType*> leaves;
  for (auto leaf = map.tree().cbeginLeaf(); leaf; ++leaf) leaves.push_back(&*leaf);
  std::vector<std::vector<Coord>> parts(leaves.size());
  parallelBlocks(leaves.size(), kRepairedLeaves, [&](std::size_t begin, std::size_t end) {
    const Positions none;
    const Voxels voxels(map, levelSet, settings, none);
    auto determinants = jacobian.getConstAccessor();
    for (std::size_t l = begin; l < end; ++l)
      for (auto voxel = leaves[l]->cbeginValueOn(); voxel; ++voxel) {
        const Coord at = voxel.getCoord();
        if (!voxels.inside(at)) continue;
        if (!(senseOf(settings) * determinants.getValue(at) > 0)) parts[l].push_back(at);
        voxels.forTets(at, [&](std::size_t, const std::array<Coord, 4>& corners) {
          const auto image = [&](std::size_t i) { return voxels.original(corners[i]); };
          std::uint64_t exact = 0;
          if (orientation(image(0), image(1), image(2), image(3), exact) != Sign::positive)
            parts[l].insert(parts[l].end(), corners.begin(), corners.end());
        });
      }
  });
  std::set<Coord> all;
  for (const std::vector<Coord>& part : parts) all.insert(part.begin(), part.end());
  return {all.begin(), all.end()};
}

}  // namespace

FoldRepair repairFolds(const openvdb::Vec3fGrid& map, const openvdb::FloatGrid& jacobian,
                       const openvdb::FloatGrid& levelSet, const FoldRepairSettings& settings) {
  Positions moved;
  const Voxels voxels(map, levelSet, settings, moved);
  const auto repair = [&](std::vector<Coord> seeds, double from, double to) {
    PartOfStage part(from, to);
    FoldRepairSettings s = settings;
    for (std::size_t pass = 0; pass < kRings.size() && !seeds.empty(); ++pass) {
      if (outOfTime()) break;
      seeds = repairWith(pass, seeds, map, levelSet, s, moved);
    }
    return seeds;
  };
  const std::vector<Coord> left = repair(foldedVoxels(map, jacobian, levelSet, settings), 0, 0.8);
  // Where cells that are inside out are too many, there may be few voxels that are.
  std::vector<Coord> worst;
  auto determinants = jacobian.getConstAccessor();
  std::copy_if(left.begin(), left.end(), std::back_inserter(worst), [&](const Coord& at) {
    return !(senseOf(settings) * determinants.getValue(at) > 0);
  });
  if (worst.size() < left.size()) repair(worst, 0.8, 1);
  FoldRepair out;
  for (const auto& entry : moved) {
    const Coord& at = entry.first;
    std::optional<RepairedVoxel> repaired = repairedAt(voxels, at, levelSet.voxelSize()[0]);
    if (!repaired) continue;
    out.farthest = std::max(out.farthest, norm(repaired->position - voxels.original(at)));
    repaired->position.x *= senseOf(settings);
    for (double& slope : repaired->jacobian[0]) slope *= senseOf(settings);
    out.voxels[at] = *repaired;
  }
  return out;
}

}  // namespace innermap
