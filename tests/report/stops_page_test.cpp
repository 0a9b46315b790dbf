// What stopped a run, on its page.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "recording/text/text.h"
#include "report/pages.h"
#include "report/result_files.h"
#include "tests/report/page_plots.h"

namespace flextip::report {
namespace {

using testing::HasSubstr;
using testing::Not;

const char* kSays = "Held at 0.20 s by tip_disagrees: the tip by the camera was 8.0 mm from EM.";

/// Eleven cycles at 20 Hz; the camera is 8 mm aside from the third on, and out from the fifth on.
std::string Table() {
  std::string text = "#timestamp [ns],time [s]";
  for (const char* name :
       {"wanted", "used", "tip", "em0", "em1", "strain", "load0", "wrist_orientation", "rest"}) {
    for (const char* axis : {"x", "y", "z"})
      text += std::string(",p_RE_") + name + "_" + axis + " [m]";
  }
  text += ",sensors [],out [],chi2 [],chi2_limit [],worst_angle [rad],reaction [],stop []\n";
  for (int i = 0; i < 11; ++i) {
    const double z = 0.001 * i;
    const std::string place = "0.1,0," + NumberText(z);
    const std::string camera = i < 2 ? place : "0.1,0.008," + NumberText(z);
    const std::string none = ",,";
    text += std::to_string(1000000000LL + 50000000LL * i) + "," + NumberText(0.05 * i);
    for (const std::string& p : {place, place, camera, place, none, none, none, none, place})
      text += "," + p;
    text += i < 4   ? ",3,0,5,30,0,none,none\n"
            : i < 8 ? ",3,1,90,30,0,hold,tip_disagrees\n"
                    : ",3,1,90,30,0,fault,tip_disagrees\n";
  }
  return text;
}

class StopsPage : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("flextip-stops-page-" + std::to_string(getpid()) + "-" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    WriteTextFile(folder_ / "deviation.csv",
                  "#timestamp [ns],p_desired_x [m],p_desired_y [m],p_desired_z [m],p_RE_x [m],"
                  "p_RE_y [m],p_RE_z [m],deviation [m]\n1,0,0,0,0,0,0,0\n2,0,0,0,0,0,0,0\n");
    WriteTextFile(
        folder_ / "summary.json",
        nlohmann::json{
            {"command", "simulate"},
            {"inputs", {"scenario.yaml"}},
            {"output", "out"},
            {"controllers",
             {{"flex-track",
               {{"max_deviation_m", 0.001}, {"rms_deviation_m", 0.001}, {"updates", 2}}}}}}
            .dump());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void AddExcerpt(int number, const std::string& says, const std::string& table = Table()) const {
    const auto excerpt = folder_ / "stops" / (std::to_string(number) + "_tip_disagrees");
    WriteTextFile(excerpt / "stop.csv", table);
    WriteTextFile(excerpt / "summary.json", nlohmann::json{{"command", "excerpt"},
                                                           {"says", says},
                                                           {"stop",
                                                            {{"cause", "tip_disagrees"},
                                                             {"at_s", 0.2},
                                                             {"fault_s", 0.4},
                                                             {"end_s", 0.5},
                                                             {"odd", "tip"}}}}
                                                .dump());
  }
  std::string Page() const {
    WriteReport(folder_);
    return ReadBytes(folder_ / "report.html");
  }
  /// The plot of that name, empty where there is none.
  nlohmann::json Plot(const std::string& name) const {
    for (const auto& plot : PlotsIn(Page()))
      if (plot.value("name", "") == name) return plot;
    return {};
  }
  void ExpectRefused(const std::string& says) const {
    try {
      WriteReport(folder_);
      FAIL() << "expected: " << says;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(says));
    }
  }

  std::filesystem::path folder_;
};

TEST_F(StopsPage, SaysFirstWhatStoppedTheRun) {
  AddExcerpt(1, kSays);
  const std::string page = Page();
  EXPECT_THAT(page, HasSubstr("Held at 0.20 s by tip_disagrees"));
  EXPECT_LT(page.find("Held at 0.20 s"), page.find("flex-track keeps"));
  EXPECT_LT(page.find("What stopped it"), page.find("Which controller keeps"));
  // Once: the head says it.
  EXPECT_EQ(page.find("Held at 0.20 s"), page.rfind("Held at 0.20 s"));
}

TEST_F(StopsPage, ShowsTheSensorThatWentAway) {
  AddExcerpt(1, kSays);
  const auto distance = Plot("stop1-distance");
  ASSERT_EQ(distance["traces"].size(), 2U);  // camera and EM
  EXPECT_EQ(distance["traces"][0]["name"], "camera");
  EXPECT_NEAR(distance["traces"][0]["y"].back().get<double>(), 8.0, 1e-9);
  EXPECT_NEAR(distance["traces"][1]["y"].back().get<double>(), 0.0, 1e-9);
  const auto ratio = Plot("stop1-chi2");
  EXPECT_NEAR(ratio["traces"][0]["y"].back().get<double>(), 3.0, 1e-9);
  const auto strips = Plot("stop1-strips");
  EXPECT_EQ(strips["y_names"], (nlohmann::json{"camera", "EM", "robot"}));
  std::vector<std::string> names;
  for (const auto& trace : strips["traces"]) names.push_back(trace["name"]);
  EXPECT_THAT(names, testing::ElementsAre("used, goes on", "left out", "held", "paused"));
  // The camera is out from 0.2 s on.
  EXPECT_NEAR(strips["traces"][1]["x"][0].get<double>(), 0.2, 1e-9);
  EXPECT_FALSE(Plot("stop1-path").empty());
}

TEST_F(StopsPage, SaysHowManyStopsHaveNoPicture) {
  for (int i = 1; i <= 5; ++i) AddExcerpt(i, "Held at " + std::to_string(i) + ".00 s by tip_jump.");
  const std::string page = Page();
  EXPECT_THAT(page, HasSubstr("Stop 3 of 5"));
  EXPECT_THAT(page, Not(HasSubstr("Stop 4 of 5")));
  EXPECT_THAT(page, HasSubstr("2 more stops"));
  EXPECT_THAT(page, HasSubstr("Held at 5.00 s"));
}

TEST_F(StopsPage, ARunWithoutAStopHasNoSuchSection) {
  EXPECT_THAT(Page(), Not(HasSubstr("stopped it")));
}

TEST_F(StopsPage, AnExcerptHasItsOwnPage) {
  AddExcerpt(1, kSays);
  const auto excerpt = folder_ / "stops/1_tip_disagrees";
  WriteReport(excerpt);
  const std::string page = ReadBytes(excerpt / "report.html");
  EXPECT_THAT(page, HasSubstr(kSays));
  EXPECT_EQ(PlotsIn(page).size(), 4U);
}

TEST_F(StopsPage, ALackingColumnIsOneMessage) {
  std::string table = Table();
  table.replace(table.find("chi2_limit"), 10, "chi2_bound");
  AddExcerpt(1, kSays, table);
  ExpectRefused("stop.csv:1: has no column chi2_limit");
}

TEST_F(StopsPage, AnUnknownReactionIsOneMessage) {
  std::string table = Table();
  table.replace(table.find("hold,tip"), 4, "hope");
  AddExcerpt(1, kSays, table);
  ExpectRefused("reaction: found 'hope'");
}

TEST_F(StopsPage, ADamagedSummaryIsOneMessage) {
  AddExcerpt(1, kSays);
  std::ofstream(folder_ / "stops/1_tip_disagrees/summary.json") << "{\"says\":";
  ExpectRefused("damaged");
}

}  // namespace
}  // namespace flextip::report
