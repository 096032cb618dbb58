#include "surface/detail/refining/pullback_energy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/detail/refining/newton_step.h"

namespace innermap {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kThin = 0.01;  // of the star's mean triangle
constexpr double kRounding = 1e-12;

}  // namespace

class PullbackEnergy::PullbackStar : public Star {
 public:
  explicit PullbackStar(const PullbackEnergy& energy) : energy_(energy) {}

  void gather(int vertex) override;
  bool squeezed() const override { return squeezed_; }
  double at(const Vec3& place) const override { return below(kInfinite, place); }
  double below(double most, const Vec3& place) const override;
  Vec3 step(const Vec3& place, double now) const override;

 private:
  const PullbackEnergy& energy_;
  std::vector<StarTriangle> triangles_;
  // Where each sample of the triangles was found last, or triangle -1: the places that are tried
  // for a vertex are next to one another, the samples of one place are not.
  mutable std::vector<Located> found_;
  bool squeezed_ = false;
  double reach_ = 0;  // mean distance of the gathered ring
};

std::unique_ptr<Star> PullbackEnergy::star() const { return std::make_unique<PullbackStar>(*this); }

std::vector<Vec2> triangleSamples(int m) {
  std::vector<Vec2> out;
  const double part = 1.0 / m;
  for (int i = 0; i < m; ++i) {
    const std::size_t first = out.size();
    for (int j = 0; i + j < m; ++j) {
      out.push_back({(i + 1.0 / 3) * part, (j + 1.0 / 3) * part});
      if (i + j < m - 1) out.push_back({(i + 2.0 / 3) * part, (j + 2.0 / 3) * part});
    }
    if (i % 2 == 1) std::reverse(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
  }
  return out;
}

PullbackEnergy::PullbackEnergy(const ClosedSurface& source, const ProgressiveMesh& mesh,
                               const Layout& image, const TargetMetric& target, double samples)
    : mesh_(mesh),
      image_(image),
      target_(target),
      points_(source.vertices),
      samplesWanted_(samples),
      rest_(source.triangles.size()) {
  const double scale = unitAreaScale(source.vertices, source.triangles);
  const Vec3 center = boundingBox(points_).center();
  for (Vec3& p : points_) p = scale * (p - center);
}

void PullbackEnergy::grown(std::size_t vertices) {
  const double triangles = 2.0 * static_cast<double>(vertices);
  slack_ = 0.02 * 1.5 / std::sqrt(triangles);  // of an equilateral triangle's edge
  const int m =
      std::clamp(static_cast<int>(std::ceil(std::sqrt(samplesWanted_ / triangles))), 2, 10);
  samples_ = triangleSamples(m);
}

void PullbackEnergy::changed(int t) {
  const Triangle& tri = mesh_.triangle(t);
  rest_[t] = RestTriangle::of(points_[tri[0]], points_[tri[1]], points_[tri[2]], slack_);
}

PullbackEnergy::StarTriangle PullbackEnergy::starTriangle(int t, int k) const {
  const Triangle& tri = mesh_.triangle(t);
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const RestTriangle& r = rest_[t];
  StarTriangle out{image_.place[tri[i]], image_.place[tri[j]], r.halfCot[k],
                   r.halfCot[i],         r.halfCot[j],         r.area};
  if (!image_.shift.empty()) {
    const Shift own = mesh_.shift(t, k);
    out.a = image_.moved(out.a, mesh_.shift(t, i) - own);
    out.b = image_.moved(out.b, mesh_.shift(t, j) - own);
  }
  return out;
}

void PullbackEnergy::PullbackStar::gather(int v) {
  triangles_.clear();
  reach_ = 0;
  for (const int t : energy_.mesh_.around(v)) {
    const Triangle& tri = energy_.mesh_.triangle(t);
    triangles_.push_back(energy_.starTriangle(t, tri[0] == v ? 0 : tri[1] == v ? 1 : 2));
    reach_ += norm(triangles_.back().b - triangles_.back().a);
  }
  const auto count = static_cast<double>(triangles_.size());
  reach_ /= count;
  found_.assign(triangles_.size() * energy_.samples_.size(), Located{});
  double least = kInfinite, sum = 0;
  for (const StarTriangle& t : triangles_) {
    const double det = tripleProduct(energy_.image_.place[v], t.a, t.b);
    least = std::min(least, det);
    sum += det;
  }
  squeezed_ = least < kThin * sum / count;
}

double PullbackEnergy::of(const StarTriangle& t, const Vec3& place, Located& where, Located* found,
                          double most) const {
  const Vec3 e = t.a - place, f = t.b - place;
  double sum = 0;
  const double half = 0.5 / t.area;
  const double each = t.area / static_cast<double>(samples_.size());
  const double enough = most / each;
  Locator::Weights weights;
  for (const Vec2& s : samples_) {
    const Vec3 x = place + (s.x * e + s.y * f);
    where = target_.locator().find(x, found->triangle < 0 ? where : *found, weights);
    *found++ = where;
    const TargetMetric::Plane p = target_.project(where, weights, e, f);
    const double det = half * p.det();
    if (!(det > 0)) return kInfinite;
    const double ee = p.e.x * p.e.x + p.e.y * p.e.y, ff = p.f.x * p.f.x + p.f.y * p.f.y,
                 ef = p.e.x * p.f.x + p.e.y * p.f.y;
    // |J|^2 from the images of the sides opposite the corners: f - e, f, e.
    const double squared = (t.cotFree * (ee + ff - 2 * ef) + t.cotA * ff + t.cotB * ee) / t.area;
    sum += Stretch{squared, det}.bothWays();
    if (sum > enough) return kInfinite;
  }
  return sum * t.area / static_cast<double>(samples_.size());
}

double PullbackEnergy::PullbackStar::below(double most, const Vec3& place) const {
  most *= 1 + kRounding;
  for (const StarTriangle& t : triangles_)
    if (!(tripleProduct(place, t.a, t.b) > 0)) return kInfinite;
  double sum = 0;
  Located where;
  if (!found_.empty()) where = found_.front();  // before grown() there are no samples
  if (where.triangle < 0) where = energy_.target_.locator().find(place);
  Located* found = found_.data();
  for (const StarTriangle& t : triangles_) {
    sum += energy_.of(t, place, where, found, most - sum);
    found += energy_.samples_.size();
    if (sum > most) break;
  }
  return sum;
}

// From six points around the place: differences over a length see through the jumps that the
// target's metric makes from triangle to triangle.
Vec3 PullbackEnergy::PullbackStar::step(const Vec3& place, double now) const {
  static const double kCos[6] = {1, 0.5, -0.5, -1, -0.5, 0.5};
  static const double kSin[6] = {0, 0.8660254037844386,  0.8660254037844386,
                                 0, -0.8660254037844386, -0.8660254037844386};
  const ModelSpace space = energy_.image_.space;
  const Tangent tangent = tangentAt(space, place);
  double r = 0.15 * reach_;
  for (int attempt = 0; attempt < 5; ++attempt, r *= 0.3) {
    double mean = 0, gu = 0, gv = 0, c2 = 0, s2 = 0;
    for (int k = 0; k < 6 && mean < kInfinite; ++k) {
      const double e =
          at(moveAlong(space, place, (r * kCos[k]) * tangent.u + (r * kSin[k]) * tangent.v));
      mean += e / 6;
      gu += e * kCos[k];
      gv += e * kSin[k];
      c2 += e * (kCos[k] * kCos[k] - kSin[k] * kSin[k]);
      s2 += e * 2 * kCos[k] * kSin[k];
    }
    if (!(mean < kInfinite)) continue;
    const double trace = 4 * (mean - now) / (r * r), difference = c2 / (0.75 * r * r),
                 mixed = s2 / (1.5 * r * r);
    const Vec2 s = newtonStep(gu / (3 * r), gv / (3 * r), 0.5 * (trace + difference), mixed,
                              0.5 * (trace - difference));
    const Vec3 step = s.x * tangent.u + s.y * tangent.v;
    const double length = norm(step), most = 4 * r;
    return length > most ? (most / length) * step : step;
  }
  return {};
}

double PullbackEnergy::ofTriangle(int t) const {
  const StarTriangle star = starTriangle(t, 0);
  const Vec3& place = image_.place[mesh_.triangle(t)[0]];
  if (!(tripleProduct(place, star.a, star.b) > 0)) return kInfinite;
  Located where = target_.locator().find(place);
  std::vector<Located> found(samples_.size());
  return of(star, place, where, found.data(), kInfinite);
}

double PullbackEnergy::total() const {
  double sum = 0;
  for (int t = 0; t < static_cast<int>(mesh_.triangleCount()); ++t)
    if (mesh_.alive(t)) sum += ofTriangle(t);
  return sum;
}

}  // namespace innermap
