// What a diagnosis says, in sentences and in the units people read.
#pragma once

#include <string>
#include <vector>

#include "report/diagnose/result.h"

namespace flextip::report {

/// The verdict's sentences, as text (not HTML).
struct Headline {
  std::string title;                ///< a few words for the page's title
  std::string verdict;              ///< the answer and its probability
  std::vector<std::string> causes;  ///< one line for each where there are several
  std::string gain;                 ///< the gain of the extended model
  std::string advice;               ///< the motion that would separate indistinguishable effects
  std::string runner_up;            ///< the next likely answer, where the verdict is not sure
};
Headline MakeHeadline(const DiagnosedResult& result);

/// 0.981 -> "98 %"; never "100 %" or "0 %" of what is not certain.
std::string Percent(double probability);
/// The same of an answer of `result`: "nearly all" where that is so among the known causes alone.
std::string PercentOf(const DiagnosedResult& result, double probability);
/// "port_friction+backlash" -> "port friction + backlash".
std::string SpokenHypothesis(const std::string& name);
/// "em0_position_m" -> "EM position", "strain0_moment_Nm" -> "strain".
std::string SpokenChannel(const std::string& channel);

/// How a parameter is shown, by the suffix of its name: "offset_m" in mm.
struct ShownUnit {
  std::string name = {};  ///< without the suffix, in words
  std::string unit = {};  ///< empty: no unit
  double per_si = 1.0;    ///< shown = SI value times this
};
ShownUnit ShownUnitOf(const std::string& parameter);
/// The same of component `i`: a number of an arm's joint has the unit of that joint.
ShownUnit ShownUnitOf(const DiagnosedParameter& parameter, std::size_t i);

/// "0.213 ± 0.011 mm": the digits of the standard deviation decide; without sd, three digits.
std::string WithDeviation(double value, double sd, const std::string& unit);
/// A number in three digits, or more where it has them before the point.
std::string Brief(double value);
/// "x", "y", "z" of three, "xy" of nine, else a number from one; empty for a single number.
std::string ComponentName(const DiagnosedParameter& parameter, std::size_t i);
/// Whether it is a list of an arm's joints, not a vector in space.
bool IsOfJoints(const DiagnosedParameter& parameter);

}  // namespace flextip::report
