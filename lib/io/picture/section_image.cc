#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/io/pictures.h"
#include "io/picture/detail/picture.h"
#include "io/picture/detail/section_cut.h"

namespace innermap {
namespace {

constexpr Rgb kOutside{0.93f, 0.93f, 0.935f}, kFaint{0.42f, 0.44f, 0.47f},
    kOutline{0.2f, 0.21f, 0.24f}, kBroken{0, 0, 0}, kNoVoxel{0.76f, 0.77f, 0.78f},
    kFolded{0.8f, 0, 0.75f};
constexpr int kSectionMargin = 28, kSectionTitle = 78, kSectionFooter = 22, kBarGap = 26,
              kBarWidth = 26, kLabels = 120, kSectionSubsamples = 3;
// A logarithmic scale shows what is over kManyTimes apart, and no more than down to kLeastShown of
// the largest. Ratios to 1 that the colours' ends stand for, at least and at most.
constexpr double kManyTimes = 100, kLeastShown = 1e-4, kLeastRatio = 1.1, kMostRatio = 16;

bool isColour(const openvdb::GridBase& grid) {
  return grid.isType<openvdb::Vec3fGrid>() || grid.isType<openvdb::Vec3dGrid>();
}

openvdb::GridBase::Ptr gridToShow(const openvdb::GridPtrVec& grids, const std::string& wanted,
                                  bool colour) {
  if (grids.empty()) throw DataError("there are no grids to show");
  if (!wanted.empty()) {
    if (const auto grid = gridNamed(grids, wanted)) return grid;
    std::vector<std::string> names;
    for (const auto& grid : grids) names.push_back(grid->getName());
    throw DataError(
        fmt::format("there is no grid '{}' to show; there are {}", wanted, fmt::join(names, ", ")));
  }
  if (colour)
    for (const char* name : {"Cd", "color"})
      if (const auto grid = gridNamed(grids, name)) return grid;
  for (const char* name :
       {"jacobian", "deformation_energy", "harmonic_energy", "map", "density", "surface"})
    if (const auto grid = gridNamed(grids, name)) return grid;
  return grids.front();
}

std::optional<int> componentOf(const SectionSettings& s) {
  if (s.component == Component::length) return std::nullopt;
  return static_cast<int>(s.component);
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

// Volumes that a map changes: what is not above 0 is turned inside out.
bool tellsFolds(const SectionResult& r) {
  return r.grid == "jacobian" || r.scale == SectionScale::about1;
}

// Of colours, by the values that are not outliers.
SectionScale scaleFor(const SectionSettings& s, const SectionResult& r) {
  if (s.colour) return SectionScale::linear;
  if (s.scale != SectionScale::automatic) return s.scale;
  if (s.range) return SectionScale::linear;
  // A target of another size leaves nothing near 1.
  const bool near1 = r.lower < kMostRatio / 4 && r.upper > 4 / kMostRatio;
  if (r.grid == "jacobian" && near1) return SectionScale::about1;
  const bool spans = r.lower > 0 && r.upper > kManyTimes * r.lower;
  return spans ? SectionScale::logarithmic : SectionScale::linear;
}

// Makes the range one that the scale can have.
void fitRange(const SectionSettings& s, SectionResult& r) {
  if (r.scale == SectionScale::linear) return;
  if (s.range && !(r.lower > 0))
    throw SettingError("range", "must lie above 0 on a scale of ratios");
  if (r.scale == SectionScale::about1) {
    const double below = 1 / std::max(r.lower, 1 / kMostRatio);
    r.upper = std::clamp(std::max(r.upper, below), kLeastRatio, kMostRatio);
    r.lower = 1 / r.upper;
  }
  if (!(r.upper > 0)) {
    r.scale = SectionScale::linear;  // there is nothing that has a ratio
    return;
  }
  r.lower = std::max(r.lower, r.upper * kLeastShown);
}

// Where on the colours a value is; 0 to 1 in the range.
double placeOf(double value, const SectionResult& r) {
  if (r.scale == SectionScale::linear) return (value - r.lower) / (r.upper - r.lower);
  if (!(value > 0)) return 0;
  return std::log(value / r.lower) / std::log(r.upper / r.lower);
}

void chooseRange(const SectionCut& cut, const SectionSettings& s, SectionResult& result) {
  const std::vector<float> values = valuesInside(cut);
  if (values.empty())
    throw DataError(
        fmt::format("the cut at {} = {:g} meets no finite value of grid '{}' inside the "
                    "solid; cut elsewhere",
                    axisName(s.axis), result.position, result.grid));
  result.least = values.front();
  result.most = values.back();
  const auto cutOff = static_cast<std::size_t>(s.outliers * static_cast<double>(values.size() - 1));
  if (s.colour) {  // as it is, unless the range says what is black and white
    std::tie(result.lower, result.upper) = s.range.value_or(std::make_pair(0.0, 1.0));
    return;
  }
  result.lower = s.range ? s.range->first : values[cutOff];
  result.upper = s.range ? s.range->second : values[values.size() - 1 - cutOff];
  // A constant: a range about it, so that it has the middle colour.
  const double tiny = 1e-6 * std::max({std::abs(result.lower), std::abs(result.upper), 1e-30});
  if (!s.range && result.upper - result.lower < tiny) {
    const double half = std::max(std::abs(result.lower), 1e-6) * 1e-2;
    result.lower -= half;
    result.upper += half;
  }
  result.scale = scaleFor(s, result);
  fitRange(s, result);
}

struct Layout {
  int x = 0, y = 0, width = 0, height = 0;  // of the section
  int barX = 0, barY = 0, barHeight = 0;
  int totalWidth = 0, totalHeight = 0;
};

Layout layoutFor(const SliceFrame& frame, int pixels, bool bar) {
  const openvdb::Vec3d voxel = frame.transform->voxelSize();
  const double w = static_cast<double>(frame.columns()) * voxel[frame.columnAxis];
  const double h = static_cast<double>(frame.rows()) * voxel[frame.rowAxis];
  const double scale = pixels / std::max(w, h);
  Layout l;
  l.width = std::max(1, static_cast<int>(std::lround(w * scale)));
  l.height = std::max(1, static_cast<int>(std::lround(h * scale)));
  // Room for the title and for a bar that can be read, however thin the section is.
  const int room = std::max(l.width, bar ? 480 : 600), tall = std::max(l.height, 300);
  l.x = kSectionMargin + (room - l.width) / 2;
  l.y = kSectionTitle + (tall - l.height) / 2;
  l.barX = kSectionMargin + room + kBarGap;
  l.barHeight = std::min(tall, std::max(300, tall * 3 / 4));
  l.barY = kSectionTitle + (tall - l.barHeight) / 2;
  l.totalWidth = bar ? l.barX + kBarWidth + kLabels : l.barX - kBarGap + kSectionMargin;
  l.totalHeight = kSectionTitle + tall + kSectionFooter + kSectionMargin;
  return l;
}

// The colour at a place of the cut inside the solid.
Rgb colourAt(const SectionSampler& sampler, const SectionCut& cut, const SectionResult& r,
             Colormap map, double x, double y) {
  const std::optional<float> v = sampler.value(x, y);
  if (!v) return kNoVoxel;
  if (cut.shown.channels.size() == 1)
    return !std::isfinite(*v)           ? kBroken
           : tellsFolds(r) && !(*v > 0) ? kFolded
                                        : rampColour(placeOf(*v, r), map);
  Rgb rgb{};
  for (std::size_t c = 0; c < 3; ++c) {
    const float linear = *sampler.value(x, y, c);
    if (!std::isfinite(linear)) return kBroken;
    rgb[c] = encoded((linear - r.lower) / (r.upper - r.lower));
  }
  return rgb;
}

// The colour of one pixel: the mean over subsamples, which also smooths the solid's edge.
Rgb pixelColour(const SectionSampler& sampler, const SectionCut& cut, const SectionResult& r,
                Colormap map, double x, double y, double dx, double dy) {
  Rgb sum{0, 0, 0};
  for (int k = 0; k < kSectionSubsamples * kSectionSubsamples; ++k) {
    const int column = k % kSectionSubsamples, row = k / kSectionSubsamples;
    const double sx = x + dx * ((column + 0.5) / kSectionSubsamples - 0.5);
    const double sy = y + dy * ((row + 0.5) / kSectionSubsamples - 0.5);
    const Rgb colour = sampler.inside(sx, sy) ? colourAt(sampler, cut, r, map, sx, sy) : kOutside;
    for (int c = 0; c < 3; ++c) sum[c] += colour[c] / (kSectionSubsamples * kSectionSubsamples);
  }
  return sum;
}

void drawSection(const SectionCut& cut, const Layout& l, const SectionResult& r,
                 const SectionSettings& settings, Picture& picture) {
  const SectionSampler sampler(cut);
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
            Rgb colour = pixelColour(sampler, cut, r, settings.colormap, (px + 0.5) * dx - 0.5,
                                     (py + 0.5) * dy - 0.5, dx, dy);
            // A thin line around the solid sets pale colours off from the ground.
            const bool here = inside(px, py);
            if (here && (!inside(px - 1, py) || !inside(px + 1, py) || !inside(px, py - 1) ||
                         !inside(px, py + 1)))
              for (int c = 0; c < 3; ++c) colour[c] = 0.45f * colour[c] + 0.55f * kOutline[c];
            picture.set(l.x + px, l.y + py, colour);
          }
      },
      "drawing the section");
}

// Round numbers between the ends of the range.
std::vector<double> ticksOf(const SectionResult& r) {
  if (r.scale == SectionScale::linear) return tickValues(r.lower, r.upper, 6);
  std::vector<double> ticks;
  const double decades = std::log10(r.upper / r.lower);
  for (double ten = std::pow(10, std::floor(std::log10(r.lower))); ten <= r.upper; ten *= 10)
    for (const double digit : {1, 2, 5})
      if (decades < 2.5 || digit < 2) ticks.push_back(digit * ten);
  return ticks;
}

void drawBar(const Layout& l, const SectionResult& r, Colormap map, Picture& picture) {
  for (int y = 0; y < l.barHeight; ++y) {
    const Rgb colour = rampColour(1 - (y + 0.5) / l.barHeight, map);
    picture.fill(l.barX, l.barY + y, l.barX + kBarWidth, l.barY + y + 1, colour);
  }
  picture.frame(l.barX, l.barY, l.barX + kBarWidth, l.barY + l.barHeight, kInk);
  const int x = l.barX + kBarWidth;
  const auto label = [&](double value, Rgb colour, const std::string& text) {
    const double t = placeOf(value, r);
    const int y = l.barY + static_cast<int>(std::lround((1 - t) * (l.barHeight - 1)));
    picture.fill(x, y, x + 6, y + 1, kInk);
    picture.text(x + 11, y + 6, text, 16, colour);
    return y;
  };
  // The ends carry the range itself; ticks too close to them would run into their text.
  label(r.upper, kInk, shortNumber(r.upper));
  label(r.lower, kInk, shortNumber(r.lower));
  for (const double tick : ticksOf(r)) {
    const double t = placeOf(tick, r);
    if (t * l.barHeight > 20 && (1 - t) * l.barHeight > 20) label(tick, kFaint, shortNumber(tick));
  }
  if (!tellsFolds(r) || r.least > 0) return;
  const int y = l.barY + l.barHeight + 12;
  picture.fill(l.barX, y, x, y + 14, kFolded);
  picture.frame(l.barX, y, x, y + 14, kInk);
  picture.text(x + 11, y + 13, "folded", 16, kInk);
}

std::string shownName(const openvdb::GridBase& grid, const SectionSettings& s) {
  if (channelNames(grid).size() == 1) return grid.getName();
  if (s.colour) return grid.getName() + " (colour)";
  static const char* const parts[] = {" (x component)", " (y component)", " (z component)",
                                      " (length)"};
  return grid.getName() + parts[static_cast<int>(s.component)];
}

void drawText(const SectionCut& cut, const Layout& l, const SectionResult& r,
              const std::string& name, Picture& picture) {
  const SliceFrame& f = cut.frame;
  picture.text(kSectionMargin, 36, name, 24, kInk);
  const double share = f.layers() > 1 ? (cut.layer - f.box.min()[f.axis]) / (f.layers() - 1) : 0.5;
  picture.text(
      kSectionMargin, 60,
      fmt::format("section at {} = {} ({:.0f}% of the box); values {} to {}", axisName(f.axis),
                  shortNumber(r.position), 100 * share, shortNumber(r.least), shortNumber(r.most)),
      15, kFaint);
  const int bottom = picture.height() - kSectionMargin + 8;
  picture.text(kSectionMargin, bottom,
               fmt::format("{} to the right, {} up, {} x {} voxels of {}", axisName(f.columnAxis),
                           axisName(f.rowAxis), f.columns(), f.rows(),
                           shortNumber(f.transform->voxelSize()[f.columnAxis])),
               14, kFaint);
  picture.text(picture.width() - kSectionMargin, bottom, "innermap", 14, kFaint, Align::right);
  picture.frame(kSectionMargin, kSectionTitle, l.barX - kBarGap,
                picture.height() - kSectionFooter - kSectionMargin, {0.8f, 0.8f, 0.82f});
}

void checkSettings(const SectionSettings& s) {
  if (s.axis < 0 || s.axis > 2) throw SettingError("axis", "is not one of x, y, z");
  requireDescribed(s);
  if (!(s.outliers >= 0 && s.outliers < 0.5))
    throw SettingError("outliers", "is out of range; give a share from 0 to below 0.5");
  if (s.range && !(std::isfinite(s.range->first) && s.range->first < s.range->second &&
                   std::isfinite(s.range->second)))
    throw SettingError("range", "is empty; give the lower number first");
}

struct Shown {
  openvdb::GridBase::Ptr grid;
  openvdb::GridPtrVec needed;  // it, and what says where the solid is
  SliceFrame frame;
  Layout layout;
};

Shown shownOf(const openvdb::GridPtrVec& grids, const SectionSettings& settings) {
  const openvdb::GridBase::Ptr grid = gridToShow(grids, settings.grid, settings.colour);
  if (settings.colour && !isColour(*grid))
    throw DataError(fmt::format("grid '{}' is no colour but of type {}; show it without colour",
                                grid->getName(), grid->valueType()));
  openvdb::GridPtrVec needed = {grid};
  for (const char* name : {"surface", "density"})
    if (const auto solid = gridNamed(grids, name))
      if (solid != grid && solid->constTransform() == grid->constTransform())
        needed.push_back(solid);
  const SliceFrame frame = sliceFrame(needed, settings.axis);
  return {grid, needed, frame, layoutFor(frame, settings.pixels, !settings.colour)};
}

std::uint64_t memoryFor(const Shown& shown) {
  return shown.frame.rows() * shown.frame.columns() * 12 * sizeof(float) +
         std::uint64_t(shown.layout.totalWidth) * shown.layout.totalHeight * 16;
}

}  // namespace

std::uint64_t sectionImageMemory(const openvdb::GridPtrVec& grids,
                                 const SectionSettings& settings) {
  checkSettings(settings);
  return memoryFor(shownOf(grids, settings));
}

SectionResult writeSectionImage(const std::string& path, const openvdb::GridPtrVec& grids,
                                const SectionSettings& settings) {
  checkSettings(settings);
  const Shown shown = shownOf(grids, settings);
  requireMemory("the section " + path, memoryFor(shown),
                "cut along another axis or ask for fewer pixels");
  const auto& [grid, needed, frame, layout] = shown;
  const SectionCut cut = cutThrough(grid, needed, frame, layerFor(frame, settings),
                                    {componentOf(settings), settings.colour});

  SectionResult result;
  result.grid = grid->getName();
  result.position = cut.frame.position(cut.layer);
  chooseRange(cut, settings, result);
  Picture picture(layout.totalWidth, layout.totalHeight, kPaper);
  result.width = picture.width();
  result.height = picture.height();
  drawText(cut, layout, result, shownName(*grid, settings), picture);
  picture.fill(kSectionMargin, kSectionTitle, layout.barX - kBarGap,
               picture.height() - kSectionFooter - kSectionMargin, kOutside);
  drawSection(cut, layout, result, settings, picture);
  if (!settings.colour) drawBar(layout, result, settings.colormap, picture);
  picture.write(path);
  return result;
}

Setting scaleSetting(SectionScale* scale) {
  return Setting("scale", "HOW",
                 choiceOf<SectionScale>(scale, {{"auto", SectionScale::automatic},
                                                {"linear", SectionScale::linear},
                                                {"log", SectionScale::logarithmic},
                                                {"about-1", SectionScale::about1}}),
                 "how colours follow values. linear: by differences; log: by ratios; about-1: by "
                 "ratios, with 1 in the middle; auto: about-1 for a jacobian, with folds in a "
                 "colour of their own, log if values differ over 100 times, linear with a range")
      .rare();
}

std::vector<Setting> describe(SectionSettings& s) {
  return {Setting("component", "PART",
                  choiceOf<Component>(&s.component, {{"x", Component::x},
                                                     {"y", Component::y},
                                                     {"z", Component::z},
                                                     {"length", Component::length}}),
                  "of a vector grid in the picture")
              .rare(),
          Setting("colour", &s.colour,
                  "show a vector grid's values as red, green and blue; the default for Cd"),
          axisSetting("axis", &s.axis, "direction across the cut"),
          Setting("at", "T", &s.at, "where the picture cuts")
              .in("fraction of the box along the axis")
              .from(0, 1),
          Setting("position", "P", &s.position, "where the picture cuts, in place of {at}")
              .in("world units")
              .from(-1e12, 1e12)
              .rare(),
          colormapSetting(&s.colormap),
          scaleSetting(&s.scale),
          Setting("pixels", "N", &s.pixels, "longer side of the section in the picture")
              .from(64, 8192)
              .rare()};
}

}  // namespace innermap
