#include "report/diagnose/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "report/report.h"

namespace flextip::report {
namespace {

constexpr std::size_t kBars = 8;
constexpr double kFaint = kChanceScore;
constexpr const char* kStrong = "#00697d";
constexpr const char* kFaintBar = "#9fb0bf";
constexpr const char* kInk = "#1d2733";
constexpr const char* kBase = "#d55e00";
constexpr const char* kExtended = "#0072b2";

std::string FigureHtml(const char* style, const std::string& title, const std::string& inside,
                       const std::string& caption) {
  return fmt::format(
      "<figure class=\"table {}\">\n<h3>{}</h3>\n{}{}</figure>\n", style, EscapeHtml(title), inside,
      caption.empty() ? "" : fmt::format("<figcaption>{}</figcaption>\n", EscapeHtml(caption)));
}

/// From white to deep blue with the logarithm of the score; chance stays white.
std::string ScoreStyle(double score, double largest) {
  const double top = std::log(std::max(largest, 4.0 * kFaint) / kFaint);
  const double depth = score <= kFaint ? 0.0 : std::clamp(std::log(score / kFaint) / top, 0.0, 1.0);
  const auto mix = [&](double light, double dark) {
    return int(std::lround(light + (dark - light) * depth));
  };
  return fmt::format("background:rgb({},{},{});color:{}", mix(255, 8), mix(255, 69), mix(255, 110),
                     depth > 0.5   ? "#fff"
                     : depth > 0.0 ? "#1d2733"
                                   : "#8a95a1");
}

void AddOnce(std::vector<std::string>& list, const std::string& item) {
  if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
}

std::string HeatRow(const std::string& channel, const std::vector<std::string>& regressors,
                    const std::vector<DiagnosedSignature>& signatures) {
  std::string row = fmt::format("<tr><th>{}</th>", EscapeHtml(SpokenChannel(channel)));
  for (const auto& against : regressors) {
    const auto it = std::find_if(signatures.begin(), signatures.end(), [&](const auto& s) {
      return s.channel == channel && s.against == against;
    });
    row += it == signatures.end()
               ? "<td></td>"
               : fmt::format("<td style=\"{}\">{}</td>",
                             ScoreStyle(it->score, signatures.front().score),
                             fmt::format("{:.{}f}", it->score, it->score < 10.0 ? 1 : 0));
  }
  return row + "</tr>\n";
}

Figure EmptyBars(const std::string& title) {
  return {.title = title, .x_label = "probability (%)", .lying_bars = true};
}

std::size_t BarsOf(const Figure& figure) {
  return figure.traces.empty() ? 0 : figure.traces.front().y.size();
}

void AddBar(Figure& figure, const DiagnosedResult& result, const std::string& name,
            double probability, bool strong) {
  if (figure.traces.empty()) figure.traces.push_back({.kind = FigureTrace::Kind::kBars});
  FigureTrace& bars = figure.traces.front();
  bars.labels.push_back(SpokenHypothesis(name));
  bars.y.push_back(100.0 * std::clamp(probability, 0.0, 1.0));
  bars.texts.push_back(PercentOf(result, probability));
  bars.colors.emplace_back(strong ? kStrong : kFaintBar);
}

std::string ErrorText(double error) { return fmt::format("{:.{}f}", error, error < 10.0 ? 2 : 0); }

}  // namespace

Figure ProbabilityBars(const DiagnosedResult& result) {
  std::vector<std::string> found;  // the verdict and what this recording cannot tell from it
  for (const auto& set : result.Equivalents()) found.push_back(JoinedEffects(set));
  Figure figure = EmptyBars("How likely each answer is");
  for (const auto& [name, p] : result.probabilities) {
    const bool strong = std::find(found.begin(), found.end(), name) != found.end();
    const bool always = strong || name == "none" || name == "unknown";
    if (!always && (BarsOf(figure) >= kBars || p < 5e-4)) continue;
    AddBar(figure, result, name, p, strong);
  }
  return figure;
}

Figure PresenceBars(const DiagnosedResult& result) {
  std::vector<std::string> found;
  for (const auto& set : result.Equivalents()) found.insert(found.end(), set.begin(), set.end());
  Figure figure = EmptyBars("How likely each effect is there, in whatever company");
  for (const auto& [name, p] : result.presence) {
    if (name == "none" || name == "unknown" || BarsOf(figure) >= kBars || p < 5e-4) continue;
    AddBar(figure, result, name, p, std::find(found.begin(), found.end(), name) != found.end());
  }
  return figure;
}

std::string HeatMapHtml(const std::vector<DiagnosedSignature>& signatures) {
  if (signatures.empty()) return "";
  std::vector<std::string> channels, regressors;  // strongest first, as the list is
  for (const auto& s : signatures) {
    AddOnce(channels, s.channel);
    AddOnce(regressors, s.against);
  }
  std::string table = "<table class=\"heat\">\n<thead><tr><th></th>";
  for (const auto& against : regressors) {
    table += "<th>" + EscapeHtml(SpokenHypothesis(against)) + "</th>";
  }
  table += "</tr></thead>\n<tbody>";
  for (const auto& channel : channels) table += HeatRow(channel, regressors, signatures);
  return FigureHtml("wide", "Which residual depends on what", table + "</tbody></table>\n",
                    "Each number says how strongly the base simulation's residual in that channel "
                    "depends on that quantity, in standard deviations of what chance gives. Below "
                    "3 is chance.");
}

Figure ErrorBars(const std::string& title, std::vector<ErrorPair> errors,
                 const std::string& caption) {
  std::stable_sort(errors.begin(), errors.end(),
                   [](const auto& a, const auto& b) { return a.base > b.base; });
  FigureTrace base{.name = "base simulation", .kind = FigureTrace::Kind::kBars, .color = kBase};
  FigureTrace extended{
      .name = "extended model", .kind = FigureTrace::Kind::kBars, .color = kExtended};
  for (const auto& e : errors) {
    for (const auto& [trace, error] :
         {std::pair(&base, e.base), std::pair(&extended, e.extended)}) {
      trace->labels.push_back(e.label);
      trace->y.push_back(error);
      trace->texts.push_back(ErrorText(error));
    }
  }
  return {.title = title,
          .caption = caption,
          .x_label = "in units of noise (dashed: 1)",
          .lying_bars = true,
          .traces = {base, extended},
          .bands = {{1.0, 1.0, kInk}}};
}

std::string FoldedTableHtml(const std::string& title, const std::vector<std::string>& header,
                            const std::vector<std::vector<std::string>>& rows) {
  const auto line = [](const std::vector<std::string>& cells, const char* element) {
    std::string html = "<tr>";
    for (const auto& c : cells) html += fmt::format("<{0}>{1}</{0}>", element, EscapeHtml(c));
    return html + "</tr>\n";
  };
  std::string html = fmt::format("<details class=\"table\"><summary>{}</summary>\n<table><thead>{}",
                                 EscapeHtml(title), line(header, "th"));
  html += "</thead>\n<tbody>";
  for (const auto& row : rows) html += line(row, "td");
  return html + "</tbody></table></details>\n";
}

}  // namespace flextip::report
