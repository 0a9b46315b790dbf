#include "report/pages.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "report/labels.h"
#include "report/report.h"
#include "report/result_files.h"
#include "tests/report/page_plots.h"

namespace flextip::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class Pages : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("flextip-pages-" + std::to_string(getpid()) + "-" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    Write("summary.json", R"({"command": "simulate", "version": "9.8.7", "seconds": 1.5,
      "warnings": ["the tip was lost twice"], "frames": 12,
      "controllers": {"rod-track": {"max_deviation_m": 0.00123, "rms_deviation_m": 0.0004}}})");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void Write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::string Page() const { return ReadBytes(folder_ / "report.html"); }
  std::vector<nlohmann::json> Plots() const { return PlotsIn(Page()); }

  std::filesystem::path folder_;
};

const char* kDeviation =
    "#timestamp [ns],p_desired_x [m],p_desired_y [m],p_desired_z [m],p_RE_x [m],p_RE_y [m],"
    "p_RE_z [m],deviation [m]\n"
    "1000000000,0.5,0,0,0.5,0.001,0,0.001\n"
    "1500000000,0.5,0.002,0,0.5,0.002,0.003,0.003\n";

TEST_F(Pages, ShowFiguresWarningsAndTheTableOfControllers) {
  WriteSimulateReport(folder_);
  const std::string html = Page();
  EXPECT_THAT(html, HasSubstr("flextip simulate</p>"));
  EXPECT_THAT(html, HasSubstr("<dt>frames</dt><dd>12</dd>"));
  EXPECT_THAT(html, HasSubstr("the tip was lost twice"));
  EXPECT_THAT(html, HasSubstr("<th>largest deviation</th>"));
  EXPECT_THAT(html, HasSubstr("<td>rod-track</td><td>1.23 mm</td><td>0.4 mm</td>"));
}

TEST_F(Pages, PlotEveryControllersDeviationAndPath) {
  Write("rod-track/deviation.csv", kDeviation);
  Write("straight-calculate/deviation.csv", kDeviation);
  WriteSimulateReport(folder_);
  const auto plots = Plots();
  ASSERT_EQ(plots.size(), 2U);
  const auto& over_time = plots[0]["traces"];
  ASSERT_EQ(over_time.size(), 2U);
  EXPECT_EQ(over_time[0]["name"], "straight-calculate");  // the poorest model first
  EXPECT_EQ(over_time[0].value("dashed", false), true);
  EXPECT_EQ(over_time[1].value("dashed", false), false);
  EXPECT_EQ(over_time[1]["x"], nlohmann::json({0.0, 0.5}));
  EXPECT_EQ(over_time[1]["y"], nlohmann::json({1.0, 3.0}));  // mm
  const auto& paths = plots[1]["traces"];
  ASSERT_EQ(paths.size(), 3U);
  EXPECT_EQ(paths[2]["name"], "desired");
  EXPECT_EQ(paths[1]["z"], nlohmann::json({0.0, 3.0}));
}

TEST_F(Pages, LeaveGapsWhereTheTipWasLost) {
  Write("vision0/data.csv",
        "#timestamp [ns],p_RE_x [m],p_RE_y [m],p_RE_z [m],cov_xx [m2],cov_xy [m2],cov_xz [m2],"
        "cov_yy [m2],cov_yz [m2],cov_zz [m2],d_RE_x [],d_RE_y [],d_RE_z [],status []\n"
        "0,0.1,0.2,0.3,4e-8,0,0,4e-8,0,1e-8,1,0,0,ok\n"
        "1000000000,,,,,,,,,,,,,lost\n"
        "2000000000,0.101,0.2,0.3,4e-8,0,0,4e-8,0,1e-8,,,,predicted\n");
  WriteTrackReport(folder_);
  const auto plots = Plots();
  ASSERT_EQ(plots.size(), 3U);
  EXPECT_TRUE(plots[1]["traces"][0]["y"][1].is_null());
  EXPECT_NEAR(plots[1]["traces"][0]["y"][2].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(plots[2]["traces"][0]["y"][0].get<double>(), 0.3, 1e-9);  // sqrt of 9e-8 m2
}

TEST_F(Pages, PlotEveryColumnOfAState) {
  Write("state0/data.csv",
        "#timestamp [ns],p_RE_x [m],p_RE_y [m],p_RE_z [m],f_tip_x [N],status []\n"
        "0,0.1,0.2,0.3,1,ok\n100,0.1,0.2,0.4,2,ok\n");
  WriteEstimateReport(folder_);
  const auto plots = Plots();
  ASSERT_EQ(plots.size(), 3U);  // the path, the position, the force
  EXPECT_EQ(plots[1]["traces"].size(), 3U);
  EXPECT_EQ(plots[1]["traces"][2]["y"][1].get<double>(), 400.0);
  EXPECT_EQ(plots[2]["traces"][0]["y"], nlohmann::json({1.0, 2.0}));
}

TEST_F(Pages, ShowBothModelsErrorsOfAPrediction) {
  Write("summary.json", R"({"command": "predict", "version": "1", "ratio": 0.25, "tip_ratio": 0.2,
    "base_rms": {"em0_position_m": 0.002}, "extended_rms": {"em0_position_m": 0.0005},
    "base_tip_rms_m": 0.004, "extended_tip_rms_m": 0.0008,
    "verdict": {"grade": "good", "says": "The model holds.", "reasons": [], "next": "use it",
                "command": "flextip estimate rec --model m.yaml -o out"}})");
  EXPECT_THROW(WriteReport(folder_), InputError);  // the residuals are missing
  Write("residuals.csv", "#t_s,base.em0_position_m.0,extended.em0_position_m.0\n0,8,1\n1,-8,-1\n");
  WriteReport(folder_);
  const std::string html = Page();
  EXPECT_THAT(html, HasSubstr("The model holds."));
  EXPECT_THAT(html, HasSubstr("<td>EM position</td><td>2</td><td>0.5</td>"));
  EXPECT_THAT(html, HasSubstr("<td>tip, RMS</td><td>4</td><td>0.8</td>"));
}

TEST_F(Pages, ShowPicturesOfAllCommands) {
  Write("overlay/0001.png", "\x89PNG one");
  Write("overlay/notes.txt", "not a picture");
  for (const auto write : {WriteTrackReport, WriteDetectReport, WriteCalibrateReport}) {
    write(folder_);
    EXPECT_THAT(Page(), HasSubstr(Base64("\x89PNG one")));
    EXPECT_THAT(Page(), Not(HasSubstr("notes.txt")));
  }
}

TEST_F(Pages, AVideoIsPlayedFromItsFile) {
  WriteTrackReport(folder_);
  EXPECT_THAT(Page(), Not(HasSubstr("<video")));
  Write("overlay.mp4", "frames");
  WriteTrackReport(folder_);
  EXPECT_THAT(Page(), HasSubstr("<video controls muted preload=\"metadata\" src=\"overlay.mp4\">"));
}

TEST_F(Pages, ACalibrationBeginsWithItsVerdict) {
  Write("summary.json", R"({"command": "calibrate tip", "version": "1", "seconds": 1.5,
    "warnings": ["pose 3: <far off>", "p cannot be named: no turn", "the port moved"],
    "verdict": {"grade": "beware", "says": "To be used with care.", "reasons": ["the port moved"],
      "values": [{"name": "tip", "value": "(1, 2, 3) mm", "sd": "0.5 mm"},
                 {"name": "poses", "value": "7", "sd": ""}],
      "not_found": [{"parameter": "p", "reason": "no turn"}], "next": "turn it"}})");
  WriteCalibrateReport(folder_);
  const std::string html = Page();
  EXPECT_THAT(html, HasSubstr("<h1>Tip calibration</h1>"));
  EXPECT_THAT(html, HasSubstr("class=\"verdict beware\""));
  EXPECT_THAT(html, HasSubstr("<dd>(1, 2, 3) mm<small>± 0.5 mm</small></dd>"));
  EXPECT_THAT(html, HasSubstr("<dd>7</dd>"));
  EXPECT_THAT(html, HasSubstr("<b>p</b>: no turn"));
  EXPECT_THAT(html, HasSubstr("turn it."));
  // What the verdict says is no warning again.
  EXPECT_THAT(html, HasSubstr("1 warning<"));
  EXPECT_THAT(html, HasSubstr("pose 3: &lt;far off&gt;"));
  EXPECT_LT(html.find("To be used with care"), html.find("1 warning<"));
}

TEST_F(Pages, TablesSayWhatARowIsAboutFirstAndTellLikeColumnsApart) {
  Write("summary.json", R"({"command": "calibrate hand-eye", "version": "1", "warnings": [],
    "views": [{"reason": "", "rms_mm": 0.5, "rms_px": 2, "view": "a.png"}]})");
  WriteCalibrateReport(folder_);
  EXPECT_THAT(Page(), HasSubstr("<th>view</th><th>rms mm</th><th>rms px</th><th>reason</th>"));
}

TEST_F(Pages, SayWhichFileIsWrong) {
  Write("deviation.csv", std::string(kDeviation) + "1700000000,0.5\n");
  try {
    WriteSimulateReport(folder_);
    FAIL() << "no error";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("deviation.csv:4: found 2 fields, expected 8"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report.html"));
  std::filesystem::remove(folder_ / "summary.json");
  EXPECT_THROW(WriteTrackReport(folder_), InputError);
  Write("summary.json", "{torn");
  EXPECT_THROW(WriteTrackReport(folder_), InputError);
}

TEST(ResultFiles, SpreadAFewPicturesOverAll) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("flextip-pictures-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  for (int i = 0; i < 10; ++i) std::ofstream(folder / (std::to_string(i) + ".png")) << "x";
  std::vector<std::string> names;
  for (const auto& path : PicturesIn(folder, 4)) names.push_back(path.stem().string());
  EXPECT_THAT(names, ElementsAre("0", "3", "6", "9"));
  std::filesystem::remove_all(folder);
}

TEST(Labels, SayNumbersInTheUnitsPeopleRead) {
  EXPECT_EQ(Label("max_deviation_m"), "largest deviation");
  EXPECT_EQ(Label("rms_thing_m"), "rms thing");
  EXPECT_EQ(Label("ok", "track"), "frames with the tip seen");
  EXPECT_EQ(Label("ok", "shape"), "shapes solved");
  EXPECT_EQ(SpokenValue("max_deviation_m", 0.00123), "1.23 mm");
  EXPECT_EQ(SpokenValue("rms_reprojection_error_px", 0.19512), "0.195 px");
  EXPECT_EQ(SpokenValue("noise_grey", 2.5), "2.5 grey levels");
  EXPECT_EQ(SpokenValue("tip_share_inside_95", 0.9512), "95.1 %");
  EXPECT_EQ(SpokenValue("frames", 900), "900");
  EXPECT_EQ(Label("frames_per_second"), "frames per second");
}

TEST_F(Pages, LeadWithTheResult) {
  Write("summary.json", R"({"command": "simulate", "version": "1", "controllers": {
    "straight-track": {"max_deviation_m": 0.005, "rms_deviation_m": 0.002},
    "rod-track": {"max_deviation_m": 0.00031, "rms_deviation_m": 0.00012}}})");
  WriteSimulateReport(folder_);
  EXPECT_THAT(Page(), HasSubstr("rod-track keeps the tip within 0.31 mm of the desired path "
                                "(0.12 mm RMS)."));
  EXPECT_THAT(Page(),
              HasSubstr("the worst, straight-track, lets it go 5 mm astray. Knowing that the "
                        "shaft bends divides the deviation by 16."));
  Write("summary.json", R"({"command": "simulate", "version": "1", "controllers": {
    "straight-calculate": {"max_deviation_m": 0.006}, "rod-calculate": {"max_deviation_m": 0.002},
    "straight-track": {"max_deviation_m": 0.001}, "rod-track": {"max_deviation_m": 0.001}}})");
  WriteSimulateReport(folder_);
  EXPECT_THAT(Page(), HasSubstr("astray. Measuring the tip divides the deviation by 6."));
  Write("summary.json", R"({"command": "track", "version": "1", "frames": 120, "ok": 118,
    "verdict": {"grade": "beware", "says": "The tip was seen in 118 of 120 frames",
      "reasons": ["the lens is bent"], "next": "calibrate the camera"}})");
  WriteTrackReport(folder_);
  EXPECT_THAT(Page(), HasSubstr("<section class=\"verdict beware\">\n<p class=\"grade\"><span "
                                "class=\"unseen\">Grade: </span>beware</p>\n<p class=\"says\">The "
                                "tip was seen in 118 of 120 frames</p>"));
  EXPECT_THAT(Page(), HasSubstr("<li>the lens is bent</li>"));
  EXPECT_THAT(Page(), HasSubstr("<b>Next:</b> calibrate the camera."));
  EXPECT_LT(Page().find("The tip was seen in"), Page().find("<dl class=\"figures\">"));
}

TEST_F(Pages, SayTheGradeAndTheNextStepOfCommandsWithoutAVerdict) {
  const auto page = [&](const std::string& summary) {
    Write("summary.json", summary);
    WriteReport(folder_);
    return Page();
  };
  const std::string streams = R"("streams": [{"stream": "wrist0"}, {"stream": "em0"}])";
  const std::string good = page(R"({"command": "check", "version": "1", "wrong": 0, "doubtful": 0,
    "inputs": ["my rec"], "output": "out/check", )" +
                                streams + "}");
  EXPECT_THAT(good, HasSubstr("verdict good\">"));
  EXPECT_THAT(good, HasSubstr("<pre>flextip diagnose &#39;my rec&#39; -o out/check-cause</pre>"));
  const std::string wrong = page(R"({"command": "check", "version": "1", "wrong": 1, "doubtful": 2,
    "inputs": ["rec"], "output": "out/check", "findings": [{"severity": "wrong", "finding":
    "em0.unit", "text": "em0: <mm>", "mend": "multiply"}], )" +
                                 streams + "}");
  EXPECT_THAT(wrong, HasSubstr("</span>beware</p>"));
  EXPECT_THAT(wrong, HasSubstr("not as it says: 1 thing is wrong, 2 doubtful."));
  EXPECT_THAT(wrong, HasSubstr("<pre>flextip check rec -o out/check --force</pre>"));
  EXPECT_THAT(wrong, HasSubstr("em0: &lt;mm&gt; <code>em0.unit</code><br>Mend: multiply"));
  // Of an older summary nobody knows the paths.
  EXPECT_THAT(page(R"({"command": "check", "version": "1", "wrong": 0, "doubtful": 0})"),
              Not(HasSubstr("<pre>")));
  Write("tags.csv", "image,id\n");
  const std::string none = page(R"({"command": "detect", "version": "1", "tags": 0,
    "inputs": ["a.png"], "output": "o", "images": [{"image": "a.png", "tags": 0}]})");
  EXPECT_THAT(none, HasSubstr("verdict not-found\">"));
  EXPECT_THAT(none, HasSubstr("</span>not found</p>"));
}

TEST_F(Pages, AWarningThatTheHeadSaysIsNoWarningAgain) {
  Write("summary.json", R"({"command": "estimate", "version": "1",
    "warnings": ["the port moved", "rare"], "verdict": {"grade": "beware", "says": "Found.",
    "reasons": ["the port moved"]}})");
  WriteEstimateReport(folder_);
  EXPECT_THAT(Page(), HasSubstr("<h3>1 warning</h3>\n<ul>\n<li>rare</li>"));
}

TEST_F(Pages, WordsInTablesBeginAtTheLeft) {
  Write("summary.json", R"({"command": "detect", "version": "1", "tags": 1,
    "images": [{"image": "a.png", "tags": 4, "kind": "grey"}]})");
  WriteDetectReport(folder_);
  EXPECT_THAT(Page(), HasSubstr("<th class=\"text\">kind</th>"));
  EXPECT_THAT(Page(), HasSubstr("<td class=\"text\">grey</td>"));
  EXPECT_THAT(Page(), HasSubstr("<td>4</td>"));
}

TEST_F(Pages, EndWithHowTheyWereMade) {
  Write("summary.json", R"({"command": "detect", "version": "9.8.7", "seconds": 1.5, "tags": 3,
    "typed": "flextip detect 'a b.png' <x>", "date": "2026-11-23T18:50:07Z",
    "inputs": ["a b.png", "camera.yaml"]})");
  WriteDetectReport(folder_);
  const std::string end = Page().substr(Page().find("<footer>"));
  EXPECT_THAT(end, HasSubstr("<dd>flextip detect &#39;a b.png&#39; &lt;x&gt;</dd>"));
  EXPECT_THAT(end, HasSubstr("<dd>a b.png, camera.yaml</dd>"));
  EXPECT_THAT(end, HasSubstr("<dd>2026-11-23 18:50 UTC</dd>"));
  EXPECT_THAT(end, HasSubstr("<dd>1.5 s</dd>"));
  EXPECT_THAT(end, HasSubstr("<dd>flextip 9.8.7</dd>"));
  EXPECT_THAT(Page(), testing::Not(HasSubstr("time taken")));
}

TEST_F(Pages, PutTheImportantNumbersFirst) {
  Write("summary.json", R"({"command": "track", "version": "1", "frames": 120, "ok": 118,
    "aardvark": 1, "tags_per_frame": 3.5, "tip_rms_error_m": 0.0001})");
  WriteTrackReport(folder_);
  const std::string page = Page();
  const auto at = [&](const std::string& text) { return page.find("<dt>" + text + "</dt>"); };
  EXPECT_LT(at("frames with the tip seen"), at("tip error, RMS"));
  EXPECT_LT(at("tip error, RMS"), at("tags a frame"));
  EXPECT_LT(at("tags a frame"), at("aardvark"));
  EXPECT_NE(at("aardvark"), std::string::npos);
}

TEST_F(Pages, AreMadeAgainByTheCommandOfTheSummary) {
  Write("deviation.csv", kDeviation);
  WriteSimulateReport(folder_);
  const std::string before = Page();
  std::filesystem::remove(folder_ / "report.html");
  WriteReport(folder_);
  EXPECT_EQ(Page(), before);
}

TEST_F(Pages, AreNotMadeWithoutTheFilesTheyStandOn) {
  const auto refusal = [&] {
    try {
      WriteReport(folder_);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(refusal(), HasSubstr("no deviation.csv, the page needs it"));
  for (const auto& [command, file] :
       std::map<std::string, std::string>{{"track", "vision0/data.csv"},
                                          {"estimate", "state0/data.csv"},
                                          {"shape", "shapes.csv"},
                                          {"detect", "tags.csv"},
                                          {"diagnose", "diagnosis.json"},
                                          {"map", "figures.json"},
                                          {"reproduce", "figures.json"}}) {
    Write("summary.json", R"({"version": "1", "command": ")" + command + "\"}");
    EXPECT_THAT(refusal(), HasSubstr("no " + file)) << command;
  }
  Write("summary.json", R"({"version": "1", "command": "dance"})");
  EXPECT_THAT(refusal(), HasSubstr("no page is known for the command dance"));
  Write("summary.json", R"({"version": "1"})");
  EXPECT_THAT(refusal(), HasSubstr("states no command"));
  std::filesystem::remove(folder_ / "summary.json");
  EXPECT_THAT(refusal(), HasSubstr("no summary.json, expected a folder"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report.html"));
}

}  // namespace
}  // namespace flextip::report
