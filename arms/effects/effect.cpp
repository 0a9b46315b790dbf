#include "arms/effects/effect.h"

#include <cmath>

#include "core/error.h"

namespace flextip::arms {

std::vector<ArmParameter> PlainEffect::Report(const ArmData& data, const Eigen::VectorXd& theta,
                                              const Eigen::MatrixXd& covariance) const {
  std::vector<ArmParameter> reported;
  Eigen::Index j = 0;
  for (const Named& named : Names(data)) {
    ArmParameter parameter{named.name, {}, {}};
    for (int i = 0; i < named.size; ++i, ++j) {
      parameter.value.push_back(named.nominal + theta[j]);
      parameter.sd.push_back(std::sqrt(std::max(0.0, covariance(j, j))));
    }
    reported.push_back(std::move(parameter));
  }
  return reported;
}

Eigen::VectorXd PlainEffect::FromReported(const ArmData& data,
                                          const std::vector<ArmParameter>& reported) const {
  std::vector<double> theta;
  for (const Named& named : Names(data)) {
    for (const double value : ListOf(Name(), reported, named.name, named.size))
      theta.push_back(value - named.nominal);
  }
  return Eigen::Map<Eigen::VectorXd>(theta.data(), Eigen::Index(theta.size()));
}

std::vector<double> ListOf(const std::string& effect, const std::vector<ArmParameter>& reported,
                           const std::string& name, int size) {
  std::vector<double> found;
  for (const ArmParameter& p : reported)
    if (p.name == name) found = p.value;
  if (int(found.size()) != size) {
    throw InputError(fmt::format("{}.{}: found {} numbers, expected {} for this arm", effect, name,
                                 found.size(), size));
  }
  return found;
}

std::vector<double> ToleranceOf(const ArmData& data, const std::string& key, double fallback,
                                int size) {
  const auto found = data.tolerances.find(key);
  if (found == data.tolerances.end()) return std::vector<double>(size, fallback);
  if (found->second.size() == 1) return std::vector<double>(size, found->second[0]);
  if (int(found->second.size()) == size) return found->second;
  throw InputError(fmt::format("{}: tolerances: {}: found {} numbers, expected 1 or {}", data.name,
                               key, found->second.size(), size));
}

std::vector<FitParameter> PerJoint(const ArmData& data, const std::string& key,
                                   const JointSizes& sizes) {
  std::vector<FitParameter> parameters;
  parameters.reserve(std::size_t(data.Size()));
  const bool own = data.tolerances.contains(key);
  const auto stated = ToleranceOf(data, key, 0.0, data.Size());
  for (int i = 0; i < data.Size(); ++i) {
    parameters.push_back(
        {own ? stated[i] : data.TypicalOf(i, sizes.tolerance_rad, sizes.tolerance_m),
         data.TypicalOf(i, sizes.typical_rad, sizes.typical_m), sizes.positive});
  }
  return parameters;
}

Entry OffDiagonal(int size, int m) {
  const int row = m / (size - 1), column = m % (size - 1);
  return {row, column < row ? column : column + 1};
}

double UnitRatio(const ArmData& data, int i, int j) {
  const double to = data.TypicalOf(i, 1.0, 0.3), from = data.TypicalOf(j, 1.0, 0.3);
  return to / from;
}

}  // namespace flextip::arms
