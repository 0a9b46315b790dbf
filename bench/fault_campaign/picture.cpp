#include "bench/fault_campaign/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

namespace flextip::bench {
namespace {

constexpr int kLeft = 190, kTop = 70, kBar = 6, kGap = 6, kWidth = 600, kRight = 60;
constexpr std::array kColours{"#9a9a9a", "#d59a2f", "#3b7dd8", "#1b7f5c"};

double Rate(const KindFigures& of, const std::string& fault) {
  const auto at = of.by_fault.find(fault);
  return at == of.by_fault.end() ? 0.0 : at->second.PerThousand();
}

std::string Row(const std::string& fault, const std::vector<KindFigures>& figures, int y) {
  std::string svg = fmt::format("<text x='{}' y='{}' text-anchor='end'>{}</text>\n", kLeft - 8,
                                y + kBar * static_cast<int>(figures.size()) / 2 + 4, fault);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const double rate = Rate(figures[i], fault);
    const double width = kWidth * rate / 1000.0;
    svg += fmt::format(
        "<rect x='{}' y='{}' width='{:.1f}' height='{}' fill='{}'><title>{}: "
        "{:.0f}</title></rect>\n",
        kLeft, y + kBar * static_cast<int>(i), std::max(width, 1.0), kBar - 1, kColours[i],
        figures[i].kind, rate);
  }
  return svg;
}

}  // namespace

std::string HazardSvg(const std::vector<KindFigures>& figures) {
  std::set<std::string> faults;
  for (const KindFigures& of : figures)
    for (const auto& [fault, count] : of.by_fault) faults.insert(fault);
  const int row = kBar * static_cast<int>(figures.size()) + kGap;
  const int height = kTop + row * static_cast<int>(faults.size()) + 20;
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{}' height='{}' font-family='sans-serif' "
      "font-size='12'>\n<rect width='100%' height='100%' fill='#fff'/>\n"
      "<text x='{}' y='22' font-size='15'>Hazards per 1000 runs, by fault</text>\n",
      kLeft + kWidth + kRight, height, kLeft);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const int x = kLeft + 150 * static_cast<int>(i);
    svg += fmt::format(
        "<rect x='{}' y='34' width='12' height='10' fill='{}'/><text x='{}' y='44'>{}</text>\n", x,
        kColours[i], x + 18, figures[i].kind);
  }
  for (int rate = 0; rate <= 1000; rate += 250) {
    const int x = kLeft + kWidth * rate / 1000;
    svg += fmt::format(
        "<line x1='{0}' y1='{1}' x2='{0}' y2='{2}' stroke='#e3e3e3'/>"
        "<text x='{0}' y='{3}' text-anchor='middle' fill='#666'>{4}</text>\n",
        x, kTop - 6, height - 14, kTop - 10, rate);
  }
  int y = kTop;
  for (const std::string& fault : faults) {
    svg += Row(fault, figures, y);
    y += row;
  }
  return svg + "</svg>\n";
}

}  // namespace flextip::bench
