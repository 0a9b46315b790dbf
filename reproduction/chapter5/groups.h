// The conditions of the user study and the questions beyond it. Private to reproduction.
#pragma once

#include <string>
#include <vector>

#include "reproduction/chapter5/study.h"

namespace flextip::reproduction {

/// The thesis's four, in the order of its tables: Flex-Track, Straight-Track, Flex-Calculate,
/// Straight-Calculate.
inline constexpr int kThesisControllers = 4;
const char* ThesisName(int condition);

/// All groups: the thesis's four first, then ours and the variations, found by name.
std::vector<StudyGroup> StudyGroups(bool quick);

/// Update rates of the curve, and what it is drawn for.
const std::vector<double>& CurveRates();
const std::vector<std::string>& CurveControllers();
std::string CurveGroup(const std::string& controller, double rate_hz);

/// Throws WorkError where there is none.
const GroupResult& Find(const std::vector<GroupResult>& results, const std::string& name);

}  // namespace flextip::reproduction
