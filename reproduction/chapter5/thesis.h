// What 5.3 of the thesis prints, in the order of ThesisName (ch5_groups.h). Private to
// reproduction.
#pragma once

namespace flextip::reproduction {

struct ThesisNumbers {
  double mean, sd;
};
inline constexpr ThesisNumbers kThesisTime[] = {{11, 5}, {32, 10}, {59, 13}, {78, 10}};  // %
inline constexpr ThesisNumbers kThesisDepth[] = {{1, 0.5}, {2, 1}, {4.3, 1}, {6, 0.5}};  // mm
inline constexpr ThesisNumbers kThesisSwept[] = {
    {39, 21}, {320, 330}, {1500, 610}, {3400, 1100}};  // mm^2
inline constexpr ThesisNumbers kThesisOutline[] = {{15, 10}, {86, 81}, {230, 86}, {352, 86}};

}  // namespace flextip::reproduction
