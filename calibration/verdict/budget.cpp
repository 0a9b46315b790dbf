#include "calibration/verdict/budget.h"

#include <fmt/format.h>

#include <map>

namespace flextip {

std::string BudgetAdvice(const std::vector<BudgetPartSize>& parts) {
  static const std::map<std::string, std::string> kWhatToDo = {
      {"pixels", "the pictures themselves: larger or more tags, nearer, sharper"},
      {"lens", "the lens: calibrate the camera again with the views it asks for"},
      {"hand-eye", "hand-eye: calibrate it again with the motion it asks for"},
      {"tip offset", "the tip's place on the collar: calibrate the tip again, with wider turns"},
      {"bending",
       "the bending beyond the collar: nearer to the tip the collar sees it, or the "
       "force has to be taken into account"},
      {"load", "the force on the tip: measure it better"},
      {"stiffness", "the shaft's stiffness: calibrate it again with the load it asks for"}};
  for (const BudgetPartSize& part : parts) {
    if (!part.in_total || part.IsTotal()) continue;
    return "most is from " + kWhatToDo.at(part.name);
  }
  return {};
}

CalibrationVerdict JudgeBudget(const std::vector<BudgetPartSize>& parts,
                               const std::vector<UnknownPart>& not_known, std::size_t frames) {
  CalibrationVerdict verdict;
  verdict.next = BudgetAdvice(parts);
  for (const BudgetPartSize& part : parts) {
    verdict.Add(part.in_total ? part.name : part.name + " (if bending were corrected)",
                fmt::format("{:.2g} mm in depth, {:.2g} mm across", part.depth_mm, part.across_mm));
  }
  verdict.Add("frames", std::to_string(frames));
  for (const UnknownPart& one : not_known) verdict.not_found.push_back({one.part, one.reason});
  const BudgetPartSize& total = parts.back();
  verdict.says =
      fmt::format("The tip is known to {:.2g} mm along the line of sight and {:.2g} mm across it.",
                  total.depth_mm, total.across_mm);
  if (!not_known.empty()) {
    verdict.Beware(Counted(not_known.size(), "part") +
                   " of the chain had no calibration: the truth is worse than this total");
  }
  return verdict;
}

}  // namespace flextip
