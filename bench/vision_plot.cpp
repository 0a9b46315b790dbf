#include "bench/vision_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace flextip {
namespace {

constexpr int kWidth = 430, kHeight = 300, kLeft = 66, kRight = 14, kTop = 40, kBottom = 48;
constexpr const char* kOwnColour = "#1b7f5c";
constexpr std::array<const char*, 7> kColours = {"#c2491d", "#7a5195", "#2b6cb0", "#d99a00",
                                                 "#b03060", "#4aa3a2", "#555555"};

// flextip has its own; the others take theirs in turn.
const char* ColourOf(const std::string& name, const std::vector<std::string>& names) {
  if (name == "flextip") return kOwnColour;
  std::size_t before = 0;
  for (const std::string& other : names) {
    if (other == name) break;
    before += other != "flextip";
  }
  return kColours[before % kColours.size()];
}

class Axis {
 public:
  Axis(double low, double high, bool log, double from, double to)
      : low_(log ? std::log10(low) : low),
        high_(log ? std::log10(high) : high),
        log_(log),
        from_(from),
        to_(to) {
    if (high_ - low_ < 1e-9) high_ = low_ + 1;
  }
  double At(double v) const {
    return from_ + ((log_ ? std::log10(v) : v) - low_) / (high_ - low_) * (to_ - from_);
  }
  /// 1, 2, 5 times powers of ten.
  std::vector<double> Ticks() const {
    std::vector<double> ticks;
    if (log_) {
      const bool few = high_ - low_ > 2.5;
      for (int e = static_cast<int>(std::floor(low_)); e <= static_cast<int>(std::ceil(high_));
           ++e) {
        for (const double m : {1.0, 2.0, 5.0}) {
          const double at = e + std::log10(m);
          if (at > low_ - 1e-9 && at < high_ + 1e-9 && (m == 1 || !few)) {
            ticks.push_back(std::pow(10, at));
          }
        }
      }
      return ticks;
    }
    const double raw = (high_ - low_) / 5, power = std::pow(10, std::floor(std::log10(raw)));
    double step = power;
    for (const double m : {2.0, 5.0, 10.0}) {
      if (step < raw) step = m * power;
    }
    for (double t = std::ceil(low_ / step - 1e-9) * step; t <= high_ + 1e-9; t += step) {
      ticks.push_back(std::abs(t) < 1e-12 ? 0 : t);
    }
    return ticks;
  }

 private:
  double low_, high_;
  bool log_;
  double from_, to_;
};

struct Range {
  double low = 1e300, high = -1e300;
  void Take(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

bool Shown(const Plot& plot, const std::pair<double, double>& p) {
  return std::isfinite(p.second) && (!plot.log_y || p.second > 0);
}

std::string Frame(const Plot& plot, const Axis& x, const Axis& y, int x0, int y0) {
  const int right = x0 + kWidth - kRight, low = y0 + kHeight - kBottom;
  std::string svg = fmt::format(
      "<text x='{}' y='{}' font-size='15' font-weight='bold'>{}</text>\n"
      "<text x='{}' y='{}' font-size='12' text-anchor='middle' fill='#555'>{}</text>\n"
      "<text transform='translate({},{}) rotate(-90)' font-size='12' text-anchor='middle' "
      "fill='#555'>{}</text>\n",
      x0 + kLeft, y0 + 24, plot.title, x0 + (kLeft + kWidth - kRight) / 2, low + 36, plot.x_label,
      x0 + 16, y0 + (kTop + kHeight - kBottom) / 2, plot.y_label);
  for (const double t : y.Ticks()) {
    svg += fmt::format(
        "<line x1='{}' y1='{:.1f}' x2='{}' y2='{:.1f}' stroke='#e3e3e3'/>\n"
        "<text x='{}' y='{:.1f}' font-size='11' text-anchor='end'>{:g}</text>\n",
        x0 + kLeft, y.At(t), right, y.At(t), x0 + kLeft - 6, y.At(t) + 4, t);
  }
  for (const double t : x.Ticks()) {
    svg += fmt::format(
        "<line x1='{0:.1f}' y1='{1}' x2='{0:.1f}' y2='{2}' stroke='#aaa'/>\n"
        "<text x='{0:.1f}' y='{3}' font-size='11' text-anchor='middle'>{4:g}</text>\n",
        x.At(t), low, low + 4, low + 18, t);
  }
  return svg + fmt::format("<path d='M{0} {1}V{2}H{3}' fill='none' stroke='#888'/>\n", x0 + kLeft,
                           y0 + kTop, low, right);
}

std::string Panel(const Plot& plot, const std::vector<std::string>& names, int x0, int y0) {
  Range in_x, in_y;
  for (const PlotLine& line : plot.lines) {
    for (const auto& p : line.points) {
      if (!Shown(plot, p)) continue;
      in_x.Take(p.first);
      in_y.Take(p.second);
    }
  }
  if (in_x.low > in_x.high) return {};
  if (!plot.log_y) in_y.Take(0);
  const Axis x(in_x.low, in_x.high, false, x0 + kLeft, x0 + kWidth - kRight);
  const Axis y(in_y.low, in_y.high, plot.log_y, y0 + kHeight - kBottom, y0 + kTop);
  std::string svg = Frame(plot, x, y, x0, y0);
  for (const PlotLine& line : plot.lines) {
    const char* colour = ColourOf(line.name, names);
    std::string path, dots;
    for (const auto& p : line.points) {
      if (!Shown(plot, p)) continue;
      path +=
          fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x.At(p.first), y.At(p.second));
      dots += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='2.6' fill='{}'/>\n", x.At(p.first),
                          y.At(p.second), colour);
    }
    svg += fmt::format("<path d='{}' fill='none' stroke='{}' stroke-width='1.8'/>\n", path, colour);
    svg += dots;
  }
  return svg;
}

}  // namespace

std::string PlotsSvg(const std::vector<Plot>& plots, const std::string& title, int columns) {
  std::vector<std::string> names;
  for (const Plot& plot : plots) {
    for (const PlotLine& line : plot.lines) {
      if (std::find(names.begin(), names.end(), line.name) == names.end()) {
        names.push_back(line.name);
      }
    }
  }
  const int rows = (static_cast<int>(plots.size()) + columns - 1) / columns;
  const int width = columns * kWidth;
  int x = 12, y = 50;
  std::string legend;
  for (const std::string& name : names) {
    const int wide = 42 + 8 * static_cast<int>(name.size());
    if (x + wide > width && x > 12) {
      x = 12;
      y += 22;
    }
    legend += fmt::format(
        "<rect x='{}' y='{}' width='18' height='5' fill='{}'/><text x='{}' y='{}' "
        "font-size='13'>{}</text>\n",
        x, y - 4, ColourOf(name, names), x + 24, y + 4, name);
    x += wide;
  }
  const int head = y + 20;
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
      "font-family='DejaVu Sans, Arial, sans-serif' fill='#222'>\n"
      "<rect width='{0}' height='{1}' fill='#fff'/>\n"
      "<text x='12' y='28' font-size='19' font-weight='bold'>{2}</text>\n{3}",
      width, head + rows * kHeight, title, legend);
  for (std::size_t i = 0; i < plots.size(); ++i) {
    const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    svg += Panel(plots[i], names, column * kWidth, head + row * kHeight);
  }
  return svg + "</svg>\n";
}

}  // namespace flextip
