// Evidence from normal equations against Gaussian integrals over the measurements themselves.
#include "diagnosis/evidence/evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "diagnosis/model/parameter_layout.h"
#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

constexpr int kRows = 90, kGeneric = 7;

/// log N(z; 0, C).
double LogNormal(const Eigen::VectorXd& z, const Eigen::MatrixXd& C) {
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(C);
  return -0.5 * (z.dot(Eigen::VectorXd(ldlt.solve(z))) + ldlt.vectorD().array().log().sum() +
                 double(z.size()) * std::log(2.0 * std::numbers::pi));
}

/// log of the mean of exp(x).
double LogMeanExp(const std::vector<double>& x) {
  double largest = -1e300, sum = 0.0;
  for (const double value : x) largest = std::max(largest, value);
  for (const double value : x) sum += std::exp(value - largest);
  return largest + std::log(sum / double(x.size()));
}

/// A random problem of the real catalogue's size: z = X theta + noise.
class EvidenceTest : public testing::Test {
 protected:
  EvidenceTest()
      : samples_(SmallSamples(5.0, true, 31)),
        layout_(samples_, MakeCatalogue(samples_)),
        size_(layout_.Size() + kGeneric),
        X_(kRows, size_),
        z_(kRows),
        sums_(size_) {
    std::mt19937_64 rng(5);
    std::normal_distribution<double> normal;
    for (Eigen::Index i = 0; i < X_.size(); ++i) X_.data()[i] = normal(rng);
    for (int j = 0; j < layout_.Size(); ++j) X_.col(j) *= 1.5 / layout_.Parameter(j).typical;
    for (int i = 0; i < kRows; ++i) z_[i] = normal(rng);
    generic_sd_ = Eigen::VectorXd::LinSpaced(kGeneric, 0.04, 0.2);
    const auto& block = layout_.Blocks()[layout_.Find("precurvature")];  // something is there
    for (int j = block.first; j < block.first + block.size; ++j)
      z_ += 0.8 * layout_.Parameter(j).typical * X_.col(j);
    sums_.H = X_.transpose() * X_;
    sums_.g = X_.transpose() * z_;
    sums_.c = z_.squaredNorm();
    sums_.rows = kRows;
  }

  int Block(const std::string& effect) const { return layout_.Find(effect); }

  /// Prior standard deviations, from the tolerances and typical sizes themselves.
  Eigen::VectorXd PriorSd(const std::vector<int>& blocks, const std::vector<double>& scales,
                          double unknown_sd) const {
    Eigen::VectorXd sd(size_);
    sd << layout_.Tolerances(), generic_sd_;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const auto& block = layout_.Blocks()[blocks[b]];
      for (int j = block.first; j < block.first + block.size; ++j)
        sd[j] = std::max(sd[j], scales[b] * layout_.Parameter(j).typical);
    }
    for (int j = layout_.Size(); j < size_; ++j) sd[j] = std::max(sd[j], unknown_sd);
    return sd;
  }
  double BruteForce(const Eigen::VectorXd& sd) const {
    const Eigen::MatrixXd XT = X_ * sd.asDiagonal();
    return LogNormal(z_, Eigen::MatrixXd::Identity(kRows, kRows) + XT * XT.transpose());
  }
  double BruteForceOfNone() const { return BruteForce(PriorSd({}, {}, 0.0)); }

  /// Averages over all widths of the effects and, with `unknown`, of the generic terms.
  double BruteForceOf(const std::vector<int>& blocks, bool unknown) const {
    const std::vector<double> unknown_sd =
        unknown ? EvidenceOptions{}.unknown_sd : std::vector<double>{0.0};
    std::vector<double> logs;
    const std::vector<double> scales = EvidenceOptions{}.scales;
    for (const double generic : unknown_sd) {
      std::vector<double> chosen(blocks.size());
      const std::function<void(std::size_t)> all = [&](std::size_t b) {
        if (b == blocks.size()) {
          logs.push_back(BruteForce(PriorSd(blocks, chosen, generic)));
          return;
        }
        for (const double scale : scales) {
          chosen[b] = scale;
          all(b + 1);
        }
      };
      all(0);
    }
    return LogMeanExp(logs) - BruteForceOfNone();
  }

  SampleSet samples_;
  ParameterLayout layout_;
  int size_;
  Eigen::MatrixXd X_;
  Eigen::VectorXd z_, generic_sd_;
  NormalSums sums_;
};

TEST_F(EvidenceTest, OfNoneIsTheReference) {
  const Evidence evidence(sums_, layout_, generic_sd_);
  EXPECT_NEAR(evidence.Weigh({}).log_evidence, 0.0, 1e-9);
  // Up to the constant of as many measurements.
  const double constant = -0.5 * kRows * std::log(2.0 * std::numbers::pi);
  EXPECT_NEAR(evidence.LogEvidenceOfNone() + constant, BruteForceOfNone(), 1e-7);
}

TEST_F(EvidenceTest, OfSinglesPairsAndUnknownIsTheGaussianIntegral) {
  const Evidence evidence(sums_, layout_, generic_sd_);
  const int stiffness = Block("stiffness"), bent = Block("precurvature"),
            camera = Block("hand_eye"), gages = Block("strain_gain");
  const std::vector<std::vector<int>> cases{{stiffness}, {bent},           {camera},
                                            {gages},     {bent, camera},   {stiffness, gages},
                                            {},          {bent, stiffness}};
  for (const auto& blocks : cases) {
    for (const bool unknown : {false, true}) {
      const double brute = BruteForceOf(blocks, unknown);
      EXPECT_NEAR(evidence.Weigh({blocks, unknown}).log_evidence, brute, 1e-6 + 1e-7 * fabs(brute))
          << blocks.size() << " effects, first " << (blocks.empty() ? -1 : blocks[0])
          << (unknown ? " and unknown" : "");
    }
  }
}

TEST_F(EvidenceTest, FindsWhatIsThere) {
  const Evidence evidence(sums_, layout_, generic_sd_);
  const double bent = evidence.Weigh({{Block("precurvature")}}).log_evidence;
  EXPECT_GT(bent, 5.0);
  for (const std::string other : {"stiffness", "hand_eye", "strain_gain", "length"})
    EXPECT_LT(evidence.Weigh({{Block(other)}}).log_evidence, bent - 5.0) << other;
}

/// Half a normal prior: 2 N(x; 0, s^2) for x > 0, integrated by Simpson's rule.
TEST_F(EvidenceTest, OfPositiveParametersIsTheIntegralOverPositiveValues) {
  for (const std::string effect : {"port_compliance", "port_friction", "tip_compliance"}) {
    for (const double truth : {-0.6, -0.1, 0.0, 0.1, 0.7}) {
      const int b = Block(effect), j = layout_.Blocks()[b].first;
      ASSERT_EQ(layout_.Blocks()[b].size, 1);
      ASSERT_TRUE(layout_.Parameter(j).positive);
      const Eigen::VectorXd z = z_ + truth * layout_.Parameter(j).typical * X_.col(j);
      NormalSums sums = sums_;
      sums.g = X_.transpose() * z;
      sums.c = z.squaredNorm();
      Eigen::VectorXd others = PriorSd({}, {}, 0.0);
      others[j] = 0.0;
      const Eigen::MatrixXd XT = X_ * others.asDiagonal();
      const Eigen::LLT<Eigen::MatrixXd> llt(Eigen::MatrixXd::Identity(kRows, kRows) +
                                            XT * XT.transpose());
      const auto log_likelihood = [&](double x) {  // up to the constant none has too
        const Eigen::VectorXd w = llt.matrixL().solve(z - x * X_.col(j));
        return -0.5 * w.squaredNorm();
      };
      const auto integral = [&](double sd, double from) {  // times the likelihood at zero
        const int steps = 20000;
        const double h = (10.0 * sd - from) / steps, at_zero = log_likelihood(0.0);
        double sum = 0.0;
        // The exponent is a parabola: three values give it.
        const double up = log_likelihood(sd) - at_zero, down = log_likelihood(-sd) - at_zero;
        const double slope = 0.5 * (up - down) / sd, bend = 0.5 * (up + down) / (sd * sd);
        for (int i = 0; i <= steps; ++i) {
          const double x = from + i * h, weight = i == 0 || i == steps ? 1 : (i % 2 == 1 ? 4 : 2);
          sum += weight * std::exp(slope * x + bend * x * x - 0.5 * x * x / (sd * sd));
        }
        return sum * h / 3.0 / (std::sqrt(2.0 * std::numbers::pi) * sd);
      };
      const double tolerance = layout_.Tolerances()[j];
      const double none = std::log(integral(tolerance, -10.0 * tolerance));
      std::vector<double> logs;
      for (const double scale : EvidenceOptions{}.scales) {
        const double sd = std::max(tolerance, scale * layout_.Parameter(j).typical);
        logs.push_back(std::log(2.0 * integral(sd, 0.0)) - none);
      }
      const Evidence evidence(sums, layout_, generic_sd_);
      EXPECT_NEAR(evidence.Weigh({{b}}).log_evidence, LogMeanExp(logs), 1e-6)
          << effect << ' ' << truth;
    }
  }
}

TEST_F(EvidenceTest, ModeAndCovarianceAreTheTextbooks) {
  const Evidence evidence(sums_, layout_, generic_sd_);
  const std::vector<int> blocks{Block("precurvature"), Block("length")};
  for (const bool unknown : {false, true}) {
    const WeighedHypothesis weighed = evidence.Weigh({blocks, unknown});
    ASSERT_EQ(weighed.scales.size(), 2U);
    const Eigen::VectorXd sd = PriorSd(blocks, weighed.scales, weighed.unknown_sd);
    EXPECT_LT((evidence.PriorSd(weighed) - sd).norm(), 1e-15);
    // Prior times what the data leave: T - T X^T (I + X T X^T)^-1 X T, mean T X^T (...)^-1 z.
    const Eigen::MatrixXd T = sd.cwiseAbs2().asDiagonal();
    const Eigen::MatrixXd TX = T * X_.transpose();
    const Eigen::LLT<Eigen::MatrixXd> llt(Eigen::MatrixXd::Identity(kRows, kRows) + X_ * TX);
    const Eigen::MatrixXd covariance = T - TX * llt.solve(TX.transpose());
    const Eigen::VectorXd mean = TX * llt.solve(z_);
    const Eigen::VectorXd unit = sd.cwiseInverse();  // everything in its prior's unit
    EXPECT_LT((unit.asDiagonal() * (evidence.Covariance(weighed) - covariance) * unit.asDiagonal())
                  .norm(),
              1e-8);
    EXPECT_LT(unit.cwiseProduct(evidence.Mode(weighed, covariance) - mean).norm(), 1e-8);
    const double cost = (z_ - X_ * mean).squaredNorm() + mean.cwiseQuotient(sd).squaredNorm();
    EXPECT_NEAR(evidence.Merit(weighed, mean), cost, 1e-7 * cost);
  }
}

/// The widths kept are those of the greatest evidence.
TEST_F(EvidenceTest, KeepsTheBestWidths) {
  const Evidence evidence(sums_, layout_, generic_sd_);
  const int bent = Block("precurvature");
  const WeighedHypothesis weighed = evidence.Weigh({{bent}, true});
  double best = -1e300, scale_of_best = 0.0, sd_of_best = 0.0;
  for (const double sd : EvidenceOptions{}.unknown_sd) {
    for (const double scale : EvidenceOptions{}.scales) {
      const double brute = BruteForce(PriorSd({bent}, {scale}, sd));
      if (brute <= best) continue;
      best = brute;
      scale_of_best = scale;
      sd_of_best = sd;
    }
  }
  EXPECT_EQ(weighed.scales, std::vector<double>{scale_of_best});
  EXPECT_EQ(weighed.unknown_sd, sd_of_best);
}

}  // namespace
}  // namespace flextip::diagnosis
