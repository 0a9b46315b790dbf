#include "arms/diagnose/findings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace flextip::arms {
namespace {

using diagnosis::ReportedParameter;

constexpr double kCannotTell = 0.5;  // posterior over prior deviation
constexpr double kAsGood = 3.0;      // log odds
constexpr double kTakenUp = 0.7;     // correlation with what takes a number up

/// "joint_offset.offset[5]": the j-th number of a block as reported in order.
std::string NumberName(const Layout& layout, const Layout::Block& block, int j) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(block.size);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(block.size, block.size);
  int at = 0;
  for (const ArmParameter& p : block.effect->Report(layout.DataOf(block), zero, none)) {
    const int size = int(p.value.size());
    if (j < at + size) {
      return size == 1 ? fmt::format("{}.{}", block.effect->Name(), p.name)
                       : fmt::format("{}.{}[{}]", block.effect->Name(), p.name, j - at);
    }
    at += size;
  }
  return block.effect->Name();
}

/// Where a number of present effects stands: its list, and what takes it up.
struct LooseNumber {
  std::string list, taken_by;
  std::string which;  ///< "2" of joint 2, "5 by 6"; empty for a single number
};

LooseNumber MakeLoose(const Layout& layout, const Layout::Block& block, int j, int partner) {
  LooseNumber loose;
  const std::string name = NumberName(layout, block, j - block.first);
  const auto bracket = name.find('[');
  loose.list = name.substr(0, bracket);
  if (bracket != std::string::npos) {
    const int index = std::stoi(name.substr(bracket + 1));
    loose.which = std::to_string(index + 1);
    if (loose.list.ends_with("drag") || loose.list.ends_with("matrix")) {
      const Entry entry = OffDiagonal(layout.DataOf(block).Size(), index);
      loose.which = fmt::format("{} by {}", entry.row + 1, entry.column + 1);
    }
  }
  for (const Layout::Block& rival : layout.Blocks())
    if (partner >= rival.first && partner < rival.first + rival.size)
      loose.taken_by = rival.effect->IsAnswer() ? rival.effect->Name() : rival.effect->Summary();
  return loose;
}

/// Springs in plays that drag each other are believed before what looks like them.
void AddWhatSpringsTakeUp(const Layout& layout, const diagnosis::Hypothesis& best,
                          std::vector<std::string>& not_told) {
  if (!Holds(best, layout.WindowBlock())) return;
  const Eigen::MatrixXd carried = layout.Blocks()[layout.WindowBlock()].effect->History().carried;
  std::vector<int> tied;
  for (Eigen::Index j = 0; j < carried.cols(); ++j)
    if (IsTied(carried, j)) tied.push_back(int(j) + 1);
  if (tied.empty()) return;
  for (int b = 0; b < layout.EffectCount(); ++b) {
    const Layout::Block& block = layout.Blocks()[b];
    if (!block.effect->IsLikeSprings() || block.change || Holds(best, b)) continue;
    not_told.push_back(
        fmt::format("{} of joints {} cannot be told from springs that pull them back",
                    block.effect->Name(), fmt::join(tied, ", ")));
  }
}

}  // namespace

bool Holds(const diagnosis::Hypothesis& h, int block) {
  return std::find(h.effects.begin(), h.effects.end(), block) != h.effects.end();
}

std::vector<ReportedParameter> Reported(const Layout& layout, const Layout::Block& block,
                                        const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) {
  std::vector<ReportedParameter> reported;
  const auto own =
      block.effect->Report(layout.DataOf(block), theta.segment(block.first, block.size),
                           covariance.block(block.first, block.first, block.size, block.size));
  reported.reserve(own.size());
  for (const ArmParameter& p : own) reported.push_back({p.name, p.value, p.sd});
  return reported;
}

std::vector<std::string> NotTold(const Layout& layout, const diagnosis::WeighedHypothesis& weighed,
                                 const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd wide = layout.Prior().Widened(weighed.hypothesis.effects, weighed.scales);
  std::map<std::pair<std::string, std::string>, std::vector<std::string>> lists;
  for (const int b : weighed.hypothesis.effects) {
    const Layout::Block& block = layout.Blocks()[b];
    for (int j = block.first; j < block.first + block.size; ++j) {
      if (std::sqrt(std::max(0.0, covariance(j, j))) < kCannotTell * wide[j]) continue;
      int partner = -1;
      double most = kTakenUp;
      for (int other = 0; other < layout.Size(); ++other) {
        if (other == j) continue;
        const double scale = std::sqrt(covariance(j, j) * covariance(other, other));
        const double c = scale > 0.0 ? std::abs(covariance(j, other)) / scale : 0.0;
        if (c <= most) continue;
        most = c;
        partner = other;
      }
      const LooseNumber loose = MakeLoose(layout, block, j, partner);
      // The same list may begin in more than one recording.
      auto& indices = lists[{loose.list, loose.taken_by}];
      if (std::find(indices.begin(), indices.end(), loose.which) == indices.end())
        indices.push_back(loose.which);
    }
  }
  std::vector<std::string> not_told;
  for (const auto& [names, indices] : lists) {
    std::string text = names.first;
    if (!indices.front().empty()) text += fmt::format(" {}", fmt::join(indices, ", "));
    text += names.second.empty() ? ": nothing in the recording shows it"
                                 : " cannot be told from " + names.second;
    not_told.push_back(std::move(text));
  }
  AddWhatSpringsTakeUp(layout, weighed.hypothesis, not_told);
  return not_told;
}

std::vector<std::string> JointFindings(const Layout& layout, const diagnosis::Hypothesis& best,
                                       const Eigen::VectorXd& theta,
                                       const Eigen::MatrixXd& covariance) {
  const ArmData& data = layout.Recordings().front();
  std::vector<std::string> findings(data.Size());
  for (const int b : best.effects) {
    const Layout::Block& block = layout.Blocks()[b];
    for (const auto& p : Reported(layout, block, theta, covariance)) {
      if (int(p.value.size()) != data.Size() || p.name == "window") continue;
      for (int i = 0; i < data.Size(); ++i) {
        const double nominal = p.name == "scale" ? 1.0 : 0.0;
        const double tolerance =
            layout.Prior().Tolerances()[block.first + std::min(i, block.size - 1)];
        const double off = std::abs(p.value[i] - nominal);
        if (off < 3.0 * p.sd[i] || off < 3.0 * tolerance) continue;
        std::string& text = findings[i];
        if (!text.empty()) text += "; ";
        text += fmt::format("{} {} {:.4g}", block.effect->Name(), p.name, p.value[i]);
      }
    }
  }
  return findings;
}

std::vector<std::vector<std::string>> Alternatives(const Found& found, const Layout& layout) {
  std::vector<std::vector<std::string>> groups;
  const Scored& best = found.BestKnown();
  for (const int b : best.weighed.hypothesis.effects) {
    if (layout.Blocks()[b].change) continue;
    std::vector<std::string> group{layout.Blocks()[b].effect->Name()};
    for (const Scored& s : found.scored) {
      const auto& other = s.weighed.hypothesis;
      if (other.unknown || other.effects.size() != best.weighed.hypothesis.effects.size()) continue;
      if (s.log_posterior < best.log_posterior - kAsGood || Holds(other, b)) continue;
      int replaced = -1, differ = 0;
      for (const int e : other.effects)
        if (!Holds(best.weighed.hypothesis, e)) {
          replaced = e;
          ++differ;
        }
      if (differ != 1) continue;
      const std::string name = layout.Blocks()[replaced].effect->Name();
      if (std::find(group.begin(), group.end(), name) == group.end()) group.push_back(name);
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace flextip::arms
