#include "calibration/verdict/budget.h"

#include <fmt/format.h>

#include <map>

namespace flextip {

namespace {

/// The command that makes a part smaller, where there is one: with files that are yet to be made.
std::string CommandFor(const std::string& part) {
  static const std::map<std::string, std::string> kCommands = {
      {"pixels", "flextip collar -o collar"},
      {"lens", "flextip calibrate camera board*.jpg --board chessboard:9x6:0.025 -o camera"},
      {"hand-eye", "flextip calibrate hand-eye recording -o hand-eye"},
      {"tip offset", "flextip calibrate tip recording -o tip"},
      {"stiffness", "flextip calibrate stiffness recording -o stiffness"}};
  const auto it = kCommands.find(part);
  return it == kCommands.end() ? std::string() : it->second;
}

const BudgetPartSize* LargestOf(const std::vector<BudgetPartSize>& parts) {
  for (const BudgetPartSize& part : parts) {
    if (part.in_total && !part.IsTotal()) return &part;
  }
  return nullptr;
}

}  // namespace

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
  const BudgetPartSize* largest = LargestOf(parts);
  return largest == nullptr ? std::string() : "most is from " + kWhatToDo.at(largest->name);
}

CalibrationVerdict JudgeBudget(const std::vector<BudgetPartSize>& parts,
                               const std::vector<UnknownPart>& not_known, std::size_t frames) {
  CalibrationVerdict verdict;
  verdict.next = BudgetAdvice(parts);
  if (const BudgetPartSize* largest = LargestOf(parts)) verdict.command = CommandFor(largest->name);
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
