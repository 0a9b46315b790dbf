#include "bench/calibration/chain_picture.h"

#include <fmt/format.h>

#include <algorithm>

namespace flextip::bench {
namespace {

constexpr double kLeft = 90, kBar = 11, kRow = 34, kPanel = 260, kTop = 52, kGap = 40;
constexpr const char* kClaimed = "#9ecae1";
constexpr const char* kMeasured = "#08519c";

std::string Text(double x, double y, const std::string& text, const char* anchor = "start") {
  return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>\n", x, y, anchor,
                     text);
}

std::string Bar(double x, double y, double width, const char* colour, double value_mm) {
  return fmt::format("<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{}' fill='{}'/>\n", x, y,
                     width, kBar, colour) +
         Text(x + width + 4, y + kBar - 1.5, fmt::format("{:.3f}", value_mm));
}

}  // namespace

std::string ChainSvg(const std::vector<ChainPart>& parts) {
  double most_mm = 0;
  for (const ChainPart& part : parts) {
    for (const auto& both : {part.depth_mm, part.across_mm}) {
      most_mm = std::max({most_mm, both.claimed, both.measured});
    }
  }
  const double width = kLeft + 2 * kPanel + kGap,
               height = kTop + kRow * static_cast<double>(parts.size()) + 10;
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
      "font-family='sans-serif' font-size='11'>\n<rect width='100%' height='100%' fill='#fff'/>\n",
      width, height);
  svg += fmt::format("<rect x='{}' y='8' width='11' height='11' fill='{}'/>\n", kLeft, kClaimed) +
         Text(kLeft + 16, 18, "claimed") +
         fmt::format("<rect x='{}' y='8' width='11' height='11' fill='{}'/>\n", kLeft + 75,
                     kMeasured) +
         Text(kLeft + 91, 18, "true") + Text(kLeft, 40, "along the line of sight (mm)") +
         Text(kLeft + kPanel + kGap, 40, "across it (mm)");
  const double per_mm = (kPanel - 45) / most_mm;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double y = kTop + kRow * static_cast<double>(i);
    svg += Text(kLeft - 8, y + kBar + 4, parts[i].name, "end");
    double x = kLeft;
    for (const auto& both : {parts[i].depth_mm, parts[i].across_mm}) {
      svg += Bar(x, y, per_mm * both.claimed, kClaimed, both.claimed) +
             Bar(x, y + kBar + 1, per_mm * both.measured, kMeasured, both.measured);
      x += kPanel + kGap;
    }
  }
  return svg + "</svg>\n";
}

}  // namespace flextip::bench
