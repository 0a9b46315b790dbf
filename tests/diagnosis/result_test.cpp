// What is written of a result: every key of the interface, and a table whose rows fit its columns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/diagnose/result_files.h"
#include "diagnosis/diagnose.h"
#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

using testing::Contains;
using testing::ElementsAre;

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Empty ones too, the last as well.
std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

class ResultTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    recording_ = new hidden::HiddenRecording(SmallHidden(10.0, true, 61, {"tag_offset"}));
    result_ = new DiagnosisResult(Diagnose(recording_->recording, "small"));
  }
  static void TearDownTestSuite() {
    delete result_;
    delete recording_;
  }
  static hidden::HiddenRecording* recording_;
  static DiagnosisResult* result_;
};
hidden::HiddenRecording* ResultTest::recording_ = nullptr;
DiagnosisResult* ResultTest::result_ = nullptr;

TEST_F(ResultTest, JsonHasEveryKeyOfTheInterface) {
  const auto json = nlohmann::json::parse(DiagnosisJson(*result_));
  for (const char* key :
       {"verdict", "verdicts", "probabilities", "indistinguishable", "separating_motion",
        "parameters", "base", "extended", "gain", "residual_signature"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["verdict"], json["verdicts"][0]);
  EXPECT_THAT(json["verdicts"], ElementsAre("tag_offset"));
  EXPECT_TRUE(json["separating_motion"].is_string());
  ASSERT_EQ(json["indistinguishable"].size(), json["verdicts"].size());
  EXPECT_THAT(json["indistinguishable"][0], Contains("tag_offset"));
  const auto& offset = json["parameters"]["tag_offset"]["offset_m"];
  ASSERT_EQ(offset["value"].size(), 3U);
  ASSERT_EQ(offset["sd"].size(), 3U);
  for (const char* model : {"base", "extended"}) {
    EXPECT_TRUE(json[model]["chi2_per_dof"].is_number());
    for (const char* channel : {"wrist0_orientation_rad", "em0_position_m", "em0_orientation_rad",
                                "strain0_moment_Nm", "vision0_position_m", "vision0_direction_rad"})
      EXPECT_GT(json[model]["heldout_rms"][channel].get<double>(), 0.0) << model << channel;
  }
  EXPECT_GT(json["gain"]["heldout_error_ratio"].get<double>(), 0.0);
  EXPECT_LT(json["gain"]["heldout_error_ratio"].get<double>(), 1.0);
  EXPECT_GT(json["gain"]["tip_error_ratio"].get<double>(), 0.0);
  ASSERT_FALSE(json["residual_signature"].empty());
  for (const auto& signature : json["residual_signature"])
    EXPECT_TRUE(signature["channel"].is_string() && signature["against"].is_string() &&
                signature["score"].is_number());
}

/// Without a couple or a breath their axis and phase are unknown, not off by millions.
TEST_F(ResultTest, TolerancesOfDirectionsAndPhasesAreNoLargerThanThoseAre) {
  const auto tolerances = nlohmann::json::parse(DiagnosisJson(*result_)).at("tolerances");
  for (const double sd : tolerances.at("port_moment").at("rest_axis")) EXPECT_LE(sd, 1.0);
  const auto& motion = tolerances.at("port_motion");
  EXPECT_LE(motion.at("phase_rad").get<double>(), 3.1416);
  // Sine and cosine of 0.1 mm each.
  for (const double sd_m : motion.at("amplitude_m")) EXPECT_NEAR(sd_m, 1e-4, 0.5e-4);
}

TEST_F(ResultTest, ProbabilitiesSumToOneButForWhatIsLeftOut) {
  const auto json = nlohmann::json::parse(DiagnosisJson(*result_));
  double written = 0.0, left_out = 0.0, all = 0.0, largest = 0.0;
  for (const auto& [name, probability] : json["probabilities"].items()) {
    EXPECT_GE(probability.get<double>(), 0.0) << name;
    written += probability.get<double>();
    largest = std::max(largest, probability.get<double>());
  }
  for (const auto& h : result_->probabilities) {
    all += h.probability;
    if (!json["probabilities"].contains(Joined(h.verdict))) left_out += h.probability;
  }
  EXPECT_NEAR(all, 1.0, 1e-9);
  EXPECT_NEAR(written + left_out, 1.0, 1e-9);
  EXPECT_LT(left_out, 0.02);
  EXPECT_EQ(largest, json["probabilities"][Joined(result_->verdict)].get<double>());
  for (const char* always : {"none", "unknown"})
    EXPECT_TRUE(json["probabilities"].contains(always));
  for (const auto& name : result_->catalogue) EXPECT_TRUE(json["probabilities"].contains(name));
}

TEST_F(ResultTest, ResidualsHaveAsManyCellsAsColumns) {
  const auto lines = Lines(ResidualsCsv(result_->residuals));
  ASSERT_EQ(lines.size(), 1 + recording_->recording.wrist0->samples.size());
  ASSERT_EQ(lines[0].substr(0, 5), "#t_s,");
  const auto columns = Cells(lines[0]);
  int of_base = 0, of_extended = 0;
  for (const auto& column : columns) {
    of_base += column.starts_with("base.");
    of_extended += column.starts_with("extended.");
  }
  EXPECT_EQ(of_base, 16);  // all rows but the port sensor's
  EXPECT_EQ(of_extended, 16);
  double base = 0.0, extended = 0.0;  // sums of squares of the tip's rows
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const auto row = Cells(lines[k]);
    ASSERT_EQ(row.size(), columns.size()) << k;
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (row[c].empty()) continue;
      const double value = std::stod(row[c]);
      ASSERT_TRUE(std::isfinite(value)) << k;
      if (columns[c].starts_with("base.vision0_position_m")) base += value * value;
      if (columns[c].starts_with("extended.vision0_position_m")) extended += value * value;
    }
  }
  EXPECT_GT(extended, 0.0);
  EXPECT_GT(base, 2.0 * extended);  // tags that are off show in the tip's place
}

TEST_F(ResultTest, TheRightModelLeavesNoiseOnly) {
  EXPECT_GT(result_->base.chi2_per_dof, 10.0);
  EXPECT_LT(result_->extended.chi2_per_dof, 1.1);
  // Measured noise is taken up to a fifth too large in so short a recording, never too small.
  EXPECT_GT(result_->extended.chi2_per_dof, 1.0 / (1.25 * 1.25));
  for (const double scale : result_->noise_scale) {
    EXPECT_GE(scale, 1.0);
    EXPECT_LT(scale, 1.25);
  }
}

TEST(Result, AbsentMeasurementsAreEmptyCells) {
  DiagnosisResult result;
  result.residuals.columns = {"t_s", "base.a.0", "extended.a.0"};
  result.residuals.rows = {{0.0, 1.5, -0.25}, {0.02, 0.0, 0.0}};
  result.residuals.present = {{true, true, true}, {true, false, false}};
  EXPECT_EQ(ResidualsCsv(result.residuals), "#t_s,base.a.0,extended.a.0\n0,1.5,-0.25\n0.02,,\n");
}

TEST(Result, NamesAreJoinedByPlus) {
  EXPECT_EQ(Joined({"backlash"}), "backlash");
  EXPECT_EQ(Joined({"backlash", "port_friction"}), "backlash+port_friction");
}

TEST(Result, NoneHasNoParametersAndAGainOnlyWhereMeasured) {
  DiagnosisResult result;
  result.probabilities = {{{"none"}, 1.0, 0.0}};
  result.parameters = {{"length", {{"delta_m", {0.001}, {0.0001}}}}};  // the best of the rest
  auto json = nlohmann::json::parse(DiagnosisJson(result));
  EXPECT_EQ(json["verdict"], "none");
  EXPECT_TRUE(json["parameters"].empty());
  EXPECT_FALSE(json.contains("gain"));
  result.gain.measured = true;
  json = nlohmann::json::parse(DiagnosisJson(result));
  EXPECT_EQ(json["gain"]["heldout_error_ratio"], 1.0);
}

}  // namespace
}  // namespace flextip::diagnosis
