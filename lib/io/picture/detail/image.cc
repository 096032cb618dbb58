#include "io/picture/detail/image.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr double kMostTaps = 16;

// What share of old pixel i + first each new pixel takes, when n pixels become m.
struct Shares {
  int first = 0, count = 0;
  std::array<float, 4> share{};
};

std::vector<Shares> sharesFor(int n, int m) {
  std::vector<Shares> out(static_cast<std::size_t>(m));
  const double step = static_cast<double>(n) / m;  // 1 to 3
  for (int i = 0; i < m; ++i) {
    const double from = i * step, to = (i + 1) * step;
    Shares& s = out[static_cast<std::size_t>(i)];
    s.first = std::min(static_cast<int>(from), n - 1);
    for (int k = 0; k < 4 && s.first + k < n; ++k) {
      const double part = std::min(to, s.first + k + 1.0) - std::max(from, s.first + double(k));
      if (part <= 1e-9) break;
      s.share[static_cast<std::size_t>(k)] = static_cast<float>(part / step);
      s.count = k + 1;
    }
  }
  return out;
}

Pixels halved(const Pixels& from) {
  Pixels to;
  to.width = std::max(1, from.width / 2);
  to.height = std::max(1, from.height / 2);
  to.rgb.resize(std::size_t(3) * to.width * to.height);
  const std::vector<Shares> columns = sharesFor(from.width, to.width),
                            rows = sharesFor(from.height, to.height);
  parallelBlocks(rows.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < columns.size(); ++x) {
        float sum[3] = {0, 0, 0};
        for (int j = 0; j < rows[y].count; ++j)
          for (int i = 0; i < columns[x].count; ++i) {
            const std::size_t p = std::size_t(rows[y].first + j) * from.width +
                                  static_cast<std::size_t>(columns[x].first + i);
            const float w = rows[y].share[static_cast<std::size_t>(j)] *
                            columns[x].share[static_cast<std::size_t>(i)];
            for (std::size_t c = 0; c < 3; ++c) sum[c] += w * from.rgb[3 * p + c];
          }
        std::copy_n(sum, 3, &to.rgb[3 * (y * columns.size() + x)]);
      }
  });
  return to;
}

// The pixel that stands at index i of a row of n; -1 for none.
int wrapped(int i, int n, Wrap wrap) {
  if (i >= 0 && i < n) return i;
  switch (wrap) {
    case Wrap::repeat:
      return (i % n + n) % n;
    case Wrap::mirror: {
      const int period = (i % (2 * n) + 2 * n) % (2 * n);
      return period < n ? period : 2 * n - 1 - period;
    }
    case Wrap::clamp:
      return std::clamp(i, 0, n - 1);
    case Wrap::black:
      break;
  }
  return -1;
}

// Brought near 0, where whole numbers are exact, without changing what stands there.
double reduced(double u, Wrap wrap) {
  if (wrap == Wrap::repeat) return u - std::floor(u);
  if (wrap == Wrap::mirror) return u - 2 * std::floor(u / 2);
  return std::clamp(u, -2.0, 3.0);
}

// Axes of the ellipse that a and b span: full lengths, and the direction of the longer one.
struct Ellipse {
  double longer = 0, shorter = 0;
  Vec2 direction{1, 0};
};

Ellipse ellipseOf(const Vec2& a, const Vec2& b) {
  const double xx = a.x * a.x + b.x * b.x, yy = a.y * a.y + b.y * b.y, xy = a.x * a.y + b.x * b.y;
  const double mean = 0.5 * (xx + yy), spread = std::hypot(0.5 * (xx - yy), xy);
  Ellipse e;
  e.longer = std::sqrt(mean + spread);
  e.shorter = std::sqrt(std::max(0.0, mean - spread));
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  e.direction = {std::cos(angle), std::sin(angle)};
  return e;
}

}  // namespace

struct Image::Level : Pixels {};

struct Image::Data {
  std::vector<Level> levels;
  Wrap wrap;
};

Image::Image(Pixels pixels, Wrap wrap) {
  if (pixels.width < 1 || pixels.height < 1 ||
      pixels.rgb.size() != std::size_t(3) * pixels.width * pixels.height)
    throw DataError("image: its size does not fit its pixels");
  auto data = std::make_shared<Data>();
  data->wrap = wrap;
  data->levels.push_back({std::move(pixels)});
  while (data->levels.back().width > 1 || data->levels.back().height > 1)
    data->levels.push_back({halved(data->levels.back())});
  data_ = std::move(data);
}

int Image::width() const { return data_->levels[0].width; }
int Image::height() const { return data_->levels[0].height; }

Vec3 Image::bilinear(const Level& level, const Vec2& uv) const {
  const Wrap wrap = data_->wrap;
  const double x = reduced(uv.x, wrap) * level.width - 0.5;
  const double y = reduced(1 - uv.y, wrap) * level.height - 0.5;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const double fx = x - x0, fy = y - y0;
  Vec3 sum;
  for (int k = 0; k < 4; ++k) {
    const int i = wrapped(x0 + (k & 1), level.width, wrap);
    const int j = wrapped(y0 + (k >> 1), level.height, wrap);
    if (i < 0 || j < 0) continue;
    const double w = ((k & 1) ? fx : 1 - fx) * ((k >> 1) ? fy : 1 - fy);
    const float* p = &level.rgb[3 * (static_cast<std::size_t>(j) * level.width + i)];
    sum += w * Vec3{p[0], p[1], p[2]};
  }
  return sum;
}

Vec3 Image::trilinear(double level, const Vec2& uv) const {
  const auto& levels = data_->levels;
  const double l = std::clamp(level, 0.0, static_cast<double>(levels.size() - 1));
  const auto below = static_cast<std::size_t>(l);
  const double t = l - static_cast<double>(below);
  const Vec3 fine = bilinear(levels[below], uv);
  return t > 0 ? (1 - t) * fine + t * bilinear(levels[below + 1], uv) : fine;
}

Vec3 Image::at(const Vec2& uv) const {
  if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return {};
  return bilinear(data_->levels[0], uv);
}

Vec3 Image::at(const Vec2& uv, const Vec2& a, const Vec2& b) const {
  if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return {};
  const double w = width(), h = height();
  const Ellipse e = ellipseOf({a.x * w, a.y * h}, {b.x * w, b.y * h});
  if (!(e.longer > 1)) return bilinear(data_->levels[0], uv);
  if (!std::isfinite(e.longer)) return trilinear(1e9, uv);
  const double across = std::max({e.shorter, e.longer / kMostTaps, 1.0});
  const int taps = static_cast<int>(std::min(kMostTaps, std::ceil(e.longer / across)));
  Vec3 sum;
  for (int i = 0; i < taps; ++i) {
    const double s = ((i + 0.5) / taps - 0.5) * e.longer;
    sum +=
        trilinear(std::log2(across), {uv.x + s * e.direction.x / w, uv.y + s * e.direction.y / h});
  }
  return sum / taps;
}

}  // namespace innermap
