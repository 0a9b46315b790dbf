#include "bench/vision/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace flextip::bench {
namespace {

constexpr int kWidth = 624, kHeight = 330, kLeft = 70, kRight = 208, kTop = 44, kBottom = 52;
constexpr double kLabelStep = 15;

struct Style {
  const char* colour;
  double width;
  const char* dashes;
};
constexpr Style kOwn = {"#1b7f5c", 3.2, "none"};
// Some of them lie on one another: those that come later are dashed.
constexpr std::array<Style, 5> kOthers = {{{"#c2491d", 2.2, "none"},
                                           {"#5b3fa0", 2.2, "3 5"},
                                           {"#2b6cb0", 1.8, "none"},
                                           {"#c98a00", 1.8, "none"},
                                           {"#111111", 1.3, "7 4"}}};

// flextip has its own; the others take theirs in turn.
Style StyleOf(const std::string& name, const std::vector<std::string>& names) {
  if (name == "flextip") return kOwn;
  std::size_t before = 0;
  for (const std::string& other : names) {
    if (other == name) break;
    before += other != "flextip";
  }
  return kOthers[before % kOthers.size()];
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

bool Shown(const Panel& plot, const std::pair<double, double>& p) {
  return std::isfinite(p.second) && (!plot.log_y || p.second > 0);
}

std::string Frame(const Panel& plot, const Axis& x, const Axis& y, int x0, int y0) {
  const int right = x0 + kWidth - kRight, low = y0 + kHeight - kBottom;
  std::string svg = fmt::format(
      "<text x='{}' y='{}' font-size='15' font-weight='bold'>{}</text>\n"
      "<text x='{}' y='{}' font-size='13' text-anchor='middle' fill='#555'>{}</text>\n"
      "<text transform='translate({},{}) rotate(-90)' font-size='13' text-anchor='middle' "
      "fill='#555'>{}</text>\n",
      x0 + kLeft, y0 + 26, plot.title, x0 + (kLeft + kWidth - kRight) / 2, low + 38, plot.x_label,
      x0 + 18, y0 + (kTop + kHeight - kBottom) / 2, plot.y_label);
  for (const double t : y.Ticks()) {
    svg += fmt::format(
        "<line x1='{}' y1='{:.1f}' x2='{}' y2='{:.1f}' stroke='#e3e3e3'/>\n"
        "<text x='{}' y='{:.1f}' font-size='12' text-anchor='end'>{:g}</text>\n",
        x0 + kLeft, y.At(t), right, y.At(t), x0 + kLeft - 6, y.At(t) + 4, t);
  }
  std::set<double> measured;
  for (const PlotLine& line : plot.lines) {
    for (const auto& p : line.points) measured.insert(p.first);
  }
  for (const double t : measured) {
    svg += fmt::format(
        "<line x1='{0:.1f}' y1='{1}' x2='{0:.1f}' y2='{2}' stroke='#888'/>\n"
        "<text x='{0:.1f}' y='{3}' font-size='12' text-anchor='middle'>{4:.3g}</text>\n",
        x.At(t), low, low + 4, low + 19, t);
  }
  return svg + fmt::format("<path d='M{0} {1}V{2}H{3}' fill='none' stroke='#888'/>\n", x0 + kLeft,
                           y0 + kTop, low, right);
}

struct Label {
  const PlotLine* line;
  double x, y, at_y;  // the line's last point, and where its name is written
};

// Names beside the ends of their lines, moved apart where they would overlap.
std::string Labels(std::vector<Label> labels, const std::vector<std::string>& names, int x0,
                   int y0) {
  std::stable_sort(labels.begin(), labels.end(),
                   [](const Label& a, const Label& b) { return a.y < b.y; });
  const double low = y0 + kHeight - kBottom;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    labels[i].at_y = i == 0 ? labels[i].y : std::max(labels[i].y, labels[i - 1].at_y + kLabelStep);
  }
  for (std::size_t i = labels.size(); i-- > 0;) {
    const double below = i + 1 < labels.size() ? labels[i + 1].at_y - kLabelStep : low;
    labels[i].at_y = std::min(labels[i].at_y, below);
  }
  std::string svg;
  const int right = x0 + kWidth - kRight;
  for (const Label& label : labels) {
    const Style style = StyleOf(label.line->name, names);
    svg += fmt::format(
        "<path d='M{:.1f} {:.1f}L{} {:.1f}' stroke='{}' stroke-width='0.7' "
        "stroke-dasharray='1 2' fill='none'/>\n"
        "<text x='{}' y='{:.1f}' font-size='12' fill='{}'{}>{}</text>\n",
        label.x + 4, label.y, right + 16, label.at_y, style.colour, right + 19, label.at_y + 4,
        style.colour, label.line->name == "flextip" ? " font-weight='bold'" : "", label.line->name);
  }
  return svg;
}

// The line, broken where there is nothing to show.
std::string Line(const Panel& plot, const PlotLine& line, const Style& style, const Axis& x,
                 const Axis& y) {
  std::string path, dots;
  bool pen_down = false;
  for (const auto& p : line.points) {
    const bool shown = Shown(plot, p);
    if (shown) {
      path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", x.At(p.first), y.At(p.second));
      dots += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='{:.1f}' fill='{}'/>\n", x.At(p.first),
                          y.At(p.second), 1 + 0.7 * style.width, style.colour);
    }
    pen_down = shown;
  }
  return fmt::format(
      "<path d='{}' fill='none' stroke='{}' stroke-width='{}' stroke-dasharray='{}'/>\n{}", path,
      style.colour, style.width, style.dashes, dots);
}

std::string PanelSvg(const Panel& plot, const std::vector<std::string>& names, int x0, int y0) {
  Range in_x, in_y;
  for (const PlotLine& line : plot.lines) {
    for (const auto& p : line.points) {
      in_x.Take(p.first);
      if (Shown(plot, p)) in_y.Take(p.second);
    }
  }
  if (in_y.low > in_y.high) return {};
  if (!plot.log_y) in_y.Take(0);
  const double room = plot.log_y ? std::pow(in_y.high / in_y.low, 0.05) : 1;
  const Axis x(in_x.low, in_x.high, plot.log_x, x0 + kLeft + 10, x0 + kWidth - kRight - 6);
  const Axis y(in_y.low / room, in_y.high * room, plot.log_y, y0 + kHeight - kBottom, y0 + kTop);
  std::string svg = Frame(plot, x, y, x0, y0);
  std::vector<Label> labels;
  // flextip's first, so that no other is hidden under its thick line.
  std::vector<const PlotLine*> lines;
  for (const PlotLine& line : plot.lines) lines.push_back(&line);
  std::stable_partition(lines.begin(), lines.end(),
                        [](const PlotLine* line) { return line->name == "flextip"; });
  for (const PlotLine* line : lines) {
    svg += Line(plot, *line, StyleOf(line->name, names), x, y);
    const auto last = std::find_if(line->points.rbegin(), line->points.rend(),
                                   [&](const auto& p) { return Shown(plot, p); });
    if (last == line->points.rend()) continue;
    labels.push_back({line, x.At(last->first), y.At(last->second), 0});
  }
  return svg + Labels(labels, names, x0, y0);
}

}  // namespace

std::string PlotsSvg(const std::vector<Panel>& plots, const std::string& title, int columns) {
  std::vector<std::string> names;
  for (const Panel& plot : plots) {
    for (const PlotLine& line : plot.lines) {
      if (std::find(names.begin(), names.end(), line.name) == names.end()) {
        names.push_back(line.name);
      }
    }
  }
  constexpr int kHead = 44;
  const int rows = (static_cast<int>(plots.size()) + columns - 1) / columns;
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
      "font-family='DejaVu Sans, Arial, sans-serif' fill='#222'>\n"
      "<rect width='{0}' height='{1}' fill='#fff'/>\n"
      "<text x='12' y='30' font-size='19' font-weight='bold'>{2}</text>\n",
      columns * kWidth, kHead + rows * kHeight, title);
  for (std::size_t i = 0; i < plots.size(); ++i) {
    const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    svg += PanelSvg(plots[i], names, column * kWidth, kHead + row * kHeight);
  }
  return svg + "</svg>\n";
}

}  // namespace flextip::bench
