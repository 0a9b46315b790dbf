#include "calibration/shaft/strain_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/median.h"

namespace flextip {
namespace {

constexpr int kRounds = 8;             // of noise and outliers
constexpr double kFar = 27.9;          // chi2 of four that one honest hold in 75 000 exceeds
constexpr double kKnown = 0.1;         // of the typical gain, and offset of the typical reading
constexpr double kMedianChi2 = 3.357;  // of four
constexpr const char* kChannels[] = {"m1_y", "m1_z", "m2_y", "m2_z"};

void CheckStreams(const Recording& recording, const std::string& source) {
  const auto need = [&](bool is, const char* what) {
    if (!is) throw InputError::At(source, 0, fmt::format("no {}, which strain gages need", what));
  };
  need(recording.strain0.has_value(), "strain0");
  need(recording.load0.has_value(), "load0 (known loads)");
  need(recording.wrist0.has_value(), "wrist0");
}

/// The noise of single readings from their scatter within holds; empty where there is none.
std::optional<Eigen::Vector4d> ScatterWithin(const std::vector<LoadHold>& holds) {
  Eigen::Vector4d squares = Eigen::Vector4d::Zero();
  int freedoms = 0;
  for (const LoadHold& hold : holds) {
    if (!hold.readings) continue;
    squares += hold.reading_squares;
    freedoms += hold.samples - 1;
  }
  if (freedoms < 20 || (squares.array() <= 0).any()) return {};
  return Eigen::Vector4d((squares / freedoms).cwiseSqrt());
}

/// The work on one recording.
class StrainWork {
 public:
  StrainWork(const Recording& recording, const StrainCalibrationOptions& options)
      : options_(options),
        p_RP_(recording.p_RP),
        model_(recording.instrument, recording.p_RP, recording.gravity_m_s2,
               recording.strain0->station_from_wrist_m) {
    const auto holds = LoadHolds(recording, LoadClock::kStrain, options.most_holds);
    stated_noise_ = std::max(recording.strain0->moment_noise_Nm, 1e-12);
    scatter_ = ScatterWithin(holds);
    for (const LoadHold& hold : holds) AddHold(hold);
  }
  std::size_t Usable() const { return samples_.size(); }
  StrainCalibration Run();

 private:
  void AddHold(const LoadHold& hold);
  void SetReadingNoise(const Eigen::Vector4d& of_one);
  void FitWithoutOutliers();
  void RescaleNoise();
  std::vector<double> Chi2s(bool used_only) const;
  std::string WhyFar(std::size_t i) const;
  void JudgeColumns();
  std::string WhyUnknown(const std::vector<int>& columns);
  void Fill();
  void FillCovariance();
  double HeldoutRms() const;

  StrainCalibrationOptions options_;
  Eigen::Vector3d p_RP_;
  MomentModel model_;
  double stated_noise_ = 0.0;
  std::optional<Eigen::Vector4d> scatter_;
  std::vector<GageSample> samples_;
  std::vector<StatedMoments> stated_;
  std::vector<std::size_t> hold_of_;  // of each sample, in result_.holds
  GageFit fit_;
  StrainCalibration result_;
};

void StrainWork::AddHold(const LoadHold& hold) {
  StrainHoldResult out;
  out.hold = hold;
  const auto stated = hold.readings ? model_.At(hold) : std::nullopt;
  if (!hold.readings) {
    out.reason = "strain0 has gaps";
  } else if (!hold.R_RW) {
    out.reason = "the wrist's orientation was not measured";
  } else if (!stated) {
    out.reason = "the rod has no equilibrium under this load";
  } else {
    GageSample sample;
    sample.readings = *hold.readings;
    sample.m_Nm = stated->m_Nm;
    sample.m_covariance = stated->Covariance(hold);
    sample.m_by_port = stated->by_port;
    out.m_stated_Nm = stated->m_Nm;
    out.s_port_m = stated->s_port_m;
    out.used = true;
    hold_of_.push_back(result_.holds.size());
    samples_.push_back(sample);
    stated_.push_back(*stated);
  }
  result_.holds.push_back(std::move(out));
}

void StrainWork::SetReadingNoise(const Eigen::Vector4d& of_one) {
  result_.reading_noise = of_one;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    samples_[i].reading_sd = of_one / std::sqrt(result_.holds[hold_of_[i]].hold.samples);
  }
}

std::vector<double> StrainWork::Chi2s(bool used_only) const {
  std::vector<double> all;
  for (const GageSample& s : samples_) {
    if (!used_only || s.weight > 0) all.push_back(ResidualOf(s, fit_).Chi2());
  }
  return all;
}

/// Without scatter within holds the noise is what the fit leaves, channel by channel.
void StrainWork::RescaleNoise() {
  Eigen::Vector4d ratio;
  for (int k = 0; k < 4; ++k) {
    std::vector<double> squares;
    for (const GageSample& s : samples_) {
      const GageResidual r = ResidualOf(s, fit_);
      squares.push_back(r.readings[k] * r.readings[k] / r.covariance(k, k));
    }
    ratio[k] = Median(squares) / 0.455;  // the median of chi2 of one
  }
  SetReadingNoise(result_.reading_noise.cwiseProduct(ratio.cwiseSqrt().cwiseMax(0.1)));
}

/// Holds first count the less the further off they are, then those far off are left out.
void StrainWork::FitWithoutOutliers() {
  SetReadingNoise(scatter_.value_or(Eigen::Vector4d::Constant(stated_noise_)));
  for (int round = 0; round < kRounds; ++round) {
    fit_ = FitGages(samples_, options_.fit);
    if (!scatter_) RescaleNoise();
    const double scale = std::max(1.0, Median(Chi2s(false)) / kMedianChi2);
    const bool last = round + 1 == kRounds;
    for (GageSample& s : samples_) {
      const double chi2 = ResidualOf(s, fit_).Chi2() / scale;
      const double gentle = std::min(1.0, 9.5 / std::max(chi2, 1e-9));
      s.weight = chi2 > kFar && round > 2 ? 0.0 : (round > 2 || last ? 1.0 : gentle);
    }
  }
  fit_ = FitGages(samples_, options_.fit);
}

std::string StrainWork::WhyFar(std::size_t i) const {
  const GageResidual r = ResidualOf(samples_[i], fit_);
  int worst = 0;
  const Eigen::Vector4d sds = r.readings.cwiseQuotient(r.covariance.diagonal().cwiseSqrt());
  sds.cwiseAbs().maxCoeff(&worst);
  std::string why =
      fmt::format("{} reads {:.1f} standard deviations off", kChannels[worst], sds[worst]);
  if (!result_.gages_known || samples_[i].m_Nm.norm() == 0) return why;
  // Whether another mass at the same place explains it.
  const Eigen::Vector4d at = fit_.gains * samples_[i].m_Nm;
  const Eigen::Vector4d read = samples_[i].readings - fit_.offset;
  const Eigen::Vector4d weighted = Ldlt(r.covariance).Solve(at);
  const double factor = weighted.dot(read) / weighted.dot(at);
  const Eigen::Vector4d left = read - factor * at;
  if (left.dot(Ldlt(r.covariance).Solve(left)) < kFar) {
    why += fmt::format("; it reads as if the load were {:.2f} times what is stated", factor);
  }
  return why;
}

std::string StrainWork::WhyUnknown(const std::vector<int>& columns) {
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  double least = 1e300, most = 0, force_N = 0;
  for (const std::size_t i : hold_of_) {
    const LoadHold& hold = result_.holds[i].hold;
    const Eigen::Vector2d across = (hold.R_RW->transpose() * hold.f_tip_N).tail<2>();
    spread += across * across.transpose();
    force_N = std::max(force_N, hold.f_tip_N.norm());
    if (hold.IsUnloaded()) continue;
    least = std::min(least, result_.holds[i].s_port_m);
    most = std::max(most, result_.holds[i].s_port_m);
  }
  std::string names;
  for (const int c : columns) names += (names.empty() ? "" : ", ") + std::string(kChannels[c]);
  const std::string head = fmt::format("what the gages read of {} is not known: ", names);
  const Eigen::Vector2d axes = SymmetricEigenvalues(spread);
  if (axes[1] <= 0) return head + "nothing hangs on the tip across the shaft";
  if (axes[0] < 0.02 * axes[1]) {
    return head +
           "all loads bend the shaft about one axis; hang a mass across it too, or turn the "
           "instrument by 90 degrees about its shaft";
  }
  if (most - least < 0.1 * most) {
    result_.insertions_alike = true;
    return head + fmt::format(
                      "all loads hang with the port at {:.3f} to {:.3f} m along the shaft, "
                      "where the moments of both stations rise together; load at other "
                      "insertions too, or take the stations as apart",
                      least, most);
  }
  return head +
         fmt::format("the loads, {:.3g} N at most, are too small against the noise", force_N);
}

void StrainWork::JudgeColumns() {
  const Eigen::VectorXd variance = fit_.covariance.diagonal();
  std::vector<int> unknown;
  double typical_moment = 0;
  for (const GageSample& s : samples_) {
    typical_moment = std::max(typical_moment, s.m_Nm.cwiseAbs().maxCoeff());
  }
  const double scale = std::sqrt(std::max(1.0, result_.chi2_per_dof));
  Eigen::Vector4d typical = fit_.gains.rowwise().norm();
  for (int column = 0; column < 4; ++column) {
    bool known = typical.minCoeff() > 0;
    for (int row = 0; row < 4; ++row) {
      const double sd = std::sqrt(variance[4 * row + column]);
      result_.gain_sd(row, column) = scale * sd;
      known = known && scale * sd < kKnown * typical[row];
    }
    if (!known) unknown.push_back(column);
  }
  result_.offset_known = true;
  for (int row = 0; row < 4; ++row) {
    const double sd = scale * std::sqrt(variance[kGageOffset + row]);
    if (!(sd < kKnown * typical[row] * typical_moment)) result_.offset_known = false;
  }
  result_.gages_known = unknown.empty() && FullLu(fit_.gains).IsInvertible();
  auto& list = result_.found.unobservable;
  if (!result_.gages_known) list.push_back({"strain0.gage_matrix", WhyUnknown(unknown)});
  if (!result_.offset_known) {
    list.push_back({"strain0.offset_Nm",
                    "no hold is without load, and the loads pull too much alike for the reading "
                    "without load to follow from them; record the unloaded shaft too"});
  }
}

/// Of the matrix (its inverse's rows) and the offset, from that of gains and offset.
void StrainWork::FillCovariance() {
  const bool both = result_.gages_known && result_.offset_known;
  const Eigen::Matrix4d& M = result_.gage_matrix;
  // In alphabetical order of the names: gage_matrix, moment_noise_Nm, offset_Nm.
  const int matrix = result_.gages_known ? 17 : 0, offset = result_.offset_known ? 4 : 0;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(matrix + offset, 20);
  if (result_.gages_known) {  // dM = -M dA M
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c)
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 4; ++j) J(4 * r + c, 4 * i + j) = -M(r, i) * M(j, c);
  }
  if (result_.offset_known) J.block<4, 4>(matrix, kGageOffset).setIdentity();
  const double scale = std::max(1.0, result_.chi2_per_dof);
  Eigen::MatrixXd C = scale * J * fit_.covariance.topLeftCorner<20, 20>() * J.transpose();
  if (result_.gages_known) {
    double readings = 0;
    for (const GageSample& s : samples_) readings += 4 * (s.weight > 0);
    C(16, 16) = std::pow(result_.moment_noise_Nm, 2) / (2 * readings);
  }
  if (both || matrix + offset > 0) result_.found.covariance = 0.5 * (C + C.transpose());
}

void StrainWork::Fill() {
  const auto used = Chi2s(true);
  double chi2 = 0;
  for (const double c : used) chi2 += c;
  const double freedoms = 4.0 * static_cast<double>(used.size()) - 20;
  result_.chi2_per_dof = freedoms > 0 ? chi2 / freedoms : 1.0;
  JudgeColumns();
  result_.gains = fit_.gains;
  result_.offset = fit_.offset;
  auto& numbers = result_.found.numbers;
  result_.found.kind = "strain";
  if (result_.offset_known) {
    numbers["strain0.offset_Nm"] = {fit_.offset.data(), fit_.offset.data() + 4};
  }
  if (result_.gages_known) {
    result_.gage_matrix = fit_.gains.inverse();
    const Eigen::Matrix4d rows = result_.gage_matrix.transpose();
    numbers["strain0.gage_matrix"] = {rows.data(), rows.data() + 16};
    const Eigen::Matrix4d noise = result_.gage_matrix * result_.reading_noise.asDiagonal();
    result_.moment_noise_Nm = noise.norm() / 2;
    numbers["strain0.moment_noise_Nm"] = {result_.moment_noise_Nm};
  }
  FillCovariance();
}

double StrainWork::HeldoutRms() const {
  constexpr std::size_t kFolds = 5;
  double squares = 0, count = 0;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<GageSample> rest = samples_;
    for (std::size_t i = fold; i < rest.size(); i += kFolds) rest[i].weight = 0;
    const GageFit fit = FitGages(rest, options_.fit);
    const FullLu lu(fit.gains);
    if (!lu.IsInvertible()) continue;
    for (std::size_t i = fold; i < rest.size(); i += kFolds) {
      if (samples_[i].weight == 0) continue;
      squares += (lu.Solve(samples_[i].readings - fit.offset) - samples_[i].m_Nm).squaredNorm();
      count += 4;
    }
  }
  return count > 0 ? std::sqrt(squares / count) : 0;
}

StrainCalibration StrainWork::Run() {
  FitWithoutOutliers();
  Fill();
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    StrainHoldResult& hold = result_.holds[hold_of_[i]];
    hold.chi2 = ResidualOf(samples_[i], fit_).Chi2();
    hold.used = samples_[i].weight > 0;
    if (!hold.used) hold.reason = WhyFar(i);
    result_.largest_moment_Nm =
        std::max(result_.largest_moment_Nm, samples_[i].m_Nm.cwiseAbs().maxCoeff());
    if (!result_.gages_known) continue;
    hold.m_measured_Nm = result_.gage_matrix * (samples_[i].readings - fit_.offset);
    if (!hold.used) continue;
    squares += (hold.m_measured_Nm - hold.m_stated_Nm).squaredNorm();
    count += 4;
  }
  if (count > 0) result_.rms_Nm = std::sqrt(squares / count);
  if (result_.gages_known) result_.heldout_rms_Nm = HeldoutRms();
  Eigen::Vector4d typical = Eigen::Vector4d::Zero();
  for (const GageSample& s : samples_) typical += s.reading_sd / static_cast<double>(Usable());
  result_.advice = NextStrainLoad(result_.holds, fit_, typical, p_RP_, model_);
  return std::move(result_);
}

}  // namespace

StrainCalibration CalibrateStrain(const Recording& recording, const std::string& source,
                                  const StrainCalibrationOptions& options) {
  CheckStreams(recording, source);
  StrainWork work(recording, options);
  if (work.Usable() < 3) {
    throw InputError::At(source, 0,
                         fmt::format("found {} loads with readings, wrist and an equilibrium, "
                                     "expected at least 3",
                                     work.Usable()));
  }
  return work.Run();
}

}  // namespace flextip
