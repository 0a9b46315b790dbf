// Derivatives of the replay's residuals against differences.
#include "diagnosis/replay/replay.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

/// All samples' rows in standard deviations; absent ones zero.
Eigen::VectorXd Residuals(const Replay& replay) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(row::kCount * Eigen::Index(replay.Samples().size()));
  for (std::size_t k = 0; k < replay.Samples().size(); ++k) {
    const Rows sd = replay.RowNoise(k);
    for (int r = 0; r < row::kCount; ++r)
      if (replay.Set().samples[k].present[r])
        all[row::kCount * Eigen::Index(k) + r] = replay.Samples()[k].compared.residual[r] / sd[r];
  }
  return all;
}

/// What the whitened X says of Residuals' derivative (its negative): units is L^-1 times the rows'
/// standard deviations, X is L^-1 times the derivative.
Eigen::MatrixXd Derivatives(const Replay& replay) {
  const WhitenedRows rows = replay.Whiten();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(row::kCount * Eigen::Index(replay.Samples().size()),
                                              replay.Layout().Size());
  for (std::size_t k = 0; k < replay.Samples().size(); ++k) {
    const Eigen::MatrixXd X = rows.X.middleRows(rows.first_row[k], rows.Rows(k));
    const Eigen::MatrixXd D = rows.units[k].triangularView<Eigen::Lower>().solve(X);
    for (int i = 0; i < rows.Rows(k); ++i)
      all.row(row::kCount * Eigen::Index(k) + rows.rows[k][i]) = D.row(i);
  }
  return all;
}

class ReplayDerivatives : public testing::TestWithParam<bool> {
 protected:
  ReplayDerivatives()
      : samples_(ThirdOf(SmallSamples(4.2, GetParam(), 41, {}, true))),
        layout_(samples_, MakeCatalogue(samples_)),
        replay_(samples_, layout_),
        theta_(Eigen::VectorXd::Zero(layout_.Size())) {}

  /// Every third sample, for time's sake, with frames that are not well registered.
  static SampleSet ThirdOf(SampleSet samples) {
    std::vector<DiagnosisSample> third;
    for (std::size_t k = 0; k < samples.samples.size(); k += 3) third.push_back(samples.samples[k]);
    samples.samples = third;
    samples.period_s *= 3.0;
    samples.noise.em_registration_m = samples.noise.vision_registration_m = 0.002;
    samples.noise.em_registration_rad = samples.noise.vision_registration_rad = 0.01;
    return samples;
  }

  /// The block's parameters, of alternating signs where they may be negative.
  void SwitchOn(const std::string& effect, double share_of_typical) {
    const auto& block = layout_.Blocks()[layout_.Find(effect)];
    for (int j = block.first; j < block.first + block.size; ++j) {
      const FitParameter& p = layout_.Parameter(j);
      theta_[j] = share_of_typical * p.typical * (p.positive || j % 2 == 0 ? 1.0 : -0.7);
    }
  }
  /// Forces are fitted here, and then stay.
  void Evaluate() {
    replay_.TakeOwnDerivatives(true);
    ASSERT_TRUE(replay_.Evaluate(theta_));
    forces_N_ = replay_.Forces();
    At(theta_);
  }
  /// An unknown force counts in units of EI / L^2: a stiffer shaft's is as much larger.
  Eigen::VectorXd At(const Eigen::VectorXd& theta, int passes = 2) {
    const int j = Index("stiffness");
    const double stiffer = samples_.has_load ? 1.0 : std::exp(theta[j] - theta_[j]);
    auto forces_N = forces_N_;
    for (Eigen::Vector3d& f : forces_N) f *= stiffer;
    // A force stays as far from its mean as it was.
    for (std::size_t k = 0; k < forces_N.size(); ++k)
      for (const auto& column : replay_.Samples()[k].columns)
        if (const int axis = column.input - sample_input::kForce; axis >= 0 && axis < 3)
          forces_N[k][axis] += column.value * (theta - theta_)[column.parameter];
    replay_.SetForces(forces_N);
    for (int i = 0; i < passes; ++i) EXPECT_TRUE(replay_.EvaluateWithForces(theta));
    EXPECT_EQ(replay_.FailedSamples(), 0);
    return Residuals(replay_);
  }
  Eigen::VectorXd Difference(int j, double h) {
    const Eigen::VectorXd e = h * Eigen::VectorXd::Unit(layout_.Size(), j);
    // Friction takes a second pass: where the port would be without comes from the one before.
    const int passes = NameOf(j).starts_with("port_friction") ? 2 : 1;
    return (At(theta_ + e, passes) - At(theta_ - e, passes)) / (2.0 * h);
  }
  /// By central differences of second order, extrapolated where that matters.
  Eigen::VectorXd Numeric(int j) {
    const double h = 0.02 * layout_.Parameter(j).typical;
    return (4.0 * Difference(j, 0.5 * h) - Difference(j, h)) / 3.0;
  }

  std::string NameOf(int j) const {
    for (const auto& block : layout_.Blocks())
      if (j >= block.first && j < block.first + block.size)
        return block.effect->Name() + '[' + std::to_string(j - block.first) + ']';
    return "";
  }
  /// Every parameter's column against differences, about the point as it is, to `tolerance` of the
  /// column's norm.
  void CheckAll(double tolerance = 1e-5) {
    Evaluate();
    const Eigen::MatrixXd X = Derivatives(replay_);
    for (int j = 0; j < layout_.Size(); ++j) {
      const Eigen::VectorXd numeric = -Numeric(j);
      const std::string name = NameOf(j);
      if (IsOfNothing(name)) {
        EXPECT_EQ(numeric.norm() + X.col(j).norm(), 0.0);
        continue;
      }
      if (name.starts_with("backlash[") && name != "backlash[0]") continue;  // dragged too soon
      EXPECT_GT(numeric.norm(), 0.0) << name;
      // Of a wave of centimetres more is left out than of others.
      const double wave = tolerance > 0.01 && name.starts_with("encoder_eccentricity") ? 2.0 : 1.0;
      EXPECT_LT((X.col(j) - numeric).norm(), wave * tolerance * numeric.norm())
          << name << ": " << (X.col(j) - numeric).norm() / numeric.norm();
    }
  }
  /// The frequency of an oscillation that is not there.
  bool IsOfNothing(const std::string& name) const {
    for (const std::string frequency :
         {"port_motion[12]", "encoder_eccentricity[2]", "em_interference[6]"}) {
      const int first = Index(frequency.substr(0, frequency.find('[')));
      if (name == frequency && theta_[first] == 0.0) return true;
    }
    return false;
  }
  int Index(const std::string& effect) const {
    return layout_.Blocks()[layout_.Find(effect)].first;
  }

  SampleSet samples_;
  ParameterLayout layout_;
  Replay replay_;
  Eigen::VectorXd theta_;
  std::vector<Eigen::Vector3d> forces_N_;
};

TEST_P(ReplayDerivatives, OfAllParametersAtTheBase) {
  // Without a load cell its scale and mounting are not there, but the mean load is.
  ASSERT_EQ(layout_.EffectCount(), samples_.has_load ? 32 : 30);
  ASSERT_EQ(layout_.Blocks().size(), samples_.has_load ? 33U : 32U);
  CheckAll();
}

TEST_P(ReplayDerivatives, OfAllParametersAmongEffectsOnTheShaft) {
  for (const std::string effect :
       {"stiffness", "length", "self_weight", "precurvature", "port_offset", "port_motion",
        "port_compliance", "port_moment", "shaft_load", "wrist_compliance"})
    SwitchOn(effect, 0.4);
  CheckAll();
}

TEST_P(ReplayDerivatives, OfAllParametersAmongEffectsOnSensors) {
  for (const std::string effect :
       {"tip_compliance", "em_distortion", "strain_gain", "strain_drift"})
    SwitchOn(effect, 0.4);
  theta_[Index("focal_length")] = 0.02;
  theta_[Index("hand_eye") + 4] = 0.001;
  CheckAll();
}

TEST_P(ReplayDerivatives, OfAllParametersAmongEffectsOfGagesLensAndMotor) {
  for (const std::string effect :
       {"gage_rotation", "strain_crosstalk", "lens_radial", "camera_drift", "em_interference"})
    SwitchOn(effect, 0.4);
  CheckAll();
}

TEST_P(ReplayDerivatives, OfAllParametersAmongEffectsOfEncodersAndLoadCell) {
  SwitchOn("wrist_scale", 0.4);
  SwitchOn("encoder_eccentricity", 0.4);
  if (samples_.has_load) {
    SwitchOn("load_scale", 0.4);
    SwitchOn("load_rotation", 0.4);
  }
  CheckAll();
}

/// A late sensor's value is of a time between samples: the model goes there at its rate, and what
/// the other parameters do to that rate is left out. The latencies' own columns have it in full.
TEST_P(ReplayDerivatives, AmongLateSensorsAreRightToASmallPart) {
  SwitchOn("em_latency", 0.4);
  SwitchOn("camera_latency", 0.4);
  SwitchOn("em_clock", 0.4);
  SwitchOn("camera_clock", 0.4);
  CheckAll(0.05);
}

TEST_P(ReplayDerivatives, OfAllParametersAmongLargeTurns) {
  SwitchOn("hand_eye", 0.4);
  SwitchOn("tag_offset", 0.4);
  SwitchOn("focal_length", 0.4);
  CheckAll();
}

/// The play operator, once more: how far the true wrist is from the measured one, over the width,
/// is half to one side or the other while the wrist is dragged along.
std::vector<bool> Dragged(const SampleSet& samples, double width_m) {
  std::vector<bool> dragged;
  Eigen::Vector3d wrist = samples.samples[0].p_RW;
  for (const DiagnosisSample& sample : samples.samples) {
    bool all = true;
    for (int i = 0; i < 3; ++i) {
      const double ahead = sample.p_RW[i] - wrist[i];
      all = all && std::abs(ahead) > 0.55 * width_m;
      if (ahead > 0.5 * width_m) wrist[i] = sample.p_RW[i] - 0.5 * width_m;
      if (ahead < -0.5 * width_m) wrist[i] = sample.p_RW[i] + 0.5 * width_m;
    }
    dragged.push_back(all);
  }
  return dragged;
}

/// A column against differences in those of the samples that `use` says.
void CheckSamples(const Eigen::VectorXd& column, const Eigen::VectorXd& numeric,
                  const std::vector<bool>& use) {
  int used = 0;
  double error2 = 0.0, size2 = 0.0;
  for (std::size_t k = 0; k < use.size(); ++k) {
    if (!use[k]) continue;
    ++used;
    const Eigen::Index at = row::kCount * Eigen::Index(k);
    error2 += (column - numeric).segment<row::kCount>(at).squaredNorm();
    size2 += numeric.segment<row::kCount>(at).squaredNorm();
  }
  EXPECT_GT(used, 5);
  EXPECT_GT(size2, 0.0);
  EXPECT_LT(std::sqrt(error2 / size2), 1e-5);
}

TEST_P(ReplayDerivatives, OfPlayWhileTheWristIsDragged) {
  SwitchOn("backlash", 0.6);
  SwitchOn("port_offset", 0.4);
  Evaluate();
  const int j = Index("backlash");
  const Eigen::MatrixXd X = Derivatives(replay_);
  CheckSamples(X.col(j), -Numeric(j), Dragged(samples_, theta_[j]));
}

TEST_P(ReplayDerivatives, OfWhereTheWristStoodInItsPlay) {
  SwitchOn("backlash", 0.6);
  const Eigen::Vector3d first = samples_.samples[0].p_RW;
  for (DiagnosisSample& sample : samples_.samples) {
    if (sample.t_s < 1.0) sample.p_RW = first + 1e-3 * (sample.p_RW - first);
  }
  Evaluate();
  const int j = Index("backlash");
  const Eigen::MatrixXd X = Derivatives(replay_);
  const double limit_m = 0.5 * theta_[j];
  for (int axis = 0; axis < 3; ++axis) {
    const double start_m = theta_[j + 1 + axis];
    std::vector<bool> rests;  // nothing has dragged this axis yet
    for (const DiagnosisSample& sample : samples_.samples) {
      const double ahead_m = sample.p_RW[axis] - first[axis] - start_m;
      rests.push_back((rests.empty() || rests.back()) && std::abs(ahead_m) < 0.9 * limit_m);
    }
    CheckSamples(X.col(j + 1 + axis), -Numeric(j + 1 + axis), rests);
  }
}

TEST_P(ReplayDerivatives, PlayHoldsTheWristWhereverItIsSaidToStart) {
  SwitchOn("backlash", 0.6);
  const int j = Index("backlash");
  theta_[j + 1] = 5.0 * theta_[j];
  Evaluate();
  for (const ReplayedSample& sample : replay_.Samples())
    EXPECT_LE(std::abs(sample.inputs[sample_input::kWrist]), 0.5 * theta_[j] + 1e-12);
}

TEST_P(ReplayDerivatives, OfFrictionWhileTheShaftSlides) {
  SwitchOn("port_friction", 0.5);
  SwitchOn("precurvature", 0.4);
  Evaluate();
  At(theta_, 4);
  const int j = Index("port_friction");
  std::vector<bool> slides;
  for (const ReplayedSample& sample : replay_.Samples())
    slides.push_back(std::abs(sample.inputs[sample_input::kPortFriction]) == theta_[j]);
  const Eigen::MatrixXd X = Derivatives(replay_);
  // Those that stick at one of the points of the differences show it in their input.
  const double h = 0.02 * layout_.Parameter(j).typical;
  for (const double step : {-h, -0.5 * h, 0.5 * h, h}) {
    At(theta_ + step * Eigen::VectorXd::Unit(layout_.Size(), j));
    for (std::size_t k = 0; k < slides.size(); ++k) {
      const double ratio = replay_.Samples()[k].inputs[sample_input::kPortFriction];
      slides[k] = slides[k] && std::abs(std::abs(ratio) - theta_[j] - step) < 1e-12;
    }
  }
  CheckSamples(X.col(j), -Numeric(j), slides);
}

INSTANTIATE_TEST_SUITE_P(Load, ReplayDerivatives, testing::Bool(),
                         [](const auto& test) { return test.param ? "Known" : "Unknown"; });

}  // namespace
}  // namespace flextip::diagnosis
