#include "innermap/surface/correspond.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "mesh/triangle_tree.h"
#include "surface/detail/handles/cut_alike.h"
#include "surface/detail/handles/glued_map.h"
#include "surface/detail/refining/locate.h"
#include "surface/detail/refining/shell_map.h"
#include "surface/detail/refining/subdivide.h"
#include "surface/detail/refining/ways_round.h"
#include "surface/detail/topology/shell_pairs.h"

namespace innermap {
namespace {

// Measured: of splitting, and of carrying back and measuring what is split.
constexpr std::uint64_t kBytesATriangle = 1400;

// A landmark by shells.
struct ShellLandmark {
  int shell = 0, vertex = 0;  // of A
  int targetShell = 0;        // of B
  SurfacePoint onTarget;      // there
};

void check(const CorrespondSettings& settings) {
  requireNumber("candidates", settings.candidates, {1, 64});
  if (!(settings.subdivide >= 0 && settings.subdivide < 1))
    throw SettingError("subdivide", "must be a share of the diagonal from 0 to 1");
}

std::vector<ShellLandmark> shellLandmarks(const std::vector<Landmark>& landmarks,
                                          const SurfaceShells& a, const SurfaceShells& b) {
  std::vector<ShellVertex> where(b.mesh.triangles.size());
  for (std::size_t s = 0; s < b.shells.size(); ++s)
    for (std::size_t t = 0; t < b.meshTriangle[s].size(); ++t)
      where[b.meshTriangle[s][t]] = {static_cast<int>(s), static_cast<int>(t)};
  std::vector<ShellLandmark> out;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& l = landmarks[i];
    const auto refuse = [&](const std::string& what) {
      throw SettingError("landmarks", fmt::format("number {}: {}", i + 1, what));
    };
    if (l.vertex < 0 || l.vertex >= static_cast<int>(a.shellVertex.size()))
      refuse(fmt::format("{} has no vertex {}", a.mesh.name, l.vertex));
    const ShellVertex v = a.shellVertex[l.vertex];
    if (v.shell < 0)
      refuse(fmt::format("vertex {} of {} is in no triangle", l.vertex, a.mesh.name));
    const int t = l.onTarget.triangle;
    if (t < 0 || t >= static_cast<int>(where.size()) || where[t].shell < 0)
      refuse(fmt::format("{} has no triangle {}", b.mesh.name, t));
    double sum = 0;
    for (const double w : l.onTarget.barycentric) {
      if (!(w >= -1e-9)) refuse("its target lies outside its triangle");
      sum += w;
    }
    if (!(std::abs(sum - 1) < 1e-6)) refuse("its barycentric coordinates do not sum to 1");
    out.push_back({v.shell, v.vertex, where[t].shell, {where[t].vertex, l.onTarget.barycentric}});
    for (std::size_t k = 0; k < i; ++k) {
      if (out[k].shell == v.shell && out[k].vertex == v.vertex)
        refuse(fmt::format("the same vertex as number {}; leave one of them out", k + 1));
      const Vec3 p = positionOf(b.mesh, l.onTarget), q = positionOf(b.mesh, landmarks[k].onTarget);
      if (norm(p - q) <= 1e-12 * boundingBox(b.mesh).diagonal())
        refuse(fmt::format("the same place of {} as number {}; leave one of them out", b.mesh.name,
                           k + 1));
    }
  }
  return out;
}

Vec3 placeOf(const SurfacePoint& p, const std::vector<Triangle>& triangles, const Layout& layout) {
  Vec3 sum;
  for (int k = 0; k < 3; ++k) sum += p.barycentric[k] * layout.corner(triangles, p.triangle, k);
  return layout.space == ModelSpace::sphere ? sum / norm(sum) : sum;
}

Vec3 pointOf(const SurfacePoint& p, const ClosedSurface& surface) {
  Vec3 sum;
  for (int k = 0; k < 3; ++k)
    sum += p.barycentric[k] * surface.vertices[surface.triangles[p.triangle][k]];
  return sum;
}

// Where the image's vertices are on the target; those of landmarks exactly.
void locateVertices(ShellCorrespondence& map, const ClosedSurface& target, const Locator& locator,
                    const std::vector<std::pair<int, SurfacePoint>>& exact) {
  map.onTarget.clear();
  map.positions.clear();
  for (const Vec3& p : map.image.place) {
    const Located where = locator.find(p);
    map.onTarget.push_back({where.triangle, locator.barycentric(p, where)});
    map.positions.push_back(pointOf(map.onTarget.back(), target));
  }
  for (const auto& [vertex, point] : exact) {
    map.onTarget[vertex] = point;
    map.positions[vertex] = pointOf(point, target);
  }
}

}  // namespace

struct EmbeddedSurface::Implementation {
  SurfaceShells surfaces;
  std::vector<std::unique_ptr<LaidOutShell>> laidOut;  // null above genus 1
  std::vector<std::unique_ptr<HandleLoops>> handles;   // null up to genus 1
  Layout none;
  double seconds = 0;
};

EmbeddedSurface::EmbeddedSurface(const Mesh& mesh, const EmbeddingSettings& settings) {
  auto out = std::make_shared<Implementation>();
  StageSeconds seconds;
  timed(seconds, "layout", [&] {
    ClosedSurfaceSettings closing;
    closing.closeHoles = settings.closeHoles;
    out->surfaces = closedSurfaces(mesh, closing);
    for (const ClosedSurface& s : out->surfaces.shells) {
      out->laidOut.push_back(s.genus > 1 ? nullptr : std::make_unique<LaidOutShell>(s));
      out->handles.push_back(s.genus > 1 ? std::make_unique<HandleLoops>(handleLoops(s)) : nullptr);
    }
  });
  out->seconds = seconds.front().second;
  implementation_ = std::move(out);
}

const SurfaceShells& EmbeddedSurface::surfaces() const { return implementation_->surfaces; }

const Layout& EmbeddedSurface::layout(std::size_t shell) const {
  const auto& laid = implementation_->laidOut.at(shell);
  return laid ? laid->layout : implementation_->none;
}

double EmbeddedSurface::seconds() const { return implementation_->seconds; }

std::vector<SurfacePoint> onTargetMesh(const ShellCorrespondence& shell,
                                       const SurfaceShells& target,
                                       const std::vector<SurfacePoint>& points) {
  std::vector<SurfacePoint> out = shell.targetCut ? onUncut(*shell.targetCut, points) : points;
  for (SurfacePoint& p : out) p.triangle = target.meshTriangle[shell.target][p.triangle];
  return out;
}

namespace {

using Exact = std::vector<std::pair<int, SurfacePoint>>;

// The images of a shell's vertices, by the map between what was cut, where it was.
struct MappedShell {
  ShellCorrespondence map;
  std::vector<SurfacePoint> onShell;  // of the shell's own vertices, where map.surface was cut
  Exact exact;                        // vertices of map.surface, places on map.targetSurface
};

class Corresponder {
 public:
  Corresponder(const EmbeddedSurface& a, const EmbeddedSurface& b,
               const std::vector<std::unique_ptr<LaidOutShell>>& laidOutA,
               const std::vector<std::unique_ptr<LaidOutShell>>& laidOutB,
               const std::vector<std::unique_ptr<HandleLoops>>& handlesA,
               const std::vector<std::unique_ptr<HandleLoops>>& handlesB,
               const CorrespondSettings& settings)
      : a_(a.surfaces()),
        b_(b.surfaces()),
        laidOutA_(laidOutA),
        laidOutB_(laidOutB),
        handlesA_(handlesA),
        handlesB_(handlesB),
        settings_(settings) {
    out_.seconds = {{"embed_source", a.seconds()}, {"embed_target", b.seconds()}};
    split_ = {a_.mesh, a_.shellVertex, a_.meshTriangle};
  }

  Correspondence run() {
    check(settings_);
    landmarks_ = shellLandmarks(settings_.landmarks, a_, b_);
    ShellPairSettings pairing;
    pairing.aligned = settings_.aligned;
    for (const ShellLandmark& l : landmarks_) pairing.wanted.push_back({l.shell, l.targetShell});
    const std::vector<int> target = pairShells(a_, b_, pairing);
    for (std::size_t i = 0; i < landmarks_.size(); ++i)
      if (target[landmarks_[i].shell] != landmarks_[i].targetShell)
        throw DataError(fmt::format(
            "landmarks: number {} connects shells that cannot be mapped onto one another together "
            "with the others; see innermap check for the shells",
            i + 1));
    std::vector<MappedShell> mapped;
    timed(out_.seconds, "map", [&] {
      for (int s = 0; s < static_cast<int>(a_.shells.size()); ++s)
        mapped.push_back(mapOne(s, target[s]));
    });
    assemble(mapped);
    return std::move(out_);
  }

 private:
  ShellMapSettings shellSettings() const {
    ShellMapSettings s;
    s.aligned = settings_.aligned;
    s.candidates = settings_.candidates;
    s.refine = settings_.refine;
    s.wanted = settings_.way;
    s.seed = settings_.seed;
    return s;
  }

  MappedShell mapOne(int source, int target) {
    MappedShell out;
    out.map.source = source;
    out.map.target = target;
    for (const ShellLandmark& l : landmarks_)
      if (l.shell == source) out.exact.push_back({l.vertex, l.onTarget});
    ShellMapSettings how = shellSettings();
    if (a_.shells[source].genus > 1) {
      mapHandles(out);
    } else {
      const LaidOutShell &from = *laidOutA_[source], &onto = *laidOutB_[target];
      for (const auto& [vertex, point] : out.exact)
        how.landmarks.push_back({vertex, placeOf(point, onto.surface.triangles, onto.layout)});
      const auto judge = settings_.judge ? settings_.judge(from.surface, onto.surface) : nullptr;
      how.judge = judge.get();
      ShellMap map = mapShell(from, onto, how);
      out.map.surface = from.surface;
      out.map.image = std::move(map.image);
      out.map.targetSurface = onto.surface;
      out.map.targetLayout = onto.layout;
      out.map.origin = map.origin;
      out.map.way = map.way;
      out.map.considered = std::move(map.considered);
      out.map.other = std::move(map.other);
      noteOther(out.map);
    }
    subdivideOne(out);
    const Locator locator(out.map.targetSurface.triangles, out.map.targetLayout);
    locateVertices(out.map, out.map.targetSurface, locator, out.exact);
    return out;
  }

  void noteOther(const ShellCorrespondence& map) {
    if (!map.other) return;
    const auto& [way, score, turn, surface, image] = *map.other;
    out_.notes.push_back(fmt::format(
        "{} can be laid on {} in two ways that are about as good: the one taken (score {:.2f}, "
        "less "
        "is better) turns it by {:.0f} degrees, the other (score {:.2f}) by {:.0f}; choose {} "
        "takes "
        "the other",
        map.surface.name, map.targetSurface.name, score[0], turn[0], score[1], turn[1], way));
  }

  void mapHandles(MappedShell& out) {
    requireOnlyWay(settings_.way, "solids of two handles and more are");
    CutAlikeSettings cutting;
    cutting.aligned = settings_.aligned;
    cutting.landmarks = out.exact;
    CutPair pair = cutAlike(*handlesA_[out.map.source], *handlesB_[out.map.target], cutting);
    if (!pair.note.empty()) out_.notes.push_back(pair.note);
    GluedMapSettings how;
    how.landmarks = std::move(out.exact);
    how.refine = settings_.refine;
    GluedMap map = gluedMap(pair, how);
    out.exact = std::move(map.exact);
    out.onShell = std::move(map.onTarget);
    out.map.surface = std::move(map.cut.surface);
    out.map.image = std::move(map.image);
    out.map.targetSurface = pair.b.surface;
    out.map.targetLayout = std::move(pair.layoutOfB);
    out.map.targetCut = std::make_shared<const CutSurface>(std::move(pair.b));
    out.map.origin = "cuts along meridians";
  }

  void subdivideOne(MappedShell& shell) {
    if (!(settings_.subdivide > 0)) return;
    if (!shell.onShell.empty()) {
      out_.notes.push_back(a_.shells[shell.map.source].name +
                           ": has several handles and was not split; only shells of genus 0 and 1 "
                           "are");
      return;
    }
    SubdivideSettings how;
    how.tolerance = settings_.subdivide;
    ShellCorrespondence& map = shell.map;
    how.triangles = std::min<std::size_t>(
        how.triangles, map.surface.triangles.size() + memoryLeft() / kBytesATriangle);
    const Subdivided done = timed(out_.seconds, "subdivide", [&] {
      return subdivide({map.source, map.surface, map.image, map.targetSurface, map.targetLayout},
                       laidOutB_[map.target]->metric, split_, how);
    });
    if (!done.enough)
      out_.notes.push_back(fmt::format(
          "splitting stopped at {} triangles, before the target was followed within {:g} of its "
          "diagonal",
          shell.map.surface.triangles.size(), settings_.subdivide));
  }

  void assemble(std::vector<MappedShell>& mapped) {
    if (split_.mesh.triangles.size() > a_.mesh.triangles.size()) {
      split_.mesh.polygonStart.clear();
      split_.mesh.polygonCorners.clear();
    }
    out_.source = std::move(split_.mesh);
    out_.positions = out_.source.vertices;
    out_.onTarget.resize(out_.source.vertices.size());
    // Of each shell's vertices.
    std::vector<std::vector<SurfacePoint>> onMesh;
    std::vector<Points> positions;
    for (const MappedShell& m : mapped) {
      if (m.onShell.empty()) {
        onMesh.push_back(onTargetMesh(m.map, b_, m.map.onTarget));
        positions.push_back(m.map.positions);
        continue;
      }
      onMesh.push_back(m.onShell);
      for (SurfacePoint& p : onMesh.back()) p.triangle = b_.meshTriangle[m.map.target][p.triangle];
      positions.emplace_back();
      for (const SurfacePoint& p : onMesh.back())
        positions.back().push_back(positionOf(b_.mesh, p));
    }
    std::vector<int> loose;
    for (int v = 0; v < static_cast<int>(split_.shellVertex.size()); ++v) {
      const ShellVertex sv = split_.shellVertex[v];
      if (sv.shell < 0) {
        loose.push_back(v);
        continue;
      }
      out_.onTarget[v] = onMesh[sv.shell][sv.vertex];
      out_.positions[v] = positions[sv.shell][sv.vertex];
    }
    placeLoose(loose);
    for (MappedShell& m : mapped) out_.shells.push_back(std::move(m.map));
  }

  // With the nearest corner of the nearest triangle.
  void placeLoose(const std::vector<int>& loose) {
    if (loose.empty()) return;
    const TriangleTree tree(a_.mesh.vertices, a_.mesh.triangles);
    for (const int v : loose) {
      const ClosestPoint c = tree.closest(a_.mesh.vertices[v]);
      if (c.address.triangle < 0) continue;
      const auto& w = c.address.barycentric;
      const auto k = static_cast<std::size_t>(std::max_element(w.begin(), w.end()) - w.begin());
      const int corner = a_.mesh.triangles[c.address.triangle][k];
      out_.onTarget[v] = out_.onTarget[corner];
      out_.positions[v] = out_.positions[corner];
    }
  }

  const SurfaceShells &a_, &b_;
  const std::vector<std::unique_ptr<LaidOutShell>>&laidOutA_, &laidOutB_;
  const std::vector<std::unique_ptr<HandleLoops>>&handlesA_, &handlesB_;
  const CorrespondSettings& settings_;
  std::vector<ShellLandmark> landmarks_;
  SplitMesh split_;
  Correspondence out_;
};

}  // namespace

void requireSameTopology(const SurfaceShells& a, const SurfaceShells& b) { pairShells(a, b); }

Correspondence correspond(const EmbeddedSurface& a, const EmbeddedSurface& b,
                          const CorrespondSettings& settings) {
  return Corresponder(a, b, a.implementation_->laidOut, b.implementation_->laidOut,
                      a.implementation_->handles, b.implementation_->handles, settings)
      .run();
}

}  // namespace innermap
