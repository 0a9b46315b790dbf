#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "control/motion_error.h"
#include "kinematics/plane_beam.h"
#include "reproduction/chapter.h"
#include "reproduction/chapter3/noise.h"
#include "reproduction/chapter3/rod.h"
#include "tests/kinematics/printed_jacobian.h"

namespace flextip::reproduction {
namespace {

constexpr double kL = 0.355;

TEST(Ch3Beam, StandsAtTheDepthAskedForWithItsForce) {
  for (const double r : {0.05, 0.4, 0.9}) {
    const BeamState beam = BeamAtDepth({}, r * kL);
    EXPECT_NEAR((beam.Tip() - beam.Port()).norm(), r * kL, 1e-12);
    EXPECT_NEAR(beam.F * beam.a / kL, -3.0, 1e-9);  // F_t / EI
  }
}

TEST(Ch3Beam, ReadingsWithoutErrorGiveTheBeamBack) {
  for (const double phi : {0.0, 0.7}) {
    BeamState beam = BeamAtDepth({}, 0.6 * kL);
    beam.phi = phi;
    const BeamState back = EstimateBeam(ReadingsOf(beam), kL);
    EXPECT_NEAR(back.a, beam.a, 1e-12);
    EXPECT_NEAR(back.F, beam.F, 1e-9);
    EXPECT_LT((back.Port() - beam.Port()).norm(), 1e-12);
  }
}

TEST(Ch3Beam, PrintedFormIsTheThesissLetterByLetter) {
  for (const double r : {0.2, 0.5, 0.8}) {
    BeamState beam = BeamAtDepth({}, r * kL);
    beam.phi = 0.3;
    const double y = BeamPortHeight(beam.F, beam.a, kL);
    const Eigen::Vector2d d = beam.Port() - beam.p_wrist;
    const Eigen::Matrix2d printed =
        PrintedJacobian3(y, beam.a, kL, std::atan2(d.y(), d.x()), d.x(), d.y());
    EXPECT_LT((FlexionJacobian(FlexionForm::kPrinted, beam) - printed).norm(), 1e-12);
    const double off =
        (FlexionJacobian(FlexionForm::kPortForce, beam) - printed).norm() / printed.norm();
    EXPECT_EQ(off > 0.01, std::abs(r - 0.5) > 0.1);
  }
}

TEST(Ch3Beam, CorrectedFormsMatchCentralDifferences) {
  const BeamState beam = BeamAtDepth({}, 0.7 * kL);
  for (const auto form : {FlexionForm::kPortForce, FlexionForm::kTipForce}) {
    PlaneBeamProblem problem;
    problem.p_port = beam.Port();
    problem.length_m = kL;
    problem.law =
        form == FlexionForm::kPortForce ? BeamLoadLaw::kPortForce : BeamLoadLaw::kTipForce;
    problem.load_over_EI = form == FlexionForm::kPortForce ? beam.F : beam.F * beam.a / kL;
    Eigen::Matrix2d numeric;
    const double h = 1e-5;
    for (int i = 0; i < 2; ++i) {
      problem.p_wrist = h * Eigen::Vector2d::Unit(i);
      const Eigen::Vector2d there = SolvePlaneBeam(problem).p_tip;
      problem.p_wrist = -problem.p_wrist;
      numeric.col(i) = (there - SolvePlaneBeam(problem).p_tip) / (2.0 * h);
    }
    EXPECT_LT((FlexionJacobian(form, beam) - numeric).norm(), 1e-7);
  }
}

TEST(Ch3Noise, NoDrawIsWorseThanTheWorst) {
  const SensorNoiseLevel level{0.0005 * kL, 0.0005};
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  for (const double r : {0.35, 0.7, 0.9}) {
    const BeamState truth = BeamAtDepth({}, r * kL);
    const WorstErrors worst = WorstOverNoise(FlexionForm::kTipForce, truth, level);
    EXPECT_GE(worst.worst.metric, worst.corners.metric);
    EstimateErrors seen;
    for (int i = 0; i < 5000; ++i) {
      const BeamReadings parts = BeamReadings::NullaryExpr([&] { return part(rng); });
      const BeamState estimate =
          EstimateBeam(ReadingsOf(truth) + parts.cwiseProduct(level.Bounds()), kL);
      const EstimateErrors errors = ErrorsOf(FlexionForm::kTipForce, truth, estimate);
      seen.metric = std::max(seen.metric, errors.metric);
      seen.force = std::max(seen.force, errors.force);
      seen.port_m = std::max(seen.port_m, errors.port_m);
    }
    EXPECT_LE(seen.metric, worst.worst.metric);
    EXPECT_LE(seen.force, worst.worst.force);
    EXPECT_LE(seen.port_m, worst.worst.port_m);
    EXPECT_GT(seen.metric, 0.5 * worst.worst.metric);
  }
}

TEST(Ch3Noise, IsWithoutBoundWhereItMayPutThePortOffTheShaft) {
  const BeamState shallow = BeamAtDepth({}, 0.05 * kL);
  const WorstErrors worst = WorstOverNoise(FlexionForm::kPortForce, shallow, {0.002 * kL, 0.002});
  EXPECT_TRUE(std::isinf(worst.worst.metric));
  EXPECT_TRUE(std::isinf(worst.worst.force));
}

TEST(Ch3Rod, IsTheBeamUnderALightLoad) {
  const BentShaft light{kL, 0.1};
  const PlaneRodState rod = PlaneRodAt(light, 0.4 * kL);
  const BeamState fit = EstimateBeam(rod.readings, kL);
  EXPECT_NEAR(fit.a / kL, 0.4, 1e-4);
  EXPECT_NEAR(fit.F * fit.a / kL, -0.1, 1e-4);
  const auto metric = [&](FlexionForm form) {
    return FindStepError(rod.J_tip_wrist, FlexionJacobian(form, fit)).norm;
  };
  EXPECT_LT(metric(FlexionForm::kTipForce), 1e-4);  // the rod's force is held
  EXPECT_GT(metric(FlexionForm::kPortForce), 1e-3);
}

TEST(Chapter3, HasEveryFigureAndTheTextsNumbers) {
  double done = 0.0;
  const ChapterResult result =
      ReproduceChapter3({.quick = true}, [&](double part) { done = part; });
  EXPECT_NEAR(done, 1.0, 1e-9);
  std::set<std::string> names;
  for (const report::Figure& figure : result.figures) {
    names.insert(figure.name);
    for (const report::FigureTrace& trace : figure.traces) {
      EXPECT_EQ(trace.x.size(), trace.y.size()) << figure.name;
      EXPECT_TRUE(
          std::any_of(trace.y.begin(), trace.y.end(), [](double y) { return std::isfinite(y); }))
          << figure.name << " " << trace.name;
    }
  }
  for (const char* name : {"fig-3-5a", "fig-3-5b", "fig-3-6a", "fig-3-6b", "fig-3-6c", "fig-3-7",
                           "fig-3-8", "fig-3-9a", "fig-3-9b", "fig-3-10", "fig-3-11a", "fig-3-11b"})
    EXPECT_TRUE(names.count(name)) << name;
  const auto flextip = [&](const std::string& quantity) {
    for (const TableRow& row : result.rows)
      if (row.quantity == quantity) return row.flextip.value_or(NAN);
    ADD_FAILURE() << quantity;
    return double(NAN);
  };
  // What does not depend on the grid.
  EXPECT_NEAR(flextip("3.5 metric at half insertion, worst within the stated noise"), 0.18, 0.001);
  EXPECT_NEAR(flextip("3.5 metric at half insertion, median, stated noise per axis"), 0.0565,
              0.004);
  EXPECT_NEAR(flextip("Fig. 3.6 r / L of the least metric, as printed, 0.002 L, 0.002 rad"), 0.7,
              0.05);
  EXPECT_NEAR(flextip("Fig. 3.7 r / L of the least error of F_p/EI, 0.002 L, 0.002 rad"), 0.5,
              0.03);
}

}  // namespace
}  // namespace flextip::reproduction
