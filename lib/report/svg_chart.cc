#include "report/svg_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/file.h"
#include "core/markup.h"
#include "core/require_number.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

// Okabe and Ito, "Color Universal Design" (2008).
constexpr std::array<const char*, 6> kColours{"#0072b2", "#d55e00", "#009e73",
                                              "#cc79a7", "#56b4e9", "#e69f00"};
constexpr const char *kInk = "#212429", *kFaint = "#6b7078", *kGrid = "#dee0e3";
constexpr int kHead = 64, kEdge = 16;                            // of the chart
constexpr int kLeft = 70, kRight = 16, kTop = 54, kBottom = 52;  // of a panel
constexpr int kCellLeft = 90;
constexpr int kMostTicks = 7;
constexpr std::size_t kMostMarks = 120;  // of a curve: more run into each other

std::string textAt(double x, double y, const std::string& text, const std::string& more = {}) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", x, y,
                     more.empty() ? "" : " " + more, markupText(text));
}

std::string lineBetween(double x0, double y0, double x1, double y1, const char* colour) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x0, y0, x1,
      y1, colour);
}

// Numbers onto a length of pixels.
class SvgAxis {
 public:
  SvgAxis(bool logarithmic, double from, double to)
      : logarithmic_(logarithmic), from_(from), to_(to) {}

  bool takes(double v) const { return std::isfinite(v) && (!logarithmic_ || v > 0); }

  void see(double v) {
    if (!takes(v)) return;
    lower_ = std::min(lower_, scaled(v));
    upper_ = std::max(upper_, scaled(v));
  }

  // After all was seen: some room, and never less than the span.
  void settle(double span = 0) {
    if (!(lower_ <= upper_)) lower_ = 0, upper_ = 1;
    const double size = std::max(std::abs(lower_), std::abs(upper_));
    const double least = std::max(span, logarithmic_ ? 0.1 : size > 0 ? 2e-3 * size : 1);
    const double room = std::max(0.06 * (upper_ - lower_), 0.5 * (least - (upper_ - lower_)));
    const bool positive = !logarithmic_ && lower_ >= 0;
    lower_ -= room;
    upper_ += room;
    if (positive) lower_ = std::max(lower_, 0.0);
  }

  double at(double v) const {
    return from_ + (to_ - from_) * (scaled(v) - lower_) / (upper_ - lower_);
  }

  std::vector<double> ticks() const {
    constexpr double kShort = 1;  // decade: too few powers of ten and halves of them
    if (!logarithmic_) return linearTicks(lower_, upper_);
    if (upper_ - lower_ < kShort) return linearTicks(std::pow(10, lower_), std::pow(10, upper_));
    return logTicks();
  }

 private:
  double scaled(double v) const { return logarithmic_ ? std::log10(v) : v; }

  static std::vector<double> linearTicks(double lower, double upper) {
    const double rough = (upper - lower) / (kMostTicks - 1);
    const double ten = std::pow(10, std::floor(std::log10(rough)));
    double step = 10 * ten;
    for (const double nice : {5.0, 2.0, 1.0})
      if (nice * ten >= rough) step = nice * ten;
    std::vector<double> out;
    for (double v = std::ceil(lower / step) * step; v <= upper && out.size() <= 2 * kMostTicks;
         v += step)
      out.push_back(std::abs(v) < 1e-6 * step ? 0 : v);
    return out;
  }

  // Powers of ten, some of them where there are many; with 2 and 5 between where there are few.
  std::vector<double> logTicks() const {
    const bool few = upper_ - lower_ < 2.5;
    const int step = std::max(1, static_cast<int>((upper_ - lower_) / kMostTicks) + 1);
    std::vector<double> out;
    for (int e = static_cast<int>(std::floor(lower_)); e <= upper_; ++e)
      for (const double digit : {1.0, 2.0, 5.0}) {
        if ((digit > 1 && !few) || (!few && e % step != 0)) continue;
        const double v = digit * std::pow(10, e);
        if (std::log10(v) >= lower_ && std::log10(v) <= upper_) out.push_back(v);
      }
    return out;
  }

  bool logarithmic_;
  double from_, to_;
  double lower_ = std::numeric_limits<double>::infinity(), upper_ = -lower_;
};

struct Place {
  double x = 0, y = 0, width = 0, height = 0;
};

// Each series has a shape of its own, for print and for eyes that see colours alike.
std::string markAt(double x, double y, std::size_t index, const std::string& tells) {
  const char* colour = kColours[index % kColours.size()];
  std::string shape;
  switch (index % 4) {
    case 0:
      shape = fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.6\"", x, y);
      break;
    case 1:
      shape = fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"6.8\" height=\"6.8\"", x - 3.4,
                          y - 3.4);
      break;
    case 2:
      shape = fmt::format("<path d=\"M{:.1f} {:.1f}l4.4 7.6h-8.8z\"", x, y - 4.8);
      break;
    default:
      shape = fmt::format("<path d=\"M{:.1f} {:.1f}l4.6 4.6l-4.6 4.6l-4.6 -4.6z\"", x, y - 4.6);
  }
  return fmt::format("{} fill=\"{}\"><title>{}</title></{}>\n", shape, colour, markupText(tells),
                     shape.substr(1, shape.find(' ') - 1));
}

std::string headOf(const SvgPanel& panel, const Place& p) {
  return textAt(p.x + 8, p.y + 20, panel.title, "font-size=\"14\" font-weight=\"bold\"");
}

std::string labelsOf(const SvgPanel& panel, const Place& p, double left) {
  const double middle = p.x + (left + p.width - kRight) / 2, x = p.x + 14,
               y = p.y + (kTop + p.height - kBottom) / 2;
  return textAt(middle, p.y + p.height - 10, panel.xLabel, "text-anchor=\"middle\"") +
         textAt(
             x, y, panel.yLabel,
             fmt::format("text-anchor=\"middle\" transform=\"rotate(-90 {:.1f} {:.1f})\"", x, y));
}

std::string axesOf(const SvgAxis& x, const SvgAxis& y, const Place& p) {
  const double left = p.x + kLeft, right = p.x + p.width - kRight, top = p.y + kTop,
               bottom = p.y + p.height - kBottom;
  std::string out;
  for (const double v : x.ticks())
    out += lineBetween(x.at(v), top, x.at(v), bottom, kGrid) +
           textAt(x.at(v), bottom + 17, fmt::format("{:.4g}", v), "text-anchor=\"middle\"");
  for (const double v : y.ticks())
    out += lineBetween(left, y.at(v), right, y.at(v), kGrid) +
           textAt(left - 7, y.at(v) + 4, fmt::format("{:.4g}", v), "text-anchor=\"end\"");
  return out + lineBetween(left, bottom, right, bottom, kFaint) +
         lineBetween(left, top, left, bottom, kFaint);
}

std::string curveOf(const SvgSeries& series, const SvgAxis& x, const SvgAxis& y,
                    std::size_t index) {
  std::string lines, points, marks;
  const auto end = [&] {
    if (series.line && !points.empty())
      lines += fmt::format(
          "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\" "
          "stroke-linejoin=\"round\"/>\n",
          points, kColours[index % kColours.size()]);
    points.clear();
  };
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!x.takes(series.x[i]) || !y.takes(series.y[i])) {
      end();
      continue;
    }
    const double px = x.at(series.x[i]), py = y.at(series.y[i]);
    points += fmt::format("{:.1f},{:.1f} ", px, py);
    if (!series.line || series.x.size() <= kMostMarks)
      marks += markAt(px, py, index,
                      fmt::format("{}: {:.4g}, {:.4g}", series.name, series.x[i], series.y[i]));
  }
  end();
  return lines + marks;
}

std::string curvePanel(const SvgPanel& panel, const Place& p) {
  SvgAxis x(panel.xLogarithmic, p.x + kLeft, p.x + p.width - kRight),
      y(panel.yLogarithmic, p.y + p.height - kBottom, p.y + kTop);
  for (const SvgSeries& s : panel.series)
    for (std::size_t i = 0; i < s.x.size(); ++i)
      if (x.takes(s.x[i]) && y.takes(s.y[i])) {
        x.see(s.x[i]);
        y.see(s.y[i]);
      }
  x.settle();
  y.settle(panel.yLeastSpan);
  std::string out = headOf(panel, p) + labelsOf(panel, p, kLeft) + axesOf(x, y, p);
  double at = p.x + kLeft;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    out += curveOf(panel.series[i], x, y, i);
    if (panel.series[i].name.empty()) continue;
    out += markAt(at + 4, p.y + 37, i, panel.series[i].name) +
           textAt(at + 13, p.y + 41, panel.series[i].name);
    at += 30 + 6.6 * static_cast<double>(panel.series[i].name.size());
  }
  return out;
}

// Blue, green, yellow: a part of viridis (Smith and van der Walt, 2015), in reading order for eyes
// that see colours alike, dark to light.
std::string colourOf(double share) {
  constexpr std::array<std::array<double, 3>, 5> kStops{
      {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};
  const double at = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const std::size_t i = std::min<std::size_t>(static_cast<std::size_t>(at), kStops.size() - 2);
  const double t = at - static_cast<double>(i);
  const auto mix = [&](int k) {
    return static_cast<int>(std::lround(kStops[i][k] + t * (kStops[i + 1][k] - kStops[i][k])));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2));
}

std::string cellPanel(const SvgPanel& panel, const Place& p) {
  const double left = p.x + kCellLeft, right = p.x + p.width - kRight, top = p.y + kTop - 18,
               bottom = p.y + p.height - kBottom;
  const double wide = (right - left) / static_cast<double>(panel.columns.size()),
               high = (bottom - top) / static_cast<double>(panel.rows.size());
  SvgAxis colour(panel.yLogarithmic, 0, 1);
  for (std::size_t r = 0; r < panel.rows.size(); ++r)
    for (std::size_t c = 0; c < panel.columns.size(); ++c) colour.see(panel.cells(r, c));
  colour.settle();
  std::string out = headOf(panel, p) + labelsOf(panel, p, kCellLeft);
  for (std::size_t c = 0; c < panel.columns.size(); ++c)
    out += textAt(left + (static_cast<double>(c) + 0.5) * wide, bottom + 17, panel.columns[c],
                  "text-anchor=\"middle\"");
  for (std::size_t r = 0; r < panel.rows.size(); ++r) {
    const double y = bottom - (static_cast<double>(r) + 1) * high;
    out += textAt(left - 7, y + high / 2 + 4, panel.rows[r], "text-anchor=\"end\"");
    for (std::size_t c = 0; c < panel.columns.size(); ++c) {
      const double v = panel.cells(r, c), x = left + static_cast<double>(c) * wide;
      if (!colour.takes(v)) continue;
      const double share = colour.at(v);
      out += fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n", x,
          y, wide - 1, high - 1, colourOf(share));
      out += textAt(x + wide / 2, y + high / 2 + 4, fmt::format("{:.2g}", v),
                    fmt::format("text-anchor=\"middle\" font-size=\"11\" fill=\"{}\"",
                                share > 0.55 ? "#000000" : "#ffffff"));
    }
  }
  return out;
}

void checkChart(const SvgChart& chart) {
  if (chart.panels.empty()) throw DataError("chart: there is nothing to show");
  requireNumber("panels across", chart.panelsAcross, {1, 8});
  for (const int size : {chart.panelWidth, chart.panelHeight})
    requireNumber("size of panels", size, {160, 4096}, "pixels");
  for (const SvgPanel& panel : chart.panels) {
    for (const SvgSeries& s : panel.series)
      if (s.x.size() != s.y.size())
        throw DataError("chart: the series '" + s.name + "' has not as many x as y");
    if (panel.cells.rows() != panel.rows.size() || panel.cells.columns() != panel.columns.size())
      throw DataError("chart: the cells of '" + panel.title + "' do not fit their names");
  }
}

}  // namespace

std::string svgChart(const SvgChart& chart) {
  checkChart(chart);
  const int across = std::min(chart.panelsAcross, static_cast<int>(chart.panels.size()));
  const int down = (static_cast<int>(chart.panels.size()) + across - 1) / across;
  const int width = 2 * kEdge + across * chart.panelWidth,
            height = kHead + kEdge + down * chart.panelHeight;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" role=\"img\" font-family=\"DejaVu Sans, Liberation Sans, Arial, "
      "sans-serif\" font-size=\"12\" fill=\"{2}\">\n<title>{3}</title>\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
      width, height, kInk, markupText(chart.title));
  out += textAt(kEdge + 8, 28, chart.title, "font-size=\"18\" font-weight=\"bold\"");
  out += textAt(kEdge + 8, 50, chart.subtitle, fmt::format("fill=\"{}\"", kFaint));
  for (std::size_t i = 0; i < chart.panels.size(); ++i) {
    const int row = static_cast<int>(i) / across, column = static_cast<int>(i) % across;
    const Place place{static_cast<double>(kEdge + column * chart.panelWidth),
                      static_cast<double>(kHead + row * chart.panelHeight),
                      static_cast<double>(chart.panelWidth),
                      static_cast<double>(chart.panelHeight)};
    out += chart.panels[i].rows.empty() ? curvePanel(chart.panels[i], place)
                                        : cellPanel(chart.panels[i], place);
  }
  return out + "</svg>\n";
}

void writeChart(const std::string& path, const SvgChart& chart) {
  const std::string text = svgChart(chart);
  writeWholeFile(path, [&](std::ostream& file) { file << text; });
}

}  // namespace innermap
