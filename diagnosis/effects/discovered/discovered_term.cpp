#include "diagnosis/effects/discovered/discovered_term.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flextip::diagnosis {
namespace {

constexpr double kDifference = 1e-4;  // of a parameter's deviation

double TypicalOf(const Eigen::MatrixXd& values) {
  const double count = std::max<double>(1.0, double(values.size()));
  return std::max(1e-12, values.norm() / std::sqrt(count));
}

}  // namespace

std::vector<int> RefinedAt(const Term& term) {
  switch (term.shape) {
    case TermShape::kPeriodic:
    case TermShape::kStep:
    case TermShape::kBeyond:
    case TermShape::kBelow:
    case TermShape::kBand:
    case TermShape::kTanh:
    case TermShape::kExponential:
    case TermShape::kAfter:
      return {0};
    case TermShape::kInversePower:
      return {0, 1, 2};
    default:
      return {};
  }
}

DiscoveredTerm::DiscoveredTerm(Term term, std::string name, std::vector<double> at_sd)
    : term_(std::move(term)),
      name_(std::move(name)),
      refined_(at_sd.empty() ? std::vector<int>{} : RefinedAt(term_)),
      at_sd_(std::move(at_sd)) {}

std::vector<FitParameter> DiscoveredTerm::Parameters(const SampleSet&) const {
  std::vector<FitParameter> all;
  const double amplitude = TypicalOf(term_.amplitude), offset = TypicalOf(term_.offset);
  for (Eigen::Index i = 0; i < AmplitudeSize(); ++i) all.push_back({0.0, amplitude, false});
  for (Eigen::Index i = 0; i < term_.offset.size(); ++i) all.push_back({0.0, offset, false});
  for (std::size_t i = 0; i < refined_.size(); ++i) all.push_back({at_sd_[i], at_sd_[i], false});
  return all;
}

bool DiscoveredTerm::NeedsPortPlace() const {
  switch (term_.variable) {
    case TermVariable::kTime:
    case TermVariable::kInsertionDepth:
    case TermVariable::kSlidingVelocity:
    case TermVariable::kWristSpeed:
    case TermVariable::kLoad:
      return term_.shape == TermShape::kInversePower;
    default:
      return true;
  }
}

void DiscoveredTerm::AddShapeDerivatives(const Term& at, const double* theta,
                                         const TermState& state, InputChange& change) const {
  const TermTargetInfo& info = InfoOf(at.target);
  for (std::size_t r = 0; r < refined_.size(); ++r) {
    Term moved = at;
    double& value = moved.at[static_cast<std::size_t>(refined_[r])];
    const double centre = value, h = kDifference * at_sd_[r];
    if (h <= 0.0) continue;
    EffectMemory none{};
    value = centre + h;
    const TermColumns plus = ColumnsAt(moved, state, none);
    value = centre - h;
    const TermColumns by = (plus - ColumnsAt(moved, state, none)) / (2.0 * h);
    const int parameter =
        static_cast<int>(AmplitudeSize() + term_.offset.size()) + static_cast<int>(r);
    for (int i = 0; i < info.inputs; ++i) {
      double sum = 0.0;
      for (Eigen::Index j = 0; j < by.cols(); ++j) sum += theta[j * info.inputs + i] * by(i, j);
      change.Derivative(parameter, info.first_input + i, info.sign * sum);
    }
  }
}

void DiscoveredTerm::Apply(const double* theta, const Instant& now, EffectMemory& memory,
                           InputChange& change) const {
  const TermTargetInfo& info = InfoOf(term_.target);
  const Eigen::Index first_offset = AmplitudeSize(), first_at = first_offset + term_.offset.size();
  const TermState state = StateAt(term_.target, now, memory);
  Term moved;
  const Term* at = &term_;
  for (std::size_t r = 0; r < refined_.size(); ++r) {
    if (theta[first_at + Eigen::Index(r)] == 0.0) continue;
    if (at == &term_) moved = term_;
    at = &moved;
    moved.at[static_cast<std::size_t>(refined_[r])] += theta[first_at + Eigen::Index(r)];
  }
  const TermColumns columns = ColumnsAt(*at, state, memory);
  for (int i = 0; i < info.inputs; ++i) {
    const int input = info.first_input + i;
    for (Eigen::Index j = 0; j < columns.cols(); ++j)
      change.Linear(int(j) * info.inputs + i, input, info.sign * columns(i, j));
    if (term_.offset.size() > 0) change.Linear(int(first_offset) + i, input, info.sign);
  }
  AddShapeDerivatives(*at, theta, state, change);
}

Eigen::VectorXd DiscoveredTerm::Theta() const {
  Eigen::VectorXd theta =
      Eigen::VectorXd::Zero(AmplitudeSize() + term_.offset.size() + Eigen::Index(refined_.size()));
  theta.head(AmplitudeSize()) = term_.amplitude.reshaped();
  theta.segment(AmplitudeSize(), term_.offset.size()) = term_.offset;
  return theta;
}

Term DiscoveredTerm::With(const Eigen::VectorXd& theta) const {
  Term term = term_;
  term.amplitude.reshaped() = theta.head(AmplitudeSize());
  term.offset = theta.segment(AmplitudeSize(), term_.offset.size());
  for (std::size_t r = 0; r < refined_.size(); ++r)
    term.at[static_cast<std::size_t>(refined_[r])] +=
        theta[AmplitudeSize() + term_.offset.size() + Eigen::Index(r)];
  return term;
}

std::vector<ReportedParameter> DiscoveredTerm::Report(const Eigen::VectorXd& theta,
                                                      const Eigen::MatrixXd& covariance) const {
  std::vector<ReportedParameter> reported{
      {"amplitude", {}, {}}, {"offset", {}, {}}, {"at", {}, {}}};
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    const Eigen::Index offsets = AmplitudeSize() + term_.offset.size();
    ReportedParameter& of = reported[i < AmplitudeSize() ? 0 : i < offsets ? 1 : 2];
    of.value.push_back(theta[i]);
    of.sd.push_back(std::sqrt(std::max(0.0, covariance(i, i))));
  }
  return reported;
}

Eigen::VectorXd DiscoveredTerm::FromReported(const std::vector<std::vector<double>>& values) const {
  std::vector<double> all;
  for (const auto& list : values) all.insert(all.end(), list.begin(), list.end());
  return Eigen::Map<Eigen::VectorXd>(all.data(), Eigen::Index(all.size()));
}

}  // namespace flextip::diagnosis
