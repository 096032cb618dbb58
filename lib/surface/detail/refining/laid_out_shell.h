// What maps of one closed surface onto another, of genus 0 or 1, are made from and made into.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "innermap/core/error.h"
#include "innermap/surface/correspond.h"
#include "surface/detail/refining/anchor_flow.h"
#include "surface/detail/refining/target_metric.h"
#include "surface/detail/sphere/limb_tips.h"

namespace innermap {

// A surface with its layout and what maps from it and onto it need. Cannot be copied or moved.
struct LaidOutShell {
  // Lays the surface out, which must outlive it. Throws as layOutSphere() and layOutTorus().
  explicit LaidOutShell(const ClosedSurface& surface);
  // With a layout at hand, which is copied.
  LaidOutShell(const ClosedSurface& surface, Layout layout);
  LaidOutShell(const LaidOutShell&) = delete;
  LaidOutShell& operator=(const LaidOutShell&) = delete;

  const ClosedSurface& surface;
  const Layout layout;
  const TargetMetric metric;
  const LimbTips tips;  // none on the torus
};

struct ShellMapSettings {
  std::vector<Anchor> landmarks;  // vertices of A, places in B's layout
  bool aligned = false;
  int candidates = 3;  // that are refined to the end
  bool refine = true;
  const MapJudge* judge = nullptr;  // none: the least energy decides
  WantedWay wanted;                 // with a judge
  std::uint64_t seed = 1;
};

struct ShellMap {
  Layout image;        // of A on B's model space
  double energy = 0;   // both ways, 8 for an isometry
  std::string origin;  // of the candidate that became it
  int way = 1;         // of those that differ, by preference
  std::vector<ConsideredMap> considered;
  std::optional<OtherWay> other;
};

DataError noMapWithoutFlips(const ClosedSurface& surface);

}  // namespace innermap
