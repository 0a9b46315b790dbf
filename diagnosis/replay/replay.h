// The replay: what the model with given parameters predicts for every sample of a recording, what
// is left of the measurements, and how that depends on the parameters.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <bitset>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "diagnosis/model/parameter_layout.h"
#include "diagnosis/replay/sensor_prediction.h"
#include "diagnosis/samples/retiming.h"

namespace flextip::diagnosis {

/// One sample after a replay.
struct ReplayedSample {
  bool ok = false;    ///< the rod has an equilibrium
  bool stale = true;  ///< is to be solved
  SolvedSample solved;
  SampleInputs inputs = SampleInputs::Zero();
  /// With a known load: the inputs and the force of `solved`.
  SampleInputs solved_inputs = SampleInputs::Zero();
  Eigen::Vector3d solved_f_tip_N = Eigen::Vector3d::Zero();
  std::vector<InputChange::Column> columns;  ///< of the inputs, by parameter
  Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();
  DiagnosisSample measured;  ///< what the sensors say of this time, latency taken off
  SampleResidual compared;
  /// Of the geometry, by the second, as it was last compared: a force is fitted to what sensors say
  /// of their own times.
  Geometry rate = Geometry::Zero(), bend = Geometry::Zero();
  double force_merit = 0.0;  ///< squared residual that an unknown force was fitted to
};

/// All samples' residuals with unit covariance, and their derivatives: measured - predicted =
/// e - X dtheta + noise. What wrist noise and the tip's force (unknown, or known with noise) may
/// explain is projected out by the covariance: variable projection with a prior.
struct WhitenedRows {
  Eigen::VectorXd e;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> X;
  std::vector<int> first_row;          ///< of each sample, and one past the last: samples + 1
  std::vector<std::vector<int>> rows;  ///< of each sample: which measured rows these are
  /// Of each sample: what an error of one standard deviation in each measured row becomes.
  std::vector<Eigen::MatrixXd> units;
  /// Of each sample: how many of its rows' noise the force takes up (0 to 3).
  std::vector<double> force_share;

  int Rows(std::size_t k) const { return first_row[k + 1] - first_row[k]; }
};

/// Samples from `begin` to before `end`; all where not said.
struct SampleRange {
  std::size_t begin = 0, end = std::numeric_limits<std::size_t>::max();
  bool Holds(std::size_t k) const { return k >= begin && k < end; }
};

class Replay {
 public:
  /// Both must outlive the replay.
  Replay(const SampleSet& samples, const ParameterLayout& layout);

  /// Predicts all samples with parameters `theta`. Unknown tip forces are fitted sample by sample,
  /// from where they were, to how the shaft moved in the replay before (the first time: not). False
  /// where more than a tenth of the samples have no equilibrium.
  bool Evaluate(const Eigen::VectorXd& theta);
  /// The same with the forces left as they are.
  bool EvaluateWithForces(const Eigen::VectorXd& theta);

  /// Moves unknown tip forces to where they will be, to first order, when the parameters move by
  /// `dtheta`.
  void PredictForces(const Eigen::VectorXd& dtheta);

  /// The tip forces the replay stands on, and back to others.
  std::vector<Eigen::Vector3d> Forces() const;
  void SetForces(const std::vector<Eigen::Vector3d>& forces_N);

  /// Where the replay stands, to come back to without solving anything.
  struct State {
    Eigen::VectorXd theta;
    std::vector<ReplayedSample> samples;
    int failed = 0;
  };
  State Save() const { return {theta_, replayed_, failed_}; }
  void Restore(const State& state) {
    theta_ = state.theta;
    replayed_ = state.samples;
    failed_ = state.failed;
  }

  /// Sets from where the replay stands, until the next call, what must be the same for all that is
  /// compared. Of an unknown force: how wide its prior along the shaft is, from how far the
  /// forces across it are from their mean. With a known load: how the noise of load and wrist
  /// enters the rows.
  void FixNoiseModel();

  /// Sets, until FixNoiseModel, how wide the prior of an unknown force along the shaft is, in units
  /// of EI / L^2.
  void SetAlongPrior(double units) { along_prior_ = units; }

  /// `sensors_used`: rows of absent sensors are left out, besides the absent ones.
  WhitenedRows Whiten(const std::bitset<row::kCount>& rows_used = AllRows()) const;

  /// Squared whitened residual over the rows, less those that an unknown force takes.
  double ChiSquaredPerDof() const;

  /// Per sample: the residual less what an unknown tip force explains, unwhitened; absent rows
  /// zero. With `hidden` rows, the force is found without them: their residual is a prediction
  /// error. `dtheta` moves the parameters, to first order; empty: not. Of samples outside `range`
  /// all rows are zero.
  std::vector<Rows> ForceFreeResiduals(const std::bitset<row::kCount>& hidden = {},
                                       const Eigen::VectorXd& dtheta = {},
                                       const SampleRange& range = {}) const;

  const Eigen::VectorXd& Theta() const { return theta_; }
  const std::vector<ReplayedSample>& Samples() const { return replayed_; }
  const SampleSet& Set() const { return samples_; }
  const ParameterLayout& Layout() const { return layout_; }
  int FailedSamples() const { return failed_; }
  /// Factors on the data sheets' noise, by channel; at least one.
  void SetNoiseScale(const std::array<double, kChannelCount>& scale) { noise_scale_ = scale; }
  const std::array<double, kChannelCount>& NoiseScales() const { return noise_scale_; }
  /// These samples do not enter Whiten.
  void LeaveOut(const std::vector<std::size_t>& samples);
  /// Derivatives by what scales the force (compliances, stiffness, gains) are those of the samples
  /// around, without the noise of a sample's own force; or the sample's own, as differences have
  /// them.
  void TakeOwnDerivatives(bool own) { own_derivatives_ = own; }
  /// Noise factors, what FixNoiseModel set and samples left out.
  struct Settings {
    std::array<double, kChannelCount> noise_scale{};
    double along_prior = 1.0;
    std::vector<Eigen::Matrix<double, row::kCount, 6>> input_noise = {};
    std::vector<bool> left_out = {};
  };
  Settings SettingsNow() const { return {noise_scale_, along_prior_, input_noise_, left_out_}; }
  void Use(const Settings& settings);
  /// As another replay of the same samples has them.
  void TakeSettings(const Replay& other) { Use(other.SettingsNow()); }

  /// Standard deviation of each row's own noise in sample `k` (the diagonal).
  Rows RowNoise(std::size_t k) const;

  static std::bitset<row::kCount> AllRows() { return std::bitset<row::kCount>().set(); }

 private:
  /// What wrist and force do to the rows when each is off by one standard deviation.
  using InputNoise = Eigen::Matrix<double, row::kCount, 6>;
  struct Statistics;  // covariance of a sample's rows and what the force has to do with them

  static bool IsSolved(const ReplayedSample& sample);
  bool Finish();
  double FreePortPlace(std::size_t k) const;
  double SmoothPortPlace(std::size_t k) const;
  double ApplyEffects(const Eigen::VectorXd& theta);
  bool EvaluateBy(const Eigen::VectorXd& theta, const std::function<void()>& solve);
  void SolveRods();
  void Retime();
  void FitForces();
  void BorrowForces();
  Eigen::Vector3d ShortStep(std::size_t k, const Eigen::Vector3d& step_N) const;
  void FitForce(std::size_t k, EffectRodSolver& solver);
  std::size_t NextAlike(std::size_t k, int step) const;
  bool LooksWrong(std::size_t k, std::size_t next) const;
  void FitBetter(std::size_t k, const Eigen::Vector3d& start_N, EffectRodSolver& solver);
  bool MendForce(std::size_t k);
  bool TryForce(std::size_t k, const Eigen::Vector3d& f_N, EffectRodSolver& solver);
  void CompareSamples();
  std::optional<std::size_t> FirstOfFive(std::size_t k) const;
  TimedGeometry WithRate(std::size_t k) const;
  double ForceUnit(std::size_t k) const;
  Eigen::Vector3d MeanForce(std::size_t k) const;
  template <class Get>
  auto Around(std::size_t k, Get get) const;
  GeometryByInputs ExpectedDerivatives(std::size_t k) const;
  Eigen::Vector4d ExpectedMoments(std::size_t k) const;
  Eigen::Matrix3d ForcePrior(std::size_t k) const;
  std::optional<Eigen::Vector3d> LoadNoise(std::size_t k) const;
  double ByInput(std::size_t k, int r, int input) const;
  Eigen::MatrixXd OwnCovariance(std::size_t k, const std::vector<int>& rows) const;
  Statistics StatisticsOf(std::size_t k, const std::bitset<row::kCount>& rows_used) const;
  Eigen::MatrixXd Derivatives(std::size_t k, const std::vector<int>& rows) const;
  InputNoise InputNoiseHere(std::size_t k) const;

  const SampleSet& samples_;
  const ParameterLayout& layout_;
  Retiming retiming_;
  double force_unit_N_;
  Eigen::VectorXd theta_;
  std::vector<ReplayedSample> replayed_;
  std::array<double, kChannelCount> noise_scale_;
  std::vector<InputNoise> input_noise_;  // with a known load, as it was fixed; empty: not yet
  std::vector<bool> left_out_;           // samples; empty: none
  double along_prior_;  // of an unknown force along the shaft, in units of EI / L^2
  int failed_ = 0;
  bool own_derivatives_ = false;
};

}  // namespace flextip::diagnosis
