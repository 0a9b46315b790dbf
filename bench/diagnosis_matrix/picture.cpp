#include "bench/diagnosis_matrix/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace flextip::bench {
namespace {

constexpr int kCell = 30, kLeft = 190, kTop = 150, kTotal = 56, kTitle = 104, kGap = 30;
constexpr const char* kRightColour = "#1b7f5c";
constexpr const char* kWrongColour = "#c2491d";

int PanelHeight(const Confusion& c) { return kTop + kCell * static_cast<int>(c.rows.size()); }
int PanelWidth(const Confusion& c) {
  return kLeft + kCell * static_cast<int>(c.columns.size()) + kTotal + 20;
}

std::string Escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

/// Mixed with white: 0 white, 1 the colour itself.
std::string Shade(const std::string& colour, double share) {
  std::string shaded = "#";
  for (int i = 0; i < 3; ++i) {
    const int full = std::stoi(colour.substr(1 + 2 * i, 2), nullptr, 16);
    const double depth = 0.15 + 0.85 * share;
    shaded += fmt::format("{:02x}", static_cast<int>(255.0 + (full - 255.0) * depth));
  }
  return shaded;
}

std::string Cell(int x, int y, int count, int total, bool right) {
  const double share = total > 0 ? double(count) / total : 0.0;
  std::string svg;
  if (count > 0) {
    svg += fmt::format("<rect x='{}' y='{}' width='{}' height='{}' fill='{}'/>\n", x, y, kCell,
                       kCell, Shade(right ? kRightColour : kWrongColour, share));
    svg +=
        fmt::format("<text x='{}' y='{}' text-anchor='middle' font-size='13' fill='{}'>{}</text>\n",
                    x + kCell / 2, y + kCell / 2 + 5, share > 0.45 ? "#fff" : "#222", count);
  }
  if (right) {
    svg += fmt::format(
        "<rect x='{}' y='{}' width='{}' height='{}' fill='none' stroke='{}' "
        "stroke-width='1.6'/>\n",
        x + 1, y + 1, kCell - 2, kCell - 2, kRightColour);
  }
  return svg;
}

std::string Grid(const Confusion& c, int y0) {
  const int width = kCell * static_cast<int>(c.columns.size());
  const int height = kCell * static_cast<int>(c.rows.size());
  std::string svg;
  for (std::size_t i = 0; i <= c.rows.size(); ++i) {
    const int y = y0 + kCell * static_cast<int>(i);
    svg += fmt::format("<line x1='{}' y1='{}' x2='{}' y2='{}' stroke='#e3e3e3'/>\n", kLeft, y,
                       kLeft + width, y);
  }
  for (std::size_t j = 0; j <= c.columns.size(); ++j) {
    const int x = kLeft + kCell * static_cast<int>(j);
    svg += fmt::format("<line x1='{}' y1='{}' x2='{}' y2='{}' stroke='#e3e3e3'/>\n", x, y0, x,
                       y0 + height);
  }
  return svg;
}

std::string Row(const Confusion& c, std::size_t i, int y) {
  const int total = std::accumulate(c.counts[i].begin(), c.counts[i].end(), 0);
  std::string svg = fmt::format("<text x='{}' y='{}' text-anchor='end' font-size='13'>{}</text>\n",
                                kLeft - 8, y + kCell / 2 + 5, Escaped(c.rows[i]));
  for (std::size_t j = 0; j < c.columns.size(); ++j) {
    svg += Cell(kLeft + kCell * static_cast<int>(j), y, c.counts[i][j], total,
                static_cast<int>(j) == c.right[i]);
  }
  return svg + fmt::format("<text x='{}' y='{}' font-size='13' fill='#555'>of {}</text>\n",
                           kLeft + kCell * static_cast<int>(c.columns.size()) + 8,
                           y + kCell / 2 + 5, total);
}

std::string Panel(const Confusion& c, int y) {
  int right = 0, total = 0;
  for (std::size_t i = 0; i < c.rows.size(); ++i) {
    right += c.counts[i][c.right[i]];
    total += std::accumulate(c.counts[i].begin(), c.counts[i].end(), 0);
  }
  std::string svg = fmt::format(
      "<text x='12' y='{}' font-size='17' font-weight='bold'>{}</text>\n"
      "<text x='12' y='{}' font-size='13' fill='#555'>{} of {} right</text>\n",
      y + 20, Escaped(c.title), y + 42, right, total);
  const int y0 = y + kTop;
  svg += Grid(c, y0);
  for (std::size_t j = 0; j < c.columns.size(); ++j) {
    const int x = kLeft + kCell * static_cast<int>(j) + kCell / 2 + 4;
    svg += fmt::format("<text transform='translate({},{}) rotate(-55)' font-size='13'>{}</text>\n",
                       x, y0 - 6, Escaped(c.columns[j]));
  }
  for (std::size_t i = 0; i < c.rows.size(); ++i) {
    svg += Row(c, i, y0 + kCell * static_cast<int>(i));
  }
  return svg;
}

std::string Legend(int y) {
  std::string svg;
  int x = 12;
  for (const auto& [colour, words] :
       {std::pair{kRightColour, "right answer"}, std::pair{kWrongColour, "another answer"}}) {
    for (const double share : {0.1, 0.5, 1.0}) {
      svg += fmt::format("<rect x='{}' y='{}' width='22' height='14' fill='{}'/>\n", x, y,
                         Shade(colour, share));
      x += 22;
    }
    svg += fmt::format("<text x='{}' y='{}' font-size='13'>{}</text>\n", x + 6, y + 12, words);
    x += 130;
  }
  return svg + fmt::format(
                   "<text x='12' y='{}' font-size='13' fill='#555'>rows: what was hidden; columns: "
                   "what was answered; shade: 10, 50, 100 % of the row; frame: the right "
                   "answer</text>\n",
                   y + 34);
}

}  // namespace

std::string ConfusionSvg(const std::vector<Confusion>& confusions, const std::string& title) {
  int width = 1060, height = kTitle;
  for (const Confusion& c : confusions) {
    width = std::max(width, PanelWidth(c));
    height += PanelHeight(c) + kGap;
  }
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
      "font-family='DejaVu Sans, Arial, sans-serif' fill='#222'>\n"
      "<rect width='{0}' height='{1}' fill='#fff'/>\n"
      "<text x='12' y='28' font-size='20' font-weight='bold'>{2}</text>\n",
      width, height, Escaped(title));
  svg += Legend(46);
  int y = kTitle;
  for (const Confusion& c : confusions) {
    svg += Panel(c, y);
    y += PanelHeight(c) + kGap;
  }
  return svg + "</svg>\n";
}

}  // namespace flextip::bench
