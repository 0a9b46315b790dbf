// A result folder of `flextip diagnose` that a test writes and has read.
#pragma once

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/pages.h"
#include "report/result_files.h"

namespace flextip::report {

class DiagnosePage : public testing::Test {
 protected:
  using Json = nlohmann::json;

  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("flextip-diagnose-page-" + std::to_string(getpid()) + "-" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    Write("summary.json", R"({"command": "diagnose rec", "version": "9.8.7", "seconds": 1.5,
      "warnings": ["the strain gages say nothing"]})");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  /// The page of this diagnosis.json.
  std::string Page(const Json& diagnosis) const {
    Write("diagnosis.json", diagnosis.dump());
    WriteDiagnoseReport(folder_);
    return ReadBytes(folder_ / "report.html");
  }
  static std::vector<Json> Plots(const std::string& html) {
    const std::string begin = "<script type=\"application/json\">";
    std::vector<Json> plots;
    for (auto at = html.find(begin); at != std::string::npos; at = html.find(begin, at)) {
      at += begin.size();
      plots.push_back(Json::parse(html.substr(at, html.find("</script>", at) - at)));
    }
    return plots;
  }

  static Json Plot(const std::string& html, const std::string& title) {
    for (const Json& plot : Plots(html)) {
      if (plot["title"] == title) return plot;
    }
    ADD_FAILURE() << "no figure " << title;
    return {};
  }

  /// The shaft rubs in the port, and the data say so.
  static Json Friction() {
    return Json::parse(R"({
      "verdict": "port_friction", "verdicts": ["port_friction"],
      "probabilities": {"none": 1e-7, "backlash": 0.012, "port_friction": 0.981, "unknown": 0.003},
      "presence": {"port_friction": 0.985, "backlash": 0.014},
      "credible_set_90": [["port_friction"]], "indistinguishable": [["port_friction"]],
      "separating_motion": "",
      "parameters": {"port_friction": {"coefficient": {"value": 0.2134, "sd": 0.0113}}},
      "within_tolerance": {"stiffness": {"scale": {"value": 1.013, "sd": 0.006}},
        "tag_offset": {"offset_m": {"value": [0.00001, -0.00016, 0.0], "sd": [5e-5, 5e-5, 5e-5]}}},
      "tolerances": {"port_friction": {"coefficient": 0.03}, "stiffness": {"scale": 0.02},
        "tag_offset": {"offset_m": [0.0002, 0.0002, 0.0002]}},
      "base": {"heldout_rms": {"em0_position_m": 0.0009, "strain0_moment_Nm": 0.004},
        "tip_prediction_rms_m": 0.0009, "weighted_rms": 9.1, "chi2_per_dof": 9.4},
      "extended": {"heldout_rms": {"em0_position_m": 0.00014, "strain0_moment_Nm": 0.001},
        "tip_prediction_rms_m": 0.00014, "weighted_rms": 1.0, "chi2_per_dof": 1.01},
      "gain": {"heldout_error_ratio": 0.11, "heldout_error_ratio_interval": [0.09, 0.13],
        "tip_error_ratio": 0.15},
      "residual_signature": [
        {"channel": "strain0_moment_Nm", "against": "time", "score": 2.4},
        {"channel": "em0_position_m", "against": "sliding_velocity", "score": 41.0}],
      "noise_scale": {"em0_position_m": 1.0, "strain0_moment_Nm": 1.25},
      "summaries": {"port_friction": "the shaft rubs in the port, and sticks",
        "hand_eye": "the camera is not where it was registered",
        "tag_offset": "the tag mount's place on the tip is off"}})");
  }

  std::filesystem::path folder_;
};

}  // namespace flextip::report
