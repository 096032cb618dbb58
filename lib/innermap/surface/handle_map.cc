#include "innermap/surface/handle_map.h"

#include "innermap/surface/cut_alike.h"
#include "innermap/surface/match_handles.h"

namespace innermap {
namespace {

Vec3 placeOf(const SurfacePoint& p, const ClosedSurface& surface, const Layout& layout) {
  Vec3 sum;
  for (int k = 0; k < 3; ++k)
    sum += p.barycentric[k] * layout.corner(surface.triangles, p.triangle, k);
  return sum / norm(sum);
}

}  // namespace

HandleMap mapHandles(const HandleLoops& a, const HandleLoops& b,
                     const std::vector<std::pair<int, SurfacePoint>>& landmarks,
                     const ShellMapSettings& settings) {
  CutAlikeSettings cutting;
  cutting.aligned = settings.aligned;
  cutting.landmarks = landmarks;
  cutting.progress = settings.progress;
  CutPair pair = cutAlike(a, b, cutting);
  SeamedSurface source = seamed(pair.a, pair.layoutOfA, pair.b, pair.layoutOfB, pair.match);
  HandleMap out;
  out.exact = source.fixed;
  std::vector<SurfacePoint> targets;
  for (const auto& landmark : landmarks) targets.push_back(landmark.second);
  targets = onCut(pair.b, targets);
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    for (int v = 0; v < static_cast<int>(source.cut.vertexOf.size()); ++v)
      if (source.cut.vertexOf[v] == landmarks[i].first) {
        out.exact.push_back({v, targets[i]});
        break;
      }
  ShellMapSettings how = settings;
  how.landmarks.clear();
  for (const auto& [vertex, point] : out.exact)
    how.landmarks.push_back({vertex, placeOf(point, pair.b.surface, pair.layoutOfB)});
  const LaidOutShell from(source.cut.surface, std::move(source.layout), settings.progress),
      onto(pair.b.surface, pair.layoutOfB, settings.progress);
  ShellMap map = mapShell(from, onto, how);
  out.origin = map.origin;
  out.image = std::move(map.image);
  out.note = pair.note;
  out.source = std::move(source.cut);
  out.target = std::move(pair.b);
  out.targetLayout = std::move(pair.layoutOfB);
  return out;
}

}  // namespace innermap
