#include "bench/diagnosis_matrix/output/summary.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace flextip::bench {
namespace {

nlohmann::json ConfusionJson(const Confusion& confusion) {
  nlohmann::json rows = nlohmann::json::object();
  for (std::size_t i = 0; i < confusion.rows.size(); ++i) {
    nlohmann::json row = nlohmann::json::object();
    for (std::size_t j = 0; j < confusion.columns.size(); ++j) {
      if (confusion.counts[i][j] > 0) row[confusion.columns[j]] = confusion.counts[i][j];
    }
    if (!row.empty()) rows[confusion.rows[i]] = row;
  }
  return {{"title", confusion.title}, {"answers", rows}};
}

/// Single effects and pairs that no diagnosis could have told from a rival, right or not.
std::string NotSeparable(const std::vector<MatrixRecord>& records) {
  std::string text;
  for (const MatrixRecord& r : records) {
    if (r.rival.empty() || r.IsSeparable()) continue;
    text += fmt::format("{}\n  {:.1f} apart from {}, answered {}\n", r.key, r.separation, r.rival,
                        r.error.empty() ? JoinedNames(r.verdict) : "nothing");
  }
  if (text.empty()) return text;
  return fmt::format("\nnot separable (twice the log likelihood ratio is below {}):\n\n{}",
                     kSeparable, text);
}

}  // namespace

std::string FigureTable(const std::vector<MatrixFigure>& figures) {
  std::string table =
      fmt::format("{:<38} {:<26} {:>9} {:>6}  {}\n", "figure", "of", "value", "n", "target");
  for (const MatrixFigure& f : figures) {
    table += fmt::format("{:<38} {:<26} {:>9.3f} {:>6}  {}\n", f.figure, f.group, f.value, f.of,
                         f.target);
  }
  return table;
}

std::string SummaryJson(const std::vector<MatrixFigure>& figures,
                        const std::vector<Confusion>& confusions) {
  nlohmann::json all = {{"figures", nlohmann::json::array()},
                        {"confusions", nlohmann::json::array()}};
  for (const MatrixFigure& f : figures) {
    all["figures"].push_back({{"figure", f.figure},
                              {"of", f.group},
                              {"value", f.value},
                              {"n", f.of},
                              {"target", f.target}});
  }
  for (const Confusion& c : confusions) all["confusions"].push_back(ConfusionJson(c));
  return all.dump(1) + "\n";
}

std::string Misses(const std::vector<MatrixRecord>& records) {
  std::string text;
  for (const MatrixRecord& r : records) {
    if (r.IsRight() && r.error.empty()) continue;
    const std::string hidden = r.form.empty() ? JoinedNames(r.label) : r.form;
    text +=
        fmt::format("{}  ({}, {} load)\n  {}\n", r.key, r.motion, r.load, MakeHiddenCall(r.made));
    if (!r.error.empty()) {
      text += "  refused: " + r.error + "\n\n";
      continue;
    }
    text += fmt::format(
        "  hidden {}, answered {}{}; chi2/dof {:.3f} -> {:.3f}, {} fits{}\n ", hidden,
        JoinedNames(r.verdict), r.IsRightOrDeclared() ? " (truth declared indistinguishable)" : "",
        r.base_chi2_per_dof, r.extended_chi2_per_dof, r.fits, r.converged ? "" : ", not converged");
    for (const auto& [names, p] : r.probabilities) {
      text += fmt::format(" {} {:.4f}", JoinedNames(names), p);
    }
    text += fmt::format("; truth {:.4f}{}\n\n", r.p_truth,
                        r.truth_in_credible_set ? " (in the 90 % set)" : "");
  }
  return (text.empty() ? "no misses\n" : text) + NotSeparable(records);
}

}  // namespace flextip::bench
