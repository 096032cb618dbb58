#include "lattice/stuffing.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr char kFilling[] = "filling with tetrahedra";

// Corners of a lattice tetrahedron are 0 to 3, the cuts of its edges 4 to 9.
constexpr int kEdges[6][2] = {{0, 1}, {2, 3}, {0, 2}, {0, 3}, {1, 2}, {1, 3}};

int cutOf(int p, int q) {
  for (int e = 0; e < 6; ++e)
    if ((kEdges[e][0] == p && kEdges[e][1] == q) || (kEdges[e][0] == q && kEdges[e][1] == p))
      return 4 + e;
  return -1;
}

using Local = std::array<int, 4>;

struct Filling {
  int count = 0;
  std::array<Local, 3> tetrahedra{};
};

// How one of the twelve tetrahedra is filled, for each of the 3^4 sides of its corners.
class FillingTable {
 public:
  explicit FillingTable(const BccTetrahedron& shape) : shape_(shape) {
    for (int code = 0; code < 81; ++code) {
      std::array<NodeSide, 4> side{};
      for (int i = 0, c = code; i < 4; ++i, c /= 3) side[i] = static_cast<NodeSide>(c % 3);
      fillings_[code] = fillingOf(side);
    }
  }
  const Filling& operator[](int code) const { return fillings_[code]; }

 private:
  // The end at which the diagonal of the quadrilateral p, q and their cuts towards o starts. Both
  // tetrahedra that share the face find the same.
  int diagonalFrom(int p, int q, int o) const {
    const auto second = [](int corner) { return corner >> 1; };
    if (second(p) == second(q)) {
      int exceed = 0;
      for (int a = 0; a < 3; ++a) exceed += shape_.place[o][a] > shape_.place[p][a];
      return exceed % 2 == 0 ? p : q;
    }
    return second(p) == second(o) ? q : p;  // it ends at the long edge's cut
  }

  Filling fillingOf(const std::array<NodeSide, 4>& side) const {
    std::array<int, 4> in{}, other{};
    int ins = 0, others = 0, outs = 0;
    for (int i = 0; i < 4; ++i) {
      if (side[i] == NodeSide::inside)
        in[ins++] = i;
      else
        other[others++] = i;
      outs += side[i] == NodeSide::outside;
    }
    Filling f;
    if (ins == 0) return f;
    if (outs == 0) {
      add(f, {0, 1, 2, 3});
    } else if (ins == 1) {
      Local t{in[0], 0, 0, 0};
      for (int k = 0; k < 3; ++k)
        t[k + 1] = side[other[k]] == NodeSide::outside ? cutOf(in[0], other[k]) : other[k];
      add(f, t);
    } else if (ins == 2 && outs == 1) {
      const int o = side[other[0]] == NodeSide::outside ? other[0] : other[1];
      const int apex = other[0] + other[1] - o;
      const int p = diagonalFrom(in[0], in[1], o), q = in[0] + in[1] - p;
      add(f, {p, q, cutOf(q, o), apex});
      add(f, {p, cutOf(q, o), cutOf(p, o), apex});
    } else if (ins == 2) {
      addWedge(f, {in[0], cutOf(in[0], other[0]), cutOf(in[0], other[1])},
               {in[1], cutOf(in[1], other[0]), cutOf(in[1], other[1])},
               {diagonalFrom(in[0], in[1], other[0]) == in[0],
                diagonalFrom(in[0], in[1], other[1]) == in[0]});
    } else {
      const int o = other[0];
      const auto first = [&](int i, int j) { return diagonalFrom(in[i], in[j], o) == in[i]; };
      addWedge(f, {in[0], in[1], in[2]}, {cutOf(in[0], o), cutOf(in[1], o), cutOf(in[2], o)},
               {first(0, 1), first(0, 2)}, first(1, 2));
    }
    return f;
  }

  // Between triangles t and u; the diagonal of sides (0, k) starts at t[0] where `first[k - 1]`.
  // Without `last` the one of sides (1, 2) is on the surface and free.
  void addWedge(Filling& f, const std::array<int, 3>& t, const std::array<int, 3>& u,
                const std::array<bool, 2>& first, std::optional<bool> last = {}) const;

  void add(Filling& f, Local t) const {
    std::array<std::array<int, 3>, 4> p{};
    for (int i = 0; i < 4; ++i)
      for (int a = 0; a < 3; ++a)
        p[i][a] = t[i] < 4
                      ? 2 * shape_.place[t[i]][a]
                      : shape_.place[kEdges[t[i] - 4][0]][a] + shape_.place[kEdges[t[i] - 4][1]][a];
    const auto vec = [&](int i) {
      return Vec3{double(p[i][0] - p[0][0]), double(p[i][1] - p[0][1]), double(p[i][2] - p[0][2])};
    };
    if (dot(vec(1), cross(vec(2), vec(3))) < 0) std::swap(t[2], t[3]);
    f.tetrahedra[f.count++] = t;
  }

  BccTetrahedron shape_;
  std::array<Filling, 81> fillings_;
};

void FillingTable::addWedge(Filling& f, const std::array<int, 3>& t, const std::array<int, 3>& u,
                            const std::array<bool, 2>& first, std::optional<bool> last) const {
  // Any choice but the one that leaves a cycle of three diagonals.
  const bool third = last ? *last : first[0] == first[1] || !first[0];
  std::array<int, 3> leaving{};
  ++leaving[first[0] ? 0 : 1];
  ++leaving[first[1] ? 0 : 2];
  ++leaving[third ? 1 : 2];
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return leaving[a] > leaving[b]; });
  const auto [i, j, k] = order;
  add(f, Local{t[i], u[i], u[j], u[k]});
  add(f, Local{t[i], t[j], u[j], u[k]});
  add(f, Local{t[i], t[j], t[k], u[k]});
}

// Where a block of nodes starts in the numbering of vertices: inside with cuts, inside without, on
// the surface, cuts.
using Counts = std::array<std::int64_t, 4>;

class Stuffer {
 public:
  explicit Stuffer(const LatticeSigns& signs) : signs_(signs), lattice_(signs.lattice) {
    const auto shapes = bccTetrahedra(lattice_);
    for (const BccTetrahedron& shape : shapes) {
      shapes_.push_back(shape);
      tables_.push_back(FillingTable(shape));
    }
  }

  StuffedMesh run() {
    numberVertices();
    placeVertices();
    fill();
    return std::move(mesh_);
  }

 private:
  static constexpr std::size_t kBlock = 1 << 15;
  static constexpr double kHeld = 1.1;

  int cutsOf(std::size_t node) const {
    const auto& offsets = lattice_.offsets(lattice_.second(node));
    int mask = 0;
    for (int d = 0; d < kDirections; ++d)
      mask |= (signs_.side[node + static_cast<std::size_t>(offsets[d])] == NodeSide::outside) << d;
    return mask;
  }

  bool touchesInside(std::size_t node) const {
    const auto& offsets = lattice_.offsets(lattice_.second(node));
    for (const std::ptrdiff_t offset : offsets)
      if (signs_.side[node + static_cast<std::size_t>(offset)] == NodeSide::inside) return true;
    return false;
  }

  // Calls use(kind, node, cuts) for each node that becomes a vertex; kinds as in Counts.
  template <class Use>
  void forUsed(std::size_t begin, std::size_t end, const Use& use) const {
    for (std::size_t node = begin; node < end; ++node) {
      if (signs_.side[node] == NodeSide::outside) continue;
      if (signs_.side[node] == NodeSide::inside) {
        const int cuts = cutsOf(node);
        use(cuts ? 0 : 1, node, cuts);
      } else if (touchesInside(node)) {
        use(2, node, 0);
      }
    }
  }

  void numberVertices() {
    const std::size_t nodes = lattice_.nodes();
    starts_.assign((nodes + kBlock - 1) / kBlock, Counts{});
    parallelBlocks(
        nodes, kBlock,
        [&](std::size_t begin, std::size_t end) {
          Counts& c = starts_[begin / kBlock];
          forUsed(begin, end, [&](int kind, std::size_t, int cuts) {
            ++c[kind];
            c[3] += __builtin_popcount(static_cast<unsigned>(cuts));
          });
        },
        kFilling);
    std::int64_t next = 0;
    for (int kind = 0; kind < 4; ++kind) {
      if (kind == 2) mesh_.firstBoundary = static_cast<int>(next);
      for (Counts& c : starts_) {
        const std::int64_t count = c[kind];
        c[kind] = next;
        next += count;
      }
      if (kind == 0) withCuts_ = next;
      if (kind == 2) mesh_.unwarped.resize(static_cast<std::size_t>(next) - mesh_.firstBoundary);
      if (next > std::numeric_limits<int>::max())
        throw MemoryError("over two billion vertices: use a lower resolution");
    }
    mesh_.vertices.resize(static_cast<std::size_t>(next));
  }

  void placeVertices() {
    id_.assign(lattice_.nodes(), -1);
    cutMask_.resize(static_cast<std::size_t>(withCuts_));
    cutStart_.resize(static_cast<std::size_t>(withCuts_));
    parallelBlocks(
        lattice_.nodes(), kBlock,
        [&](std::size_t begin, std::size_t end) {
          Counts at = starts_[begin / kBlock];
          forUsed(begin, end, [&](int kind, std::size_t node, int cuts) {
            const auto id = static_cast<int>(at[kind]++);
            id_[node] = id;
            mesh_.vertices[id] = kind == 2 ? onEdge(node, signs_.onEdge[node],
                                                    cutShare(signs_, node, signs_.onEdge[node]))
                                           : lattice_.position(node);
            if (kind == 2) mesh_.unwarped[id - mesh_.firstBoundary] = lattice_.position(node);
            if (kind != 0) return;
            cutMask_[id] = static_cast<std::uint16_t>(cuts);
            cutStart_[id] = static_cast<int>(at[3]);
            for (int d = 0; d < kDirections; ++d)
              if (cuts >> d & 1) mesh_.vertices[at[3]++] = onEdge(node, d, heldShare(node, d));
          });
        },
        kFilling);
  }

  // Cuts that are too near to a node that could not be warped are kept off it, a little farther
  // than need be: warped neighbours may come close from elsewhere.
  double heldShare(std::size_t node, int direction) const {
    const double share = cutShare(signs_, node, direction), least = leastCut(direction);
    if (share < least) return kHeld * least;
    return share > 1 - least ? 1 - kHeld * least : share;
  }

  Vec3 onEdge(std::size_t node, int direction, double share) const {
    const Vec3 a = lattice_.position(node);
    return a + share * (lattice_.position(lattice_.neighbour(node, direction)) - a);
  }

  // Calls use(shape, cell, filling) for each lattice tetrahedron with something inside.
  template <class Use>
  void forFilled(std::size_t begin, std::size_t end, const Use& use) const {
    for (std::size_t c = begin; c < end; ++c)
      for (std::size_t s = 0; s < shapes_.size(); ++s) {
        const auto& offset = shapes_[s].offset;
        int code = static_cast<int>(signs_.side[c]);
        int factor = 1;
        for (int i = 1; i < 4; ++i)
          code += (factor *= 3) *
                  static_cast<int>(signs_.side[c + static_cast<std::size_t>(offset[i])]);
        const Filling& filling = tables_[s][code];
        if (filling.count > 0) use(s, c, filling);
      }
  }

  int vertexOf(const BccTetrahedron& shape, std::size_t cell, int local) const {
    const auto node = [&](int corner) {
      return cell + static_cast<std::size_t>(shape.offset[corner]);
    };
    if (local < 4) return id_[node(local)];
    int p = kEdges[local - 4][0], q = kEdges[local - 4][1];
    if (signs_.side[node(p)] != NodeSide::inside) std::swap(p, q);
    const int id = id_[node(p)], d = shape.direction[p][q];
    return cutStart_[id] + __builtin_popcount(static_cast<unsigned>(cutMask_[id] & ((1 << d) - 1)));
  }

  void fill() {
    // Cells at the lattice's sides have no neighbours, and nothing inside.
    const auto& n = lattice_.size();
    const std::size_t margin = 1 + n[0] + static_cast<std::size_t>(n[0]) * n[1];
    const std::size_t cells = lattice_.cells() - 2 * margin;
    std::vector<std::size_t> starts((cells + kBlock - 1) / kBlock + 1, 0);
    parallelBlocks(
        cells, kBlock,
        [&](std::size_t begin, std::size_t end) {
          std::size_t& count = starts[begin / kBlock + 1];
          forFilled(begin + margin, end + margin,
                    [&](std::size_t, std::size_t, const Filling& f) { count += f.count; });
        },
        kFilling);
    for (std::size_t b = 1; b < starts.size(); ++b) starts[b] += starts[b - 1];
    mesh_.tetrahedra.resize(starts.back());
    parallelBlocks(
        cells, kBlock,
        [&](std::size_t begin, std::size_t end) {
          Tetrahedron* out = mesh_.tetrahedra.data() + starts[begin / kBlock];
          forFilled(begin + margin, end + margin,
                    [&](std::size_t s, std::size_t c, const Filling& f) {
                      for (int k = 0; k < f.count; ++k, ++out)
                        for (int i = 0; i < 4; ++i)
                          (*out)[i] = vertexOf(shapes_[s], c, f.tetrahedra[k][i]);
                    });
        },
        kFilling);
  }

  const LatticeSigns& signs_;
  const BccLattice& lattice_;
  std::vector<BccTetrahedron> shapes_;
  std::vector<FillingTable> tables_;
  std::vector<Counts> starts_;
  std::int64_t withCuts_ = 0;
  std::vector<int> id_;                 // #nodes
  std::vector<std::uint16_t> cutMask_;  // of vertices inside with cuts: the directions cut
  std::vector<int> cutStart_;           // and the first cut's vertex
  StuffedMesh mesh_;
};

}  // namespace

std::vector<Triangle> boundaryOf(const StuffedMesh& mesh) {
  CellMesh outer;
  outer.vertices = mesh.vertices;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    int on = 0;
    for (const int v : t) on += v >= mesh.firstBoundary;
    if (on >= 3) outer.tetrahedra.push_back(t);
  }
  std::vector<Triangle> triangles = boundaryTriangles(outer);
  triangles.erase(std::remove_if(triangles.begin(), triangles.end(),
                                 [&](const Triangle& t) {
                                   return std::min({t[0], t[1], t[2]}) < mesh.firstBoundary;
                                 }),
                  triangles.end());
  return triangles;
}

StuffedMesh stuffed(const LatticeSigns& signs) { return Stuffer(signs).run(); }

}  // namespace innermap
