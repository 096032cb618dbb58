#include "surface/detail/topology/shell_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "innermap/core/error.h"
#include "surface/detail/refining/target_metric.h"

namespace innermap {
namespace {

std::vector<int> childrenOf(const SurfaceShells& s, int parent) {
  std::vector<int> out;
  for (int i = 0; i < static_cast<int>(s.shells.size()); ++i)
    if (s.parent[i] == parent) out.push_back(i);
  return out;
}

// The shell's genus and, in brackets, those inside it: equal for shells that can be mapped.
std::string form(const SurfaceShells& s, int shell) {
  std::vector<std::string> inner;
  for (const int c : childrenOf(s, shell)) inner.push_back(form(s, c));
  std::sort(inner.begin(), inner.end());
  std::string out = std::to_string(s.shells[shell].genus);
  for (std::size_t i = 0; i < inner.size(); ++i)
    out += (i == 0 ? "(" : ", ") + inner[i] + (i + 1 == inner.size() ? ")" : "");
  return out;
}

// "1 closed surface outside and 1 inside it, of 0, 0 handles".
std::string forms(const SurfaceShells& s) {
  std::vector<int> handles;
  for (const auto& shell : s.shells) handles.push_back(shell.genus);
  const std::size_t outer = childrenOf(s, -1).size(), inner = s.shells.size() - outer;
  return fmt::format("{} closed surface{}{}, of {} handle{}", outer, outer == 1 ? "" : "s",
                     inner == 0 ? std::string() : fmt::format(" and {} inside", inner),
                     fmt::join(handles, ", "), handles.size() == 1 && handles[0] == 1 ? "" : "s");
}

class Pairing {
 public:
  Pairing(const SurfaceShells& a, const SurfaceShells& b, const ShellPairSettings& settings)
      : a_(a), b_(b), settings_(settings), target_(a.shells.size(), -1) {}

  std::vector<int> run() {
    match(-1, -1);
    return target_;
  }

 private:
  // Whether a shell of A, or one inside it, is wanted at a shell of B or inside that.
  bool wanted(int i, int j) const {
    return std::any_of(settings_.wanted.begin(), settings_.wanted.end(), [&](const auto& w) {
      return within(a_, w.first, i) && within(b_, w.second, j);
    });
  }
  static bool within(const SurfaceShells& s, int shell, int of) {
    while (shell >= 0 && shell != of) shell = s.parent[shell];
    return shell == of;
  }

  double cost(int i, int j) const {
    const double wish = wanted(i, j) ? -1e300 : 0;
    if (wish < 0) return wish;
    if (settings_.aligned)
      return norm(boundingBox(a_.shells[i].vertices).center() -
                  boundingBox(b_.shells[j].vertices).center());
    // Large ones to large ones: the sum of the products is largest when both are in order.
    return -1 / (unitAreaScale(a_.shells[i].vertices, a_.shells[i].triangles) *
                 unitAreaScale(b_.shells[j].vertices, b_.shells[j].triangles));
  }

  void match(int parentA, int parentB) {
    struct Choice {
      double cost;
      int i, j;
    };
    std::vector<Choice> choices;
    for (const int i : childrenOf(a_, parentA))
      for (const int j : childrenOf(b_, parentB))
        if (form(a_, i) == form(b_, j)) choices.push_back({cost(i, j), i, j});
    std::stable_sort(choices.begin(), choices.end(),
                     [](const Choice& x, const Choice& y) { return x.cost < y.cost; });
    std::vector<char> taken(b_.shells.size(), 0);
    for (const Choice& c : choices) {
      if (target_[c.i] >= 0 || taken[c.j]) continue;
      target_[c.i] = c.j;
      taken[c.j] = 1;
      match(c.i, c.j);
    }
  }

  const SurfaceShells &a_, &b_;
  const ShellPairSettings& settings_;
  std::vector<int> target_;
};

}  // namespace

std::vector<int> pairShells(const SurfaceShells& a, const SurfaceShells& b,
                            const ShellPairSettings& settings) {
  const auto sorted = [](const SurfaceShells& s) {
    std::vector<std::string> out;
    for (const int r : childrenOf(s, -1)) out.push_back(form(s, r));
    std::sort(out.begin(), out.end());
    return out;
  };
  if (sorted(a) != sorted(b)) {
    if (a.shells.size() == 1 && b.shells.size() == 1)
      throw DataError(fmt::format(
          "{} has genus {} (handles) and {} has genus {}: solids of different topology have no map "
          "without tears; close or open a handle of one of them",
          a.mesh.name, a.shells[0].genus, b.mesh.name, b.shells[0].genus));
    throw DataError(fmt::format(
        "{} has {}; {} has {}: "
        "solids of different topology have no map without tears; make their shells alike",
        a.mesh.name, forms(a), b.mesh.name, forms(b)));
  }
  return Pairing(a, b, settings).run();
}

}  // namespace innermap
