#include "calibration/uncertainty/budget_summary.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace flextip {
namespace {

// The covariance of several entries of one calibration, in this order; empty where one is missing.
Eigen::MatrixXd JointCovariance(const Calibration& calibration,
                                const std::vector<std::string>& names) {
  if (calibration.covariance.size() == 0) return {};
  std::vector<int> places;
  for (const std::string& name : names) {
    if (!calibration.poses.count(name) && !calibration.numbers.count(name)) return {};
    const Calibration::Range range = calibration.RangeOf(name);
    for (int i = 0; i < range.count; ++i) places.push_back(range.first + i);
  }
  return calibration.covariance(places, places);
}

}  // namespace

std::vector<BudgetPart> PartsWithTotal(const TipBudget& budget) {
  std::vector<BudgetPart> parts = budget.parts;
  parts.push_back({"total", budget.TotalCovariance(), true});
  return parts;
}

std::vector<BudgetPartSize> SummariseBudgets(const std::vector<TimedBudget>& budgets) {
  std::map<std::string, BudgetPartSize> by_name;
  std::map<std::string, int> frames;
  for (const TimedBudget& b : budgets) {
    for (const BudgetPart& part : PartsWithTotal(b.value)) {
      const DepthAndAcross sd = SplitByDepth(part.covariance_R, b.value.depth_R);
      BudgetPartSize& size = by_name[part.name];
      size.name = part.name;
      size.in_total = part.in_total;
      size.depth_mm += 1e6 * sd.depth_m * sd.depth_m;
      size.across_mm += 1e6 * sd.across_m * sd.across_m;
      ++frames[part.name];
    }
  }
  std::vector<BudgetPartSize> sorted;
  for (auto& [name, size] : by_name) {
    size.depth_mm = std::sqrt(size.depth_mm / frames[name]);
    size.across_mm = std::sqrt(size.across_mm / frames[name]);
    sorted.push_back(size);
  }
  std::sort(sorted.begin(), sorted.end(), [](const BudgetPartSize& a, const BudgetPartSize& b) {
    if (a.IsTotal() != b.IsTotal()) return b.IsTotal();
    return std::hypot(a.depth_mm, a.across_mm) > std::hypot(b.depth_mm, b.across_mm);
  });
  return sorted;
}

StatedChain GatherChain(const std::vector<const Calibration*>& calibrations) {
  StatedChain chain;
  Eigen::MatrixXd stiffness;
  const auto take = [](Eigen::MatrixXd& into, const Eigen::MatrixXd& from) {
    if (from.size() > 0) into = from;
  };
  for (const Calibration* c : calibrations) {
    take(chain.covariance.lens,
         JointCovariance(*c, {"cam0.intrinsics", "cam0.distortion_coefficients"}));
    take(chain.covariance.hand_eye, JointCovariance(*c, {"cam0.T_RC"}));
    take(chain.covariance.tip_offset, JointCovariance(*c, {"tags0.p_E"}));
    take(stiffness, JointCovariance(*c, {"instrument.bending_stiffness_Nm2"}));
  }
  if (stiffness.size() > 0) chain.stiffness_sd_Nm2 = std::sqrt(stiffness(0, 0));
  const auto need = [&](const Eigen::MatrixXd& m, const char* part, const char* parameter) {
    if (m.size() == 0) chain.missing.push_back({part, parameter});
  };
  need(chain.covariance.lens, "lens", "cam0.intrinsics");
  need(chain.covariance.hand_eye, "hand-eye", "cam0.T_RC");
  need(chain.covariance.tip_offset, "tip offset", "tags0.p_E");
  need(stiffness, "stiffness", "instrument.bending_stiffness_Nm2");
  return chain;
}

}  // namespace flextip
