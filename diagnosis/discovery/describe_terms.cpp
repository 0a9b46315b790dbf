#include "diagnosis/discovery/describe_terms.h"

#include <algorithm>
#include <utility>

#include "diagnosis/effects/discovered/discovered_term.h"
#include "diagnosis/effects/discovered/term_text.h"
#include "diagnosis/heldout.h"
#include "diagnosis/model/geometry.h"

namespace flextip::diagnosis {
namespace {

TermRegion RegionOf(const Term& term, const Replay& replay) {
  const std::vector<TermState> states = StatesOf(replay, term.target);
  std::vector<double> size;
  EffectMemory memory{};
  for (const TermState& state : states) {
    const TermColumns columns = ColumnsAt(term, state, memory);
    Eigen::VectorXd by =
        term.offset.size() > 0 ? term.offset : Eigen::VectorXd::Zero(term.Inputs());
    for (Eigen::Index i = 0; i < by.size(); ++i)
      for (Eigen::Index j = 0; j < columns.cols(); ++j)
        by[i] += term.amplitude(i, j) * columns(i, j);
    size.push_back(by.norm());
  }
  TermRegion region;
  region.largest = *std::max_element(size.begin(), size.end());
  region.depth_low_m = 1e9, region.depth_high_m = -1e9;
  region.p_RE_low.setConstant(1e9);
  region.p_RE_high.setConstant(-1e9);
  for (std::size_t k = 0; k < size.size(); ++k) {
    if (size[k] < 0.5 * region.largest) continue;
    region.part += 1.0 / double(size.size());
    region.depth_low_m = std::min(region.depth_low_m, states[k].scalar[1]);
    region.depth_high_m = std::max(region.depth_high_m, states[k].scalar[1]);
    const Eigen::Vector3d p = replay.Samples()[k].solved.at.segment<3>(place::kTip);
    if (!replay.Samples()[k].ok) continue;
    region.p_RE_low = region.p_RE_low.cwiseMin(p);
    region.p_RE_high = region.p_RE_high.cwiseMax(p);
  }
  return region;
}

/// Of what a sample says in the mean: one that says less of the target would show its noise alone.
constexpr double kLeastSaid = 0.1;

/// What the term's variable is on the picture's axis.
double AxisOf(const Term& term, const TermState& state, Eigen::Index input) {
  switch (term.variable) {
    case TermVariable::kOwnValue:
      return state.own[input];
    case TermVariable::kPosition:
      if (term.shape == TermShape::kInversePower)
        return (state.position - Eigen::Vector3d(term.at[0], term.at[1], term.at[2])).norm();
      if (term.shape == TermShape::kPastPlane)
        return Eigen::Vector3d(term.at[0], term.at[1], term.at[2]).normalized().dot(state.position);
      return state.position[std::min<Eigen::Index>(input, 2)];
    case TermVariable::kOrientation:
      return state.orientation[std::min<Eigen::Index>(input, 2)];
    case TermVariable::kImagePosition:
      return state.image[std::min<Eigen::Index>(input, 1)];
    default:
      return state.scalar[static_cast<std::size_t>(term.variable)];
  }
}

TermPicture PictureOf(const Term& term, const Replay& replay) {
  const ResidualProblem problem(replay, replay.Layout().Tolerances(), 1);
  const std::vector<TermState> states = StatesOf(replay, term.target);
  Eigen::VectorXd direction = DirectionOf(term);
  Eigen::Index main = 0;
  direction.cwiseAbs().maxCoeff(&main);
  if (term.IsByInput()) direction = Eigen::VectorXd::Unit(term.Inputs(), main);
  const Eigen::VectorXd by = problem.ByTarget(term.target) * direction;
  const Eigen::VectorXd left = problem.LeftHere();
  const double typical = by.squaredNorm() / double(std::max<std::size_t>(1, states.size()));
  TermPicture picture;
  EffectMemory memory{};
  for (std::size_t k = 0; k < states.size(); ++k) {
    const TermColumns columns = ColumnsAt(term, states[k], memory);
    const int first = problem.FirstRowOfSample(k), count = problem.FirstRowOfSample(k + 1) - first;
    const double squares = by.segment(first, count).squaredNorm();
    if (count == 0 || !(squares > kLeastSaid * typical)) continue;
    double value = term.offset.size() > 0 ? direction.dot(term.offset) : 0.0;
    for (Eigen::Index i = 0; i < direction.size(); ++i)
      value += direction[i] * term.amplitude.row(i).dot(columns.row(i));
    picture.variable.push_back(AxisOf(term, states[k], main));
    picture.term.push_back(value);
    picture.measured.push_back(value +
                               by.segment(first, count).dot(left.segment(first, count)) / squares);
  }
  return picture;
}

std::vector<TermName> NamesOf(const std::vector<Candidate>& rivals) {
  std::vector<TermName> names;
  names.reserve(rivals.size());
  for (const Candidate& rival : rivals) names.push_back(NameOf(rival.term));
  return names;
}

}  // namespace

TermName NameOf(const Term& term) {
  TermName name{InfoOf(term.target).channel, {}, Name(FormOf(term))};
  for (const TermVariable variable : DependsOn(term)) name.depends_on.emplace_back(Name(variable));
  return name;
}

std::vector<Discovered> DescribeTerms(const TermModel& model, bool measure_gain) {
  const Evidence evidence(model.selection.problem.total, model.layout, model.selection.generic_sd,
                          {.unknown_sd = {}});
  const Eigen::MatrixXd covariance = evidence.Covariance(model.weighed);
  std::vector<Discovered> all;
  for (std::size_t i = 0; i < model.found.size(); ++i) {
    const int block_index = model.first_term + int(i);
    const auto& block = model.layout.Blocks()[block_index];
    const auto& effect = static_cast<const DiscoveredTerm&>(*block.effect);
    Discovered one;
    one.term = effect.With(model.extended.Theta().segment(block.first, block.size));
    one.name = NameOf(one.term);
    one.frame = InfoOf(one.term.target).frame;
    one.direction = DirectionOf(one.term);
    one.parameters =
        TermParameters(one.term, covariance.block(block.first, block.first, block.size, block.size),
                       model.found[i].at_sd);
    one.text = TextOf(one.term);
    one.false_discovery = model.found[i].false_discovery;
    one.stability = model.found[i].stability;
    one.could_be = NamesOf(model.found[i].rivals);
    one.region = RegionOf(one.term, model.extended);
    one.picture = PictureOf(one.term, model.extended);
    if (measure_gain) {
      Hypothesis rest = model.weighed.hypothesis;
      std::erase(rest.effects, block_index);
      const HeldOut with =
          MeasureHeldOut(model.base, model.extended, model.selection, model.weighed);
      const HeldOut without =
          MeasureHeldOut(model.base, model.extended, model.selection, evidence.Weigh(rest));
      one.gain.measured = with.gain.measured && without.extended.weighted_rms > 0.0;
      if (one.gain.measured)
        one.gain.heldout_error_ratio = with.extended.weighted_rms / without.extended.weighted_rms;
      if (without.extended.tip_prediction_rms_m > 0.0)
        one.gain.tip_error_ratio =
            with.extended.tip_prediction_rms_m / without.extended.tip_prediction_rms_m;
    }
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace flextip::diagnosis
