#include "report/diagnose/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace flextip::report {
namespace {

constexpr double kSureSd = 3.0;  // of a number, in its deviations
constexpr double kSure = 0.9;    ///< from here on a verdict is stated, below it is "probably"
constexpr double kLikely = 0.5;
constexpr double kNearlyAll = 0.99;

std::string Capital(std::string text) {
  if (!text.empty()) text[0] = char(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

/// "a", "a or b", "a, b or c".
std::string Listed(const std::vector<std::string>& items, const std::string& last) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += i + 1 == items.size() ? " " + last + " " : ", ";
    text += items[i];
  }
  return text;
}

/// What the effect is in one line; its name where the file has no summary of it.
std::string Summary(const DiagnosedResult& result, const std::string& effect) {
  const auto it = result.summaries.find(effect);
  return it == result.summaries.end() ? SpokenHypothesis(effect) : it->second;
}

/// "the port rubs (port friction)", without saying the name twice.
std::string SummaryAndName(const DiagnosedResult& result, const std::string& effect) {
  const std::string summary = Summary(result, effect), name = SpokenHypothesis(effect);
  return summary == name ? name : summary + " (" + name + ")";
}

/// Of a list the number that is furthest off, of those that are sure where there are any.
std::size_t FurthestOff(const DiagnosedParameter& p) {
  const auto off = [&](std::size_t i) { return std::abs(p.value[i] - p.nominal[i]); };
  const auto is_sure = [&](std::size_t i) { return p.sd.empty() || off(i) > kSureSd * p.sd[i]; };
  std::size_t chosen = 0;
  for (std::size_t i = 1; i < p.value.size(); ++i) {
    if (is_sure(i) != is_sure(chosen) ? is_sure(i) : off(i) > off(chosen)) chosen = i;
  }
  return chosen;
}

/// A vector by its length, a list of like things by the one that is furthest off.
std::string InShort(const DiagnosedParameter& p) {
  const auto shown = ShownUnitOf(p.name);
  const auto sd = [&](std::size_t i) { return p.sd.empty() ? 0.0 : p.sd[i]; };
  if (!IsOfJoints(p) && (p.value.size() == 2 || p.value.size() == 3)) {
    double squares = 0.0, variance = 0.0;
    for (std::size_t i = 0; i < p.value.size(); ++i) {
      squares += p.value[i] * p.value[i];
      variance += p.value[i] * p.value[i] * sd(i) * sd(i);
    }
    const double length = std::sqrt(squares);
    const double deviation = length > 0.0 ? std::sqrt(variance) / length : sd(0);
    return shown.name + " " +
           WithDeviation(shown.per_si * length, shown.per_si * deviation, shown.unit);
  }
  const std::size_t chosen = FurthestOff(p);
  const std::string component = ComponentName(p, chosen);
  const ShownUnit unit = ShownUnitOf(p, chosen);
  return unit.name + (component.empty() ? "" : " " + component) + " " +
         WithDeviation(unit.per_si * p.value[chosen], unit.per_si * sd(chosen), unit.unit);
}

/// The effect's parameters in short, at most two; directions, phases and where a play stood at
/// first mean little by themselves.
std::string ParametersInShort(const DiagnosedResult& result, const std::string& effect) {
  std::vector<std::string> texts;
  for (const auto& p : result.parameters) {
    if (p.effect != effect || texts.size() == 2) continue;
    if (p.name.ends_with("axis") || p.name.starts_with("phase") || p.name == "start") continue;
    texts.push_back(InShort(p));
  }
  return Listed(texts, "and");
}

/// "the port rubs: coefficient 0.21 ± 0.01".
std::string Cause(const DiagnosedResult& result, const std::string& effect) {
  const std::string parameters = ParametersInShort(result, effect);
  return Summary(result, effect) + (parameters.empty() ? "" : ": " + parameters);
}

/// The most likely hypothesis besides the verdict and what equals it.
std::string NextBest(const DiagnosedResult& result) {
  const auto same = result.Equivalents();
  for (const auto& [name, p] : result.probabilities) {
    if (p < 0.01) continue;
    const bool part_of_verdict = std::any_of(
        same.begin(), same.end(),
        [&hypothesis = name](const auto& effects) { return JoinedEffects(effects) == hypothesis; });
    if (!part_of_verdict) return SpokenHypothesis(name) + ", " + Percent(p);
  }
  return "";
}

std::string Alike(const DiagnosedResult& result, const std::vector<std::string>& group) {
  std::vector<std::string> names;
  names.reserve(group.size());
  for (const auto& name : group) names.push_back(SummaryAndName(result, name));
  return Listed(names, "or");
}

bool HasAlternatives(const DiagnosedResult& result, std::size_t i) {
  return i < result.indistinguishable.size() && result.indistinguishable[i].size() > 1;
}

/// " (98 %)"; of a model that misses something, among the known causes alone, which nobody can call
/// sure.
std::string Bracket(const DiagnosedResult& result, double probability) {
  if (result.adequate) return " (" + Percent(probability) + ")";
  return probability > kNearlyAll ? "" : " (" + Percent(probability) + " among them)";
}

/// The sentence, with as much doubt before it as there is.
std::string Hedged(const DiagnosedResult& result, double probability, const std::string& sentence) {
  if (!result.adequate) return "The likeliest of the known causes: " + sentence;
  if (probability >= kSure) return Capital(sentence);
  return (probability >= kLikely ? "Probably: " : "Not sure, but most likely: ") + sentence;
}

void SayNone(double probability, Headline& headline) {
  headline.title =
      probability >= kSure ? "nothing beyond tolerance" : "probably nothing beyond tolerance";
  headline.verdict = fmt::format(
      "{} ({}).",
      probability >= kSure
          ? "Nothing is wrong beyond tolerance: the base simulation explains this recording"
          : "Probably nothing is wrong beyond tolerance, but this recording does not settle it",
      Percent(probability));
}

void SayUnknown(const DiagnosedResult& result, double probability, Headline& headline) {
  headline.title = "something unknown";
  headline.verdict =
      fmt::format("{}omething is wrong, and nothing in the catalogue explains it ({}).",
                  probability >= kSure ? "S" : "Probably s", Percent(probability));
  if (result.signatures.empty()) return;
  const auto& s = result.signatures.front();
  headline.verdict +=
      s.against == "previous_sample"
          ? fmt::format(" It shows most in {}, where what is left goes on from sample to sample.",
                        SpokenChannel(s.channel))
          : fmt::format(" It shows most in {}, which depends on {}.", SpokenChannel(s.channel),
                        SpokenHypothesis(s.against));
}

/// "hand eye or tag offset, and port friction".
std::string TitleOfEffects(const DiagnosedResult& result) {
  std::string title;
  for (std::size_t i = 0; i < result.verdicts.size(); ++i) {
    const bool alternatives = HasAlternatives(result, i);
    std::vector<std::string> names;
    for (const auto& name : alternatives ? result.indistinguishable[i]
                                         : std::vector<std::string>{result.verdicts[i]}) {
      names.push_back(SpokenHypothesis(name));
    }
    if (i > 0) title += HasAlternatives(result, i - 1) || alternatives ? ", and " : " and ";
    title += Listed(names, "or");
  }
  return title;
}

void SayEffects(const DiagnosedResult& result, double probability, Headline& headline) {
  headline.title = TitleOfEffects(result);
  const std::string percent = Bracket(result, probability);
  if (result.verdicts.size() > 1) {
    const std::string count = result.verdicts.size() == 2 ? "two" : "several";
    headline.verdict = Hedged(result, probability, count + " effects at once" + percent + ":");
    for (std::size_t i = 0; i < result.verdicts.size(); ++i) {
      headline.causes.push_back(HasAlternatives(result, i)
                                    ? "either " + Alike(result, result.indistinguishable[i]) +
                                          ", which this recording cannot tell apart"
                                    : Cause(result, result.verdicts[i]));
    }
  } else if (HasAlternatives(result, 0)) {
    headline.verdict = Hedged(result, probability,
                              "one of these, and this recording cannot tell which" + percent + ":");
    for (const auto& name : result.indistinguishable[0]) {
      headline.causes.push_back(SummaryAndName(result, name) + ", alone " +
                                Percent(result.Probability({name})));
    }
  } else {
    headline.verdict =
        Hedged(result, probability, Cause(result, result.verdicts.front()) + percent + ".");
  }
}

std::string TipGain(const DiagnosedResult& result) {
  const auto &base = result.base.tip_prediction_rms_m,
             &extended = result.extended.tip_prediction_rms_m;
  if (!base || !extended) return "";
  const bool better = *extended < 0.98 * *base;
  return fmt::format("; the tip's prediction {} from {} mm to {} mm", better ? "improves" : "goes",
                     Brief(1e3 * *base), Brief(1e3 * *extended));
}

std::string GainSentence(const DiagnosedResult& result) {
  if (!result.heldout_error_ratio) {
    return "The gain was not measured on held-out data.";
  }
  const double ratio = *result.heldout_error_ratio;
  std::string range;
  bool certain = true;
  if (const auto& interval = result.heldout_error_interval) {
    range = fmt::format(" (90 % interval {:.2f} to {:.2f})", interval->first, interval->second);
    certain = interval->second < 1.0;
  }
  if (ratio >= 0.98) {
    return fmt::format(
        "The extended model predicts held-out data no better than the base simulation: error "
        "ratio {:.2f}{}{}.",
        ratio, range, TipGain(result));
  }
  return fmt::format("On held-out data the extended model's error is {:.2f} of the base's{}{}{}.",
                     ratio, range, TipGain(result),
                     certain ? "" : "; the interval holds 1, so the gain is not certain");
}

std::string Advice(const DiagnosedResult& result) {
  bool alike = false;
  for (std::size_t i = 0; i < result.verdicts.size(); ++i) alike |= HasAlternatives(result, i);
  std::string advice;
  constexpr double kToldApart = 9.0;
  const bool told = result.separating_score.value_or(kToldApart) >= kToldApart;
  if (!result.separating_motion.empty() && (told || !alike)) {
    advice = "To tell them apart: " + result.separating_motion;
    if (advice.back() != '.') advice += '.';
  } else if (alike) {
    advice = "No motion is known that would tell them apart.";
  }
  if (!result.planned_motion.empty()) advice += (advice.empty() ? "" : " ") + result.planned_motion;
  return advice;
}

/// With no effect to add, what counts is whether only noise is left.
std::string SayWhatIsLeft(const DiagnosedResult& result) {
  const auto& left = result.base.chi2_per_dof;
  if (!left) return "";
  if (*left > 1.5 || *left < 0.5) {
    return fmt::format(
        "Yet chi-squared is {:.2f} per degree of freedom, where noise alone gives 1: the stated "
        "noise may be wrong.",
        *left);
  }
  return fmt::format(
      "What is left is of the size of the sensors' noise: chi-squared {:.2f} per degree of freedom "
      "(1 is noise alone). No extension is needed.",
      *left);
}

}  // namespace

std::string PercentOf(const DiagnosedResult& result, double probability) {
  return !result.adequate && probability > kNearlyAll ? "nearly all" : Percent(probability);
}

Headline MakeHeadline(const DiagnosedResult& result) {
  Headline headline;
  const double probability = result.VerdictProbability();
  if (result.Is("none")) {
    SayNone(probability, headline);
    headline.gain = SayWhatIsLeft(result);
  } else if (result.Is("unknown")) {
    SayUnknown(result, probability, headline);
    for (const DiagnosedTerm& term : result.discovered)
      headline.verdict += " In the residuals: " + term.text + ".";
    headline.gain =
        result.discovered.empty()
            ? "There is no extended model to trust; see below what the residuals depend on."
            : GainSentence(result);
  } else {
    SayEffects(result, probability, headline);
    for (std::size_t i = 0; i < result.verdicts.size(); ++i) {
      if (!HasAlternatives(result, i)) continue;
      headline.gain =
          "The extended model takes " + SpokenHypothesis(JoinedEffects(result.verdicts)) + ". ";
    }
    headline.gain += GainSentence(result);
  }
  headline.advice = Advice(result);
  const std::string next = NextBest(result);
  if (probability < kSure && !next.empty()) headline.runner_up = "Next likely: " + next + ".";
  return headline;
}

}  // namespace flextip::report
