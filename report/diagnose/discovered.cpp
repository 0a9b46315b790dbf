#include "report/diagnose/discovered.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "report/diagnose/words.h"
#include "report/labels.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

std::string Capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = char(text[0] - 'a' + 'A');
  return text;
}

std::string NameOf(const DiagnosedTermName& name) {
  std::string on;
  for (const auto& variable : name.depends_on)
    on += (on.empty() ? "" : " and ") + SpokenHypothesis(variable);
  return SpokenChannel(name.channel) + (on.empty() ? "" : " by " + on) + " (" + name.form + ")";
}

/// How large and where, the doubt, and where it could sit as well.
std::string CaptionOf(const DiagnosedTerm& term) {
  std::string caption = fmt::format(
      "Points: what the sensors say, all else as fitted. Line: the term. False by "
      "chance with {:.1g}.",
      term.false_discovery);
  if (term.heldout_error_ratio)
    caption += fmt::format(" Held-out error × {:.2f}.", *term.heldout_error_ratio);
  if (term.depth_m.size() == 2)
    caption += fmt::format(
        " It is at least half its largest in {:.0f} % of the samples, at insertions of {:.0f} to "
        "{:.0f} mm.",
        100.0 * term.part_of_samples, 1e3 * term.depth_m[0], 1e3 * term.depth_m[1]);
  std::string others;
  for (const auto& other : term.could_be) others += (others.empty() ? "" : "; ") + NameOf(other);
  if (!others.empty()) caption += " It could as well be: " + others + ".";
  return caption;
}

/// "time (s)"; the variables of docs/formats.md are in SI.
std::string VariableLabel(const DiagnosedTerm& term) {
  static const std::map<std::string, std::string> units{
      {"time", "s"},          {"insertion_depth", "m"}, {"sliding_velocity", "m/s"},
      {"wrist_speed", "m/s"}, {"port_force", "N"},      {"load", "N"},
      {"position", "m"},      {"orientation", "1"},     {"distance_to_camera", "m"}};
  if (term.name.depends_on.empty()) return "sample";
  const std::string& variable = term.name.depends_on.front();
  const auto unit = units.find(variable);
  return SpokenHypothesis(variable) + " (" + (unit == units.end() ? "SI" : unit->second) + ")";
}

Figure PictureOf(const ResultTable& table, std::size_t i, const DiagnosedTerm& term) {
  const ShownUnit shown = ShownUnitOf(term.name.channel);
  const std::string unit = shown.unit.empty() ? "SI" : shown.unit;
  Figure plot{.title = Capital(term.text),
              .caption = CaptionOf(term),
              .x_label = VariableLabel(term),
              .y_label = SpokenChannel(term.name.channel) + " (" + unit + ")"};
  const auto column = [&](const char* what) {
    return table.Column(fmt::format("{}.{}", i + 1, what));
  };
  const auto *x = column("variable"), *measured = column("measured"), *said = column("term");
  if (x == nullptr || measured == nullptr || said == nullptr) return plot;
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < x->size(); ++k)
    if (std::isfinite((*x)[k])) order.push_back(k);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return (*x)[a] < (*x)[b]; });
  const bool has_past = term.name.depends_on.size() > 1;  // then no line through all
  FigureTrace points{
      .name = "measured", .kind = FigureTrace::Kind::kPoints, .color = "rgba(213,94,0,0.35)"};
  FigureTrace line{.name = "term",
                   .kind = has_past ? FigureTrace::Kind::kPoints : FigureTrace::Kind::kLine,
                   .color = "rgb(0,114,178)"};
  for (const std::size_t k : order) {
    points.x.push_back((*x)[k]);
    points.y.push_back(shown.per_si * (*measured)[k]);
    line.x.push_back((*x)[k]);
    line.y.push_back(shown.per_si * (*said)[k]);
  }
  plot.traces = {points, line};
  return plot;
}

Table TableOf(const std::vector<DiagnosedTerm>& terms) {
  Table table{.header = {"term", "parameter", "value ± standard deviation"}};
  for (const auto& term : terms) {
    for (const auto& p : term.parameters) {
      if (p.value.size() != 1) continue;
      const auto unit = ShownUnitOf(p.name);
      const double sd = p.sd.empty() ? 0.0 : unit.per_si * p.sd[0];
      table.rows.push_back(
          {NameOf(term.name), unit.name, WithDeviation(unit.per_si * p.value[0], sd, unit.unit)});
    }
  }
  return table;
}

}  // namespace

void AddDiscovered(Report& report, const std::filesystem::path& folder,
                   const DiagnosedResult& result) {
  if (result.discovered.empty()) return;
  report.AddHeading("Found in the residuals, without a name");
  const auto file = folder / "discovered.csv";
  const ResultTable table = std::filesystem::exists(file) ? ReadResultTable(file) : ResultTable{};
  for (std::size_t i = 0; i < result.discovered.size(); ++i) {
    const Figure picture = PictureOf(table, i, result.discovered[i]);
    if (!picture.traces.empty()) report.AddFigure(picture);
  }
  report.AddTable(TableOf(result.discovered));
}

}  // namespace flextip::report
