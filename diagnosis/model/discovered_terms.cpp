#include "diagnosis/model/discovered_terms.h"

#include <fmt/format.h>

#include <algorithm>

#include "diagnosis/effects/discovered/term_text.h"

namespace flextip::diagnosis {
namespace {

std::vector<double> Flat(const Eigen::MatrixXd& values) {
  return {values.data(), values.data() + values.size()};
}

/// Why the shape's parameters mean nothing; empty where they do.
std::string WhatIsWrong(const Term& term) {
  const std::vector<double>& at = term.at;
  switch (term.shape) {
    case TermShape::kBand:
    case TermShape::kTanh:
    case TermShape::kExponential:
    case TermShape::kAfter:
    case TermShape::kRelaxing:
    case TermShape::kPlay:
    case TermShape::kSmoothPlay:
    case TermShape::kPeriodic:
      return at[0] > 0.0 ? "" : fmt::format("found at[0] = {}, expected > 0", at[0]);
    case TermShape::kStep:
      return at[1] > 0.0 ? "" : fmt::format("found at[1] = {}, expected > 0", at[1]);
    case TermShape::kRadial:
      return Dimension(term.variable) > 1 ? "" : "expected a place or an orientation as variable";
    case TermShape::kSmooth:
      return at[1] > at[0] ? ""
                           : fmt::format("found at = [{}, {}], expected a range", at[0], at[1]);
    default:
      return "";
  }
}

Term ReadTerm(const YamlMap& map) {
  const auto target = TargetNamed(map.Text("channel"));
  if (!target)
    throw map.Error("channel", fmt::format("found '{}', which is unknown", map.Text("channel")));
  const auto shape = ShapeNamed(map.Text("shape"));
  if (!shape)
    throw map.Error("shape", fmt::format("found '{}', which is unknown", map.Text("shape")));
  const auto variable = VariableNamed(map.TextOr("variable", Name(TermVariable::kTime)));
  if (!variable || *variable == TermVariable::kPreviousSamples)
    throw map.Error("variable", "expected what the term depends on");
  Term term{*target, *shape, *variable, {}, {}, {}};
  term.at = map.Numbers("at", static_cast<std::size_t>(ShapeParameters(*shape, *variable)));
  const auto inputs = static_cast<std::size_t>(term.Inputs());
  const std::vector<double> amplitude =
      map.Numbers("amplitude", inputs * static_cast<std::size_t>(term.Columns()));
  term.amplitude =
      Eigen::Map<const Eigen::MatrixXd>(amplitude.data(), term.Inputs(), term.Columns());
  if (map.Has("offset")) {
    const std::vector<double> offset = map.Numbers("offset", inputs);
    term.offset = Eigen::Map<const Eigen::VectorXd>(offset.data(), term.Inputs());
  }
  if (IsStamp(*target) && (*variable != TermVariable::kTime || HasMemory(*shape)))
    throw map.Error("variable", "expected time alone: a stamp depends on nothing else");
  map.TextOr("text", "");
  const auto unasked = map.Unasked();
  if (!unasked.empty()) throw map.Error(unasked.front(), "is no key of a discovered term");
  if (const std::string wrong = WhatIsWrong(term); !wrong.empty()) throw map.Error("at", wrong);
  return term;
}

}  // namespace

std::string TermsYaml(const std::vector<Term>& terms) {
  if (terms.empty()) return "";
  std::string text = "discovered:\n";
  for (const Term& term : terms) {
    text += fmt::format("  - channel: {}\n    shape: {}\n", InfoOf(term.target).channel,
                        Name(term.shape));
    if (term.shape != TermShape::kConstant)
      text += fmt::format("    variable: {}\n", Name(term.variable));
    text += fmt::format("    at: {}\n    amplitude: {}\n", YamlNumbers(term.at),
                        YamlNumbers(Flat(term.amplitude)));
    if (term.offset.size() > 0)
      text += fmt::format("    offset: {}\n", YamlNumbers(Flat(term.offset)));
    text += fmt::format("    text: {}\n", YamlText(TextOf(term)));
  }
  return text;
}

std::vector<Term> ReadTerms(const YamlMap& top) {
  std::vector<Term> terms;
  for (const YamlMap& map : top.Maps("discovered")) terms.push_back(ReadTerm(map));
  return terms;
}

}  // namespace flextip::diagnosis
