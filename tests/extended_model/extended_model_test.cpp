// model.yaml: what is written is read, and what means nothing is refused in one line.
#include "diagnosis/model/extended_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "core/rotation.h"
#include "diagnosis/model/catalogue.h"
#include "diagnosis/model/extended_effect.h"
#include "diagnosis/model/extended_instrument.h"
#include "diagnosis/model/latency.h"
#include "estimation/shaft_rod.h"
#include "testdata/hidden/draw.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ModelFile : public testing::Test {
 protected:
  ~ModelFile() override { fs::remove(file_); }
  diagnosis::ExtendedModel Read(const std::string& text) {
    std::ofstream(file_) << text;
    return diagnosis::ReadModel(file_);
  }
  std::string Complaint(const std::string& text) {
    try {
      Read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  const fs::path file_ =
      fs::temp_directory_path() /
      ("flextip_model_" +
       std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".yaml");
};

/// Every effect of the catalogue once, with numbers that have no short decimal form.
diagnosis::ExtendedModel Everything() {
  diagnosis::ExtendedModel model;
  double x = 0.1;
  int count = 0;
  std::vector<std::string> names = simulation::CatalogueEffects();
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    diagnosis::EffectFit fit{name, diagnosis::ParametersOf(*diagnosis::MakeEffect(name))};
    for (diagnosis::ReportedParameter& parameter : fit.parameters)
      for (double& value : parameter.value) {
        value = (x += 1.0 / 3.0);
        parameter.sd.push_back(x / 7.0);
      }
    (count++ < 4 ? model.effects : model.within_tolerance).push_back(fit);
  }
  const auto n = static_cast<Eigen::Index>(diagnosis::NumberNames(model.effects).size());
  model.covariance = Eigen::MatrixXd::Identity(n, n) / 3.0;
  model.covariance(0, 1) = model.covariance(1, 0) = 1.0 / 7.0;
  model.centre_m = {0.1, 1.0 / 3.0, -2.0};
  model.start_ns = 1'700'000'000'123'456'789;
  return model;
}

void ExpectSame(const std::vector<diagnosis::EffectFit>& a,
                const std::vector<diagnosis::EffectFit>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].effect, b[i].effect);
    ASSERT_EQ(a[i].parameters.size(), b[i].parameters.size());
    for (std::size_t j = 0; j < a[i].parameters.size(); ++j) {
      EXPECT_EQ(a[i].parameters[j].name, b[i].parameters[j].name);
      EXPECT_EQ(a[i].parameters[j].value, b[i].parameters[j].value);
      EXPECT_EQ(a[i].parameters[j].sd, b[i].parameters[j].sd);
    }
  }
}

const std::string kHead = "format: flextip-model\nversion: 1\ncentre_m: [0, 0, 0]\nstart_ns: 0\n";

TEST_F(ModelFile, RoundTripIsExact) {
  const diagnosis::ExtendedModel model = Everything();
  const diagnosis::ExtendedModel read = Read(diagnosis::ModelYaml(model));
  ExpectSame(read.effects, model.effects);
  ExpectSame(read.within_tolerance, model.within_tolerance);
  EXPECT_EQ(read.covariance, model.covariance);
  EXPECT_EQ(read.centre_m, model.centre_m);
  EXPECT_EQ(read.start_ns, model.start_ns);
  EXPECT_EQ(diagnosis::ModelYaml(read), diagnosis::ModelYaml(model));
}

TEST_F(ModelFile, CovarianceKeepsItsRowsInAnyOrder) {
  const diagnosis::ExtendedModel read =
      Read(kHead +
           "effects:\n  stiffness: {scale: 1.1}\n  length: {delta_m: 0.1}\n"
           "covariance: {parameters: [\"stiffness.scale[0]\", \"length.delta_m[0]\"], "
           "data: [1, 2, 2, 3]}\n");
  ASSERT_EQ(read.effects[0].effect, "length");
  EXPECT_EQ(read.covariance(0, 0), 3.0);
  EXPECT_EQ(read.covariance(0, 1), 2.0);
  EXPECT_EQ(read.covariance(1, 1), 1.0);
}

/// Parameters reported since: of no effect.
TEST_F(ModelFile, OlderFilesLackSomeParameters) {
  const diagnosis::ExtendedModel read =
      Read(kHead +
           "effects:\n  focal_length: {scale: 1.1}\nwithin_tolerance:\n"
           "  port_motion: {amplitude_m: [1, 2, 3], frequency_hz: 0.3, phase_rad: 1}\n"
           "sd:\n  focal_length: {scale: 0.1}\n"
           "covariance: {parameters: [\"focal_length.scale[0]\"], data: [0.01]}\n");
  const auto& focal = read.effects[0].parameters;
  ASSERT_EQ(focal.size(), 2u);
  EXPECT_EQ(focal[1].value, std::vector<double>{0.0});
  EXPECT_EQ(focal[1].sd, std::vector<double>{0.0});
  EXPECT_EQ(read.covariance, Eigen::Matrix2d(Eigen::Vector2d(0.01, 0.0).asDiagonal()));
  const auto& breath = read.within_tolerance[0].parameters;
  ASSERT_EQ(breath.size(), 5u);
  for (const std::size_t overtone : {3u, 4u})
    EXPECT_EQ(breath[overtone].value, (std::vector<double>{0.0, 0.0, 0.0}));
}

/// What is fitted comes back from what is reported, all of it.
TEST(ExtendedEffect, ReportedParametersHoldTheFittedOnes) {
  double x = 0.01;
  for (const std::string& name : simulation::CatalogueEffects()) {
    const auto effect = diagnosis::MakeEffect(name);
    Eigen::VectorXd theta(effect->Parameters(diagnosis::SampleSet{}).size());
    for (double& value : theta) value = (x += 0.003);
    if (name == "port_motion" || name == "em_interference")
      theta.segment<3>(3) = 0.7 * theta.head<3>();  // one phase for all
    const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(theta.size(), theta.size());
    std::vector<std::vector<double>> values;
    for (const auto& parameter : effect->Report(theta, covariance)) {
      values.push_back(parameter.value);
      EXPECT_EQ(parameter.sd.size(), parameter.value.size()) << name << '.' << parameter.name;
    }
    EXPECT_LT((effect->FromReported(values) - theta).norm(), 1e-12) << name;
  }
}

TEST_F(ModelFile, NothingFoundIsAModelToo) {
  const diagnosis::ExtendedModel read = Read(diagnosis::ModelYaml(diagnosis::ExtendedModel{}));
  EXPECT_TRUE(read.effects.empty() && read.within_tolerance.empty());
  EXPECT_EQ(read.covariance.size(), 0);
}

TEST_F(ModelFile, BadFilesAreRefusedInOneLine) {
  const struct {
    std::string text;
    std::vector<std::string> says;
  } cases[] = {
      {"format: flextip-recording\nversion: 1\n", {":1:", "flextip-recording", "flextip-model"}},
      {"format: flextip-model\nversion: 2\n", {":2:", "2", "expected 1"}},
      {kHead, {"effects"}},
      {kHead + "effects:\n  rust: {depth_m: 1}\n", {":6:", "rust", "unknown"}},
      {kHead + "effects:\n  stiffness: {scale: 1.1, factor: 2}\n", {":6:", "factor"}},
      {kHead + "effects:\n  stiffness: {}\n", {":6:", "scale"}},
      {kHead + "effects:\n  stiffness: {scale: stiff}\n", {":6:", "stiff"}},
      {kHead + "effects:\n  stiffness: {scale: -1}\n", {":6:", "positive"}},
      {kHead + "effects:\n  port_friction: {coefficient: -0.2}\n", {":6:", "at least 0"}},
      {kHead + "effects:\n  strain_gain: {gain: [1, 1, 0, 1]}\n", {":6:", "more than 0"}},
      {kHead + "effects:\n  port_offset: {offset_m: [1, 2]}\n", {":6:", "offset_m", "3"}},
      {kHead + "effects:\n  length: {delta_m: .nan}\n", {":6:", "delta_m"}},
      {kHead + "effects: {}\nsurprise: 1\n", {":6:", "surprise"}},
      {kHead + "effects:\n  length: {delta_m: 0.1}\nwithin_tolerance:\n  length: {delta_m: 0}\n",
       {":8:", "length"}},
      {kHead + "effects:\n  length: {delta_m: 0.1}\nsd:\n  stiffness: {scale: 1}\n",
       {":8:", "stiffness"}},
      {kHead + "effects:\n  length: {delta_m: 0.1}\nsd:\n  length: {delta_m: -1}\n",
       {":8:", "delta_m"}},
      {kHead + "effects:\n  length: {delta_m: 0.1}\ncovariance: {parameters: [x], data: [1]}\n",
       {":7:", "length.delta_m[0]"}},
      {kHead +
           "effects:\n  length: {delta_m: 0.1}\ncovariance: {parameters: [\"length.delta_m[0]\"], "
           "data: [1, 2]}\n",
       {":7:", "2", "1"}},
      {"effects: [\n", {":"}},
  };
  for (const auto& c : cases) {
    const std::string complaint = Complaint(c.text);
    EXPECT_THAT(complaint, HasSubstr(file_.string())) << c.text;
    EXPECT_EQ(complaint.find('\n'), std::string::npos) << complaint;
    for (const std::string& part : c.says) EXPECT_THAT(complaint, HasSubstr(part)) << c.text;
  }
  EXPECT_THROW(diagnosis::ReadModel("/no/such/model.yaml"), InputError);
}

TEST(WithoutLatency, MovesStampsBeyondTolerance) {
  Recording recording;
  recording.wrist0.emplace().samples = {{100, {}}};
  recording.em0.emplace().samples = {{1'000'000'000, {}}};
  recording.vision0.emplace().tips = {{1'000'000'000, {}}};
  diagnosis::ExtendedModel model;
  model.effects = {{"camera_latency", {{"delay_s", {0.02}, {}}}}};
  const Recording moved = diagnosis::WithoutLatency(recording, model);
  EXPECT_EQ(moved.wrist0->samples[0].t_ns, 100);
  EXPECT_EQ(moved.em0->samples[0].t_ns, 1'000'000'000);
  EXPECT_EQ(moved.vision0->tips[0].t_ns, 980'000'000);
}

TEST(WithoutLatency, TakesAClocksOwnRateOff) {
  constexpr TimeNs kStart_ns = 5'000'000'000;
  Recording recording;
  recording.em0.emplace().samples = {{kStart_ns, {}}, {kStart_ns + 20'000'000'000, {}}};
  diagnosis::ExtendedModel model;
  model.start_ns = kStart_ns;
  model.effects = {{"em_clock", {{"rate", {0.0002}, {}}}}};
  const Recording moved = diagnosis::WithoutLatency(recording, model);
  // What is stamped t was taken at t + rate (t - t0).
  EXPECT_EQ(moved.em0->samples[0].t_ns, kStart_ns);
  EXPECT_EQ(moved.em0->samples[1].t_ns, kStart_ns + 20'004'000'000);
}

TEST(WithoutLatency, TakesTheTermOfAStampOff) {
  using diagnosis::TermShape;
  constexpr TimeNs kStart_ns = 5'000'000'000, kSecond_ns = 1'000'000'000;
  Recording recording;
  recording.em0.emplace();
  recording.vision0.emplace();
  for (int i = 0; i < 4; ++i) {
    recording.em0->samples.push_back({kStart_ns + i * kSecond_ns, {}});
    recording.vision0->tips.push_back({kStart_ns + i * kSecond_ns, {}});
  }
  diagnosis::ExtendedModel model;
  model.start_ns = kStart_ns;
  // Frames are stamped 3 s late from 1.5 s on, EM readings 2 ms in every second from 1 s on.
  model.discovered = {{diagnosis::TermTarget::kVisionTime,
                       TermShape::kStep,
                       diagnosis::TermVariable::kTime,
                       {1.5, 0.01},
                       Eigen::MatrixXd::Constant(1, 1, 3.0),
                       {}},
                      {diagnosis::TermTarget::kEmTime,
                       TermShape::kLinear,
                       diagnosis::TermVariable::kTime,
                       {1.0},
                       Eigen::MatrixXd::Constant(1, 1, 0.002),
                       {}}};
  const Recording moved = diagnosis::WithoutLatency(recording, model);
  EXPECT_EQ(moved.em0->samples[3].t_ns, kStart_ns + 3 * kSecond_ns - 4'000'000);
  EXPECT_EQ(moved.vision0->tips[1].t_ns, kStart_ns + kSecond_ns);
  // Taken before the last one, by the term: they keep their order.
  EXPECT_EQ(moved.vision0->tips[2].t_ns, kStart_ns + kSecond_ns + 1);
  EXPECT_EQ(moved.vision0->tips[3].t_ns, kStart_ns + kSecond_ns + 2);
}

// Sensors that move along x at 0.1 m/s and turn about z at 0.5 rad/s, stamped 2 +- 1 ms late.
TEST(WithoutLatency, MovesValuesWithinTolerance) {
  constexpr double kSpeed_m_s = 0.1, kTurning_rad_s = 0.5, kDelay_s = 0.002, kSd_s = 0.001;
  const auto place = [](double t_s) { return Eigen::Vector3d(kSpeed_m_s * t_s, 0.02, 0.03); };
  const auto turn = [](double t_s) { return ExpRotation({0.0, 0.0, kTurning_rad_s * t_s}); };
  Recording recording;
  recording.em0.emplace().position_noise_m = 3e-5;
  recording.vision0.emplace();
  for (int i = 0; i < 5; ++i) {
    const double taken_s = 0.1 * i - kDelay_s;
    const TimeNs stamp_ns = 100'000'000 * i;
    recording.em0->samples.push_back(
        {stamp_ns, {place(taken_s), Eigen::Quaterniond(turn(taken_s))}});
    recording.vision0->tips.push_back(
        {stamp_ns,
         {TipStatus::kOk, place(taken_s), 1e-10 * Eigen::Matrix3d::Identity(),
          Eigen::Vector3d(turn(taken_s).col(0))}});
  }
  recording.vision0->tips[4].value.status = TipStatus::kLost;
  diagnosis::ExtendedModel model;
  model.within_tolerance = {{"camera_latency", {{"delay_s", {kDelay_s}, {kSd_s}}}},
                            {"em_latency", {{"delay_s", {kDelay_s}, {kSd_s}}}}};
  const Recording right = diagnosis::WithoutLatency(recording, model);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(right.em0->samples[i].t_ns, recording.em0->samples[i].t_ns);
    EXPECT_EQ(right.vision0->tips[i].t_ns, recording.em0->samples[i].t_ns);
    const EmSample& em = right.em0->samples[i].value;
    EXPECT_LT((em.p_RS - place(0.1 * i)).norm(), 1e-12);
    EXPECT_LT((em.q_RS.toRotationMatrix() - turn(0.1 * i)).norm(), 1e-9);
  }
  EXPECT_NEAR(right.em0->position_noise_m, std::hypot(3e-5, kSpeed_m_s * kSd_s / std::sqrt(3.0)),
              1e-12);
  EXPECT_NEAR(right.em0->orientation_noise_rad, kTurning_rad_s * kSd_s / std::sqrt(3.0), 1e-9);
  const TipObservation& tip = right.vision0->tips[2].value;
  EXPECT_LT((tip.p_RE - place(0.2)).norm(), 1e-12);
  EXPECT_LT((*tip.d_RE - turn(0.2).col(0)).norm(), 2e-6);  // a chord for an arc
  EXPECT_NEAR(tip.covariance_m2(0, 0), 1e-10 + std::pow(kSpeed_m_s * kSd_s, 2), 1e-16);
  EXPECT_NEAR(tip.covariance_m2(1, 1), 1e-10, 1e-16);
  // Beside a lost tip there is no path.
  EXPECT_EQ(right.vision0->tips[3].value.p_RE, recording.vision0->tips[3].value.p_RE);
}

TEST(ExtendedInstrument, AnEmptyModelChangesNothing) {
  Recording base;
  base.instrument = {0.5, 0.003, 0.3, 0.0};
  base.p_RP = {0.25, 0.0, 0.0};
  diagnosis::ExtendedInstrument model(diagnosis::ExtendedModel{}, base);
  Measurements z;
  z.em = EmMeasurement{{ExpRotation({0.1, 0.2, 0.3}), {0.4, 0.01, 0.02}}, 0.02, 1e-4, 1e-3};
  z.tip = TipObservation{TipStatus::kOk,
                         {0.5, 0.0, 0.1},
                         Eigen::Matrix3d::Identity() * 1e-8,
                         Eigen::Vector3d::UnitX()};
  model.Advance(5, z, Eigen::Vector3d::Zero());
  EXPECT_TRUE(IsPlain(model.Shaft().effects));
  EXPECT_EQ(model.Shaft().stiffness_scale, 1.0);
  const Measurements same = model.Correct(z);
  EXPECT_LT((same.em->T_RS.p - z.em->T_RS.p).norm(), 1e-15);
  EXPECT_LT((same.tip->p_RE - z.tip->p_RE).norm(), 1e-15);
  EXPECT_LT((same.tip->covariance_m2 - z.tip->covariance_m2).norm(), 1e-20);
}

}  // namespace
}  // namespace flextip
