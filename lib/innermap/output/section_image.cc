#include "innermap/output/section_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/file.h"
#include "innermap/core/memory.h"
#include "innermap/core/parallel.h"
#include "innermap/output/picture.h"
#include "innermap/output/slice.h"

namespace innermap {
namespace {

constexpr Rgb kPaper{1, 1, 1}, kOutside{0.93f, 0.93f, 0.935f}, kInk{0.13f, 0.14f, 0.16f},
    kFaint{0.42f, 0.44f, 0.47f}, kOutline{0.2f, 0.21f, 0.24f}, kBroken{0, 0, 0},
    kNoVoxel{0.76f, 0.77f, 0.78f};
constexpr int kMargin = 28, kTitle = 78, kFooter = 22, kBarGap = 26, kBarWidth = 26, kLabels = 120,
              kSubsamples = 3;

// A layer's values between two voxel layers, with weights: 0 where no voxel is active.
struct Field {
  std::vector<float> values, weights;
};

struct Cut {
  SliceFrame frame;
  double layer = 0;
  Field shown;
  std::vector<float> inside;  // positive inside the solid; empty: the weights tell
};

openvdb::GridBase::Ptr gridNamed(const openvdb::GridPtrVec& grids, const std::string& name) {
  for (const auto& grid : grids)
    if (grid->getName() == name) return grid;
  return nullptr;
}

openvdb::GridBase::Ptr gridToShow(const openvdb::GridPtrVec& grids, const std::string& wanted) {
  if (grids.empty()) throw DataError("there are no grids to show");
  if (!wanted.empty()) {
    if (const auto grid = gridNamed(grids, wanted)) return grid;
    std::vector<std::string> names;
    for (const auto& grid : grids) names.push_back(grid->getName());
    throw DataError(
        fmt::format("there is no grid '{}' to show; there are {}", wanted, fmt::join(names, ", ")));
  }
  for (const char* name :
       {"jacobian", "deformation_energy", "harmonic_energy", "map", "density", "surface"})
    if (const auto grid = gridNamed(grids, name)) return grid;
  return grids.front();
}

std::vector<float> scalarsOf(const openvdb::GridBase& grid, const SliceFrame& frame, int layer,
                             Component component) {
  std::vector<SliceChannel> channels = sliceGrid(grid, frame, layer);
  if (channels.size() == 1) return std::move(channels[0].values);
  if (component != Component::kLength)
    return std::move(channels[static_cast<std::size_t>(component)].values);
  std::vector<float> lengths(channels[0].values.size());
  for (std::size_t i = 0; i < lengths.size(); ++i)
    lengths[i] = std::hypot(channels[0].values[i], channels[1].values[i], channels[2].values[i]);
  return lengths;
}

// The grid at a layer that may lie between two: both, weighted where active.
Field fieldAt(const openvdb::GridBase::Ptr& grid, const SliceFrame& frame, double layer,
              Component component) {
  const int below = static_cast<int>(std::floor(layer));
  const float share = static_cast<float>(layer - below);
  const bool everywhere = grid->getGridClass() == openvdb::GRID_LEVEL_SET;
  Field field;
  field.values.assign(frame.rows() * frame.columns(), 0.0f);
  field.weights = field.values;
  for (int k = 0; k < 2; ++k) {
    const float weight = k == 0 ? 1 - share : share;
    if (weight == 0) continue;
    const std::vector<float> values = scalarsOf(*grid, frame, below + k, component);
    const std::vector<float> mask =
        everywhere ? std::vector<float>(values.size(), 1.0f) : sliceMask({grid}, frame, below + k);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (mask[i] > 0) {
        field.values[i] += weight * values[i];
        field.weights[i] += weight;
      }
  }
  return field;
}

// Positive inside, about 1 per voxel of depth near the surface.
std::vector<float> insideAt(const openvdb::GridPtrVec& grids, const Cut& cut) {
  if (const auto surface = gridNamed(grids, "surface")) {
    const double voxel = cut.frame.transform->voxelSize().x();
    Field f = fieldAt(surface, cut.frame, cut.layer, Component::kLength);
    for (float& v : f.values) v = static_cast<float>(-v / voxel);
    return std::move(f.values);
  }
  if (const auto density = gridNamed(grids, "density")) {
    Field f = fieldAt(density, cut.frame, cut.layer, Component::kLength);
    for (float& v : f.values) v -= 0.5f;
    return std::move(f.values);
  }
  return {};
}

double layerFor(const SliceFrame& frame, const SectionSettings& s) {
  const int lower = frame.box.min()[frame.axis], upper = frame.box.max()[frame.axis];
  if (!s.position) return std::clamp(lower + s.at * (upper - lower), double(lower), double(upper));
  const double layer = frame.layerAt(*s.position);
  if (!(layer >= lower - 0.5 && layer <= upper + 0.5))
    throw SettingError("position",
                       fmt::format("{:g} is outside the grids; give a coordinate from {:g} to {:g}",
                                   *s.position, frame.position(lower), frame.position(upper)));
  return std::clamp(layer, double(lower), double(upper));
}

// Bilinear interpolation of the cut at image coordinates (voxel centres at whole numbers).
struct Sampler {
  const Cut& cut;

  float at(const std::vector<float>& values, const std::vector<float>* weights, double x, double y,
           float* weight) const {
    const auto columns = static_cast<int>(cut.frame.columns());
    const auto rows = static_cast<int>(cut.frame.rows());
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    float sum = 0, total = 0;
    for (int k = 0; k < 4; ++k) {
      const int xi = std::clamp(x0 + (k & 1), 0, columns - 1);
      const int yi = std::clamp(y0 + (k >> 1), 0, rows - 1);
      const double wx = (k & 1) ? x - x0 : 1 - (x - x0), wy = (k >> 1) ? y - y0 : 1 - (y - y0);
      const std::size_t i = static_cast<std::size_t>(yi) * columns + xi;
      const float w = static_cast<float>(wx * wy) * (weights ? (*weights)[i] : 1.0f);
      if (w == 0) continue;
      // `values` is already weighted over the layers.
      sum += weights ? static_cast<float>(wx * wy) * values[i] : w * values[i];
      total += w;
    }
    if (weight) *weight = total;
    return total > 0 ? sum / total : 0.0f;
  }

  bool inside(double x, double y) const {
    if (!cut.inside.empty()) return at(cut.inside, nullptr, x, y, nullptr) > 0;
    float weight = 0;
    at(cut.shown.values, &cut.shown.weights, x, y, &weight);
    return weight >= 0.5f;
  }

  // None where no voxel is active.
  std::optional<float> value(double x, double y) const {
    float weight = 0;
    const float v = at(cut.shown.values, &cut.shown.weights, x, y, &weight);
    return weight > 0 ? std::optional<float>(v) : std::nullopt;
  }
};

std::vector<float> valuesInside(const Cut& cut) {
  std::vector<float> values;
  for (std::size_t i = 0; i < cut.shown.values.size(); ++i) {
    const bool inside = cut.inside.empty() || cut.inside[i] > 0;
    if (!inside || !(cut.shown.weights[i] > 0)) continue;
    const float v = cut.shown.values[i] / cut.shown.weights[i];
    if (std::isfinite(v)) values.push_back(v);
  }
  std::sort(values.begin(), values.end());
  return values;
}

void chooseRange(const Cut& cut, const SectionSettings& s, SectionResult& result) {
  const std::vector<float> values = valuesInside(cut);
  if (values.empty())
    throw DataError(
        fmt::format("the cut at {} = {:g} meets no finite value of grid '{}' inside the "
                    "solid; cut elsewhere",
                    axisName(s.axis), result.position, result.grid));
  result.least = values.front();
  result.most = values.back();
  const auto cutOff = static_cast<std::size_t>(s.outliers * static_cast<double>(values.size() - 1));
  result.lower = s.range ? s.range->first : values[cutOff];
  result.upper = s.range ? s.range->second : values[values.size() - 1 - cutOff];
  // A constant: a range about it, so that it has the middle colour.
  const double tiny = 1e-6 * std::max({std::abs(result.lower), std::abs(result.upper), 1e-30});
  if (!s.range && result.upper - result.lower < tiny) {
    const double half = std::max(std::abs(result.lower), 1e-6) * 1e-2;
    result.lower -= half;
    result.upper += half;
  }
}

struct Layout {
  int x = 0, y = 0, width = 0, height = 0;  // of the section
  int barX = 0, barY = 0, barHeight = 0;
  int totalWidth = 0, totalHeight = 0;
};

Layout layoutFor(const SliceFrame& frame, int pixels) {
  const openvdb::Vec3d voxel = frame.transform->voxelSize();
  const double w = static_cast<double>(frame.columns()) * voxel[frame.columnAxis];
  const double h = static_cast<double>(frame.rows()) * voxel[frame.rowAxis];
  const double scale = pixels / std::max(w, h);
  Layout l;
  l.width = std::max(1, static_cast<int>(std::lround(w * scale)));
  l.height = std::max(1, static_cast<int>(std::lround(h * scale)));
  // Room for the title and for a bar that can be read, however thin the section is.
  const int room = std::max(l.width, 480), tall = std::max(l.height, 300);
  l.x = kMargin + (room - l.width) / 2;
  l.y = kTitle + (tall - l.height) / 2;
  l.barX = kMargin + room + kBarGap;
  l.barHeight = std::min(tall, std::max(300, tall * 3 / 4));
  l.barY = kTitle + (tall - l.barHeight) / 2;
  l.totalWidth = l.barX + kBarWidth + kLabels;
  l.totalHeight = kTitle + tall + kFooter + kMargin;
  return l;
}

// The colour of one pixel: the mean over subsamples, which also smooths the solid's edge.
Rgb pixelColour(const Sampler& sampler, const SectionResult& r, double x, double y, double dx,
                double dy) {
  Rgb sum{0, 0, 0};
  for (int k = 0; k < kSubsamples * kSubsamples; ++k) {
    const double sx = x + dx * ((k % kSubsamples + 0.5) / kSubsamples - 0.5);
    const double sy = y + dy * ((k / kSubsamples + 0.5) / kSubsamples - 0.5);
    Rgb colour = kOutside;
    if (sampler.inside(sx, sy)) {
      const std::optional<float> v = sampler.value(sx, sy);
      colour = !v                  ? kNoVoxel
               : std::isfinite(*v) ? rampColour((*v - r.lower) / (r.upper - r.lower))
                                   : kBroken;
    }
    for (int c = 0; c < 3; ++c) sum[c] += colour[c] / (kSubsamples * kSubsamples);
  }
  return sum;
}

void drawSection(const Cut& cut, const Layout& l, const SectionResult& r, Progress* progress,
                 Picture& picture) {
  const Sampler sampler{cut};
  const double dx = static_cast<double>(cut.frame.columns()) / l.width;
  const double dy = static_cast<double>(cut.frame.rows()) / l.height;
  const auto inside = [&](int px, int py) {
    return sampler.inside((px + 0.5) * dx - 0.5, (py + 0.5) * dy - 0.5);
  };
  parallelBlocks(
      static_cast<std::size_t>(l.height), 8,
      [&](std::size_t begin, std::size_t end) {
        for (auto py = static_cast<int>(begin); py < static_cast<int>(end); ++py)
          for (int px = 0; px < l.width; ++px) {
            Rgb colour =
                pixelColour(sampler, r, (px + 0.5) * dx - 0.5, (py + 0.5) * dy - 0.5, dx, dy);
            // A thin line around the solid sets pale colours off from the ground.
            const bool here = inside(px, py);
            if (here && (!inside(px - 1, py) || !inside(px + 1, py) || !inside(px, py - 1) ||
                         !inside(px, py + 1)))
              for (int c = 0; c < 3; ++c) colour[c] = 0.45f * colour[c] + 0.55f * kOutline[c];
            picture.set(l.x + px, l.y + py, colour);
          }
      },
      progress, "drawing the section");
}

void drawBar(const Layout& l, const SectionResult& r, Picture& picture) {
  for (int y = 0; y < l.barHeight; ++y) {
    const Rgb colour = rampColour(1 - (y + 0.5) / l.barHeight);
    picture.fill(l.barX, l.barY + y, l.barX + kBarWidth, l.barY + y + 1, colour);
  }
  picture.frame(l.barX, l.barY, l.barX + kBarWidth, l.barY + l.barHeight, kInk);
  const int x = l.barX + kBarWidth;
  const auto label = [&](double value, Rgb colour, const std::string& text) {
    const double t = (value - r.lower) / (r.upper - r.lower);
    const int y = l.barY + static_cast<int>(std::lround((1 - t) * (l.barHeight - 1)));
    picture.fill(x, y, x + 6, y + 1, kInk);
    picture.text(x + 11, y + 6, text, 16, colour);
    return y;
  };
  // The ends carry the range itself; ticks too close to them would run into their text.
  label(r.upper, kInk, shortNumber(r.upper));
  label(r.lower, kInk, shortNumber(r.lower));
  for (const double tick : tickValues(r.lower, r.upper, 6)) {
    const double t = (tick - r.lower) / (r.upper - r.lower);
    if (t * l.barHeight > 20 && (1 - t) * l.barHeight > 20) label(tick, kFaint, shortNumber(tick));
  }
}

std::string shownName(const openvdb::GridBase& grid, Component component) {
  if (channelNames(grid).size() == 1) return grid.getName();
  static const char* const parts[] = {" (x component)", " (y component)", " (z component)",
                                      " (length)"};
  return grid.getName() + parts[static_cast<int>(component)];
}

void drawText(const Cut& cut, const Layout& l, const SectionResult& r, const std::string& name,
              Picture& picture) {
  const SliceFrame& f = cut.frame;
  picture.text(kMargin, 36, name, 24, kInk);
  const double share = f.layers() > 1 ? (cut.layer - f.box.min()[f.axis]) / (f.layers() - 1) : 0.5;
  picture.text(
      kMargin, 60,
      fmt::format("section at {} = {} ({:.0f}% of the box); values {} to {}", axisName(f.axis),
                  shortNumber(r.position), 100 * share, shortNumber(r.least), shortNumber(r.most)),
      15, kFaint);
  const int bottom = picture.height() - kMargin + 8;
  picture.text(kMargin, bottom,
               fmt::format("{} to the right, {} up, {} x {} voxels of {}", axisName(f.columnAxis),
                           axisName(f.rowAxis), f.columns(), f.rows(),
                           shortNumber(f.transform->voxelSize()[f.columnAxis])),
               14, kFaint);
  picture.text(picture.width() - kMargin, bottom, "innermap", 14, kFaint, Align::kRight);
  picture.frame(kMargin, kTitle, l.barX - kBarGap, picture.height() - kFooter - kMargin,
                {0.8f, 0.8f, 0.82f});
}

void checkSettings(const SectionSettings& s) {
  if (s.axis < 0 || s.axis > 2) throw SettingError("axis", "is not one of x, y, z");
  if (!(s.at >= 0 && s.at <= 1))
    throw SettingError("at",
                       fmt::format("{:g} is out of range; give a fraction from 0 to 1", s.at));
  if (s.pixels < 64 || s.pixels > 8192)
    throw SettingError("pixels", "is out of range; give a number from 64 to 8192");
  if (!(s.outliers >= 0 && s.outliers < 0.5))
    throw SettingError("outliers", "is out of range; give a share from 0 to below 0.5");
  if (s.range && !(std::isfinite(s.range->first) && s.range->first < s.range->second &&
                   std::isfinite(s.range->second)))
    throw SettingError("range", "is empty; give the lower number first");
}

}  // namespace

SectionResult writeSectionImage(const std::string& path, const openvdb::GridPtrVec& grids,
                                const SectionSettings& settings) {
  checkSettings(settings);
  const openvdb::GridBase::Ptr grid = gridToShow(grids, settings.grid);
  openvdb::GridPtrVec needed = {grid};
  for (const char* name : {"surface", "density"})
    if (const auto solid = gridNamed(grids, name))
      if (solid != grid && solid->constTransform() == grid->constTransform())
        needed.push_back(solid);
  Cut cut;
  cut.frame = sliceFrame(needed, settings.axis);
  const Layout layout = layoutFor(cut.frame, settings.pixels);
  requireMemory("the section " + path,
                cut.frame.rows() * cut.frame.columns() * 6 * sizeof(float) +
                    std::uint64_t(layout.totalWidth) * layout.totalHeight * 16,
                settings.maxMemory, "cut along another axis or ask for fewer pixels");
  cut.layer = layerFor(cut.frame, settings);
  cut.shown = fieldAt(grid, cut.frame, cut.layer, settings.component);
  cut.inside = insideAt(needed, cut);

  SectionResult result;
  result.grid = grid->getName();
  result.position = cut.frame.position(cut.layer);
  chooseRange(cut, settings, result);
  Picture picture(layout.totalWidth, layout.totalHeight, kPaper);
  result.width = picture.width();
  result.height = picture.height();
  drawText(cut, layout, result, shownName(*grid, settings.component), picture);
  picture.fill(kMargin, kTitle, layout.barX - kBarGap, picture.height() - kFooter - kMargin,
               kOutside);
  drawSection(cut, layout, result, settings.progress, picture);
  drawBar(layout, result, picture);
  const std::vector<unsigned char> bytes = picture.png();
  writeWholeFile(path, [&](std::ostream& file) {
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  });
  return result;
}

}  // namespace innermap
