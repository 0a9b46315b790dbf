// Terms in model.yaml and undone in an instrument's readings.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "core/rotation.h"
#include "diagnosis/model/extended_instrument.h"
#include "diagnosis/model/extended_model.h"
#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

ExtendedModel SteppingModel(const Recording& recording) {
  Term step{TermTarget::kEmPosition, TermShape::kStep, TermVariable::kTime, {2.0, 0.1}, {}, {}};
  step.amplitude = Eigen::Vector3d(0.001, -0.002, 0.0005);
  Term turn{TermTarget::kEmOrientation, TermShape::kConstant, TermVariable::kTime, {}, {}, {}};
  turn.amplitude.resize(3, 0);
  turn.offset = Eigen::Vector3d(0.0, 0.01, -0.02);
  ExtendedModel model;
  model.discovered = {step, turn};
  model.start_ns = recording.wrist0->samples.front().t_ns;
  return model;
}

TEST(TermModel, IsReadAsItWasWritten) {
  const ExtendedModel model = SteppingModel(SmallHidden(2.0, true, 3).recording);
  const auto file = std::filesystem::temp_directory_path() / "flextip_term_model.yaml";
  WriteModel(file, model);
  const ExtendedModel again = ReadModel(file);
  std::filesystem::remove(file);
  ASSERT_EQ(again.discovered.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again.discovered[i].target, model.discovered[i].target);
    EXPECT_EQ(again.discovered[i].shape, model.discovered[i].shape);
    EXPECT_EQ(again.discovered[i].at, model.discovered[i].at);
    EXPECT_EQ(again.discovered[i].amplitude, model.discovered[i].amplitude);
    EXPECT_EQ(again.discovered[i].offset, model.discovered[i].offset);
  }
}

TEST(TermModel, AStampDependsOnTimeAlone) {
  const auto file = std::filesystem::temp_directory_path() / "flextip_term_stamp.yaml";
  ExtendedModel model;
  for (const TermVariable on : {TermVariable::kTime, TermVariable::kLoad}) {
    model.discovered = {{TermTarget::kVisionTime,
                         TermShape::kLinear,
                         on,
                         {1.0},
                         Eigen::MatrixXd::Constant(1, 1, 1e-4),
                         {}}};
    WriteModel(file, model);
    if (on == TermVariable::kTime) {
      EXPECT_EQ(ReadModel(file).discovered.size(), 1U);
    } else {
      EXPECT_THROW(ReadModel(file), InputError);
    }
  }
  std::filesystem::remove(file);
}

TEST(TermModel, ALensBendsAVector) {
  const auto file = std::filesystem::temp_directory_path() / "flextip_term_radial.yaml";
  ExtendedModel model;
  model.discovered = {{TermTarget::kVisionPosition,
                       TermShape::kRadial,
                       TermVariable::kImagePosition,
                       {},
                       Eigen::MatrixXd::Constant(3, 2, 0.01),
                       {}}};
  WriteModel(file, model);
  EXPECT_EQ(ReadModel(file).discovered.at(0).amplitude, model.discovered[0].amplitude);
  model.discovered[0].variable = TermVariable::kLoad;
  model.discovered[0].amplitude = Eigen::MatrixXd::Constant(3, 1, 0.01);
  WriteModel(file, model);
  EXPECT_THROW(ReadModel(file), InputError);
  std::filesystem::remove(file);
}

TEST(TermModel, ATermWithoutMeaningIsRefused) {
  const std::string text = ModelYaml(SteppingModel(SmallHidden(2.0, true, 3).recording));
  const auto file = std::filesystem::temp_directory_path() / "flextip_term_wrong.yaml";
  const auto refused = [&](const std::string& was, const std::string& is) {
    std::string wrong = text;
    wrong.replace(wrong.find(was), was.size(), is);
    std::ofstream(file) << wrong;
    EXPECT_THROW(ReadModel(file), InputError) << is;
  };
  refused("em0_position_m", "em9_position_m");
  refused("shape: step", "shape: stair");
  refused("variable: time", "variable: mood");
  refused("at: [2, 0.1", "at: [2, -0.1");
  refused("    variable: time", "    colour: red\n    variable: time");
  std::filesystem::remove(file);
}

TEST(TermModel, AnInstrumentUndoesIt) {
  const Recording recording = SmallHidden(4.0, true, 3).recording;
  ExtendedInstrument instrument(SteppingModel(recording), recording);
  for (const auto& sample : recording.em0->samples) {
    const double t_s =
        1e-9 * static_cast<double>(sample.t_ns - recording.wrist0->samples.front().t_ns);
    const double part = 0.5 + 0.5 * std::tanh(2.0 * (t_s - 2.0) / 0.1);
    Measurements z;
    z.p_RW = recording.wrist0->samples.front().value.p_RW;
    z.em.emplace();
    const Eigen::Matrix3d R = sample.value.q_RS.toRotationMatrix();
    z.em->T_RS.p = sample.value.p_RS + part * Eigen::Vector3d(0.001, -0.002, 0.0005);
    z.em->T_RS.R = ExpRotation(Eigen::Vector3d(0.0, 0.01, -0.02)) * R;
    instrument.Advance(sample.t_ns, z, Eigen::Vector3d::Zero());
    const Measurements corrected = instrument.Correct(z);
    EXPECT_LT((corrected.em->T_RS.p - sample.value.p_RS).norm(), 1e-9);
    EXPECT_LT((corrected.em->T_RS.R - R).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace flextip::diagnosis
