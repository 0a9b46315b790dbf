// The page of flextip control.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "report/pages.h"
#include "report/result_files.h"
#include "tests/report/page_plots.h"

namespace flextip::report {
namespace {

using testing::HasSubstr;
using testing::Not;

const char* kCycles =
    "#timestamp [ns],hold,p_RE [m]_0,p_RE [m]_1,p_RE [m]_2,goal [m]_0,goal [m]_1,goal [m]_2\n"
    "1000000000,5,0,0,0,,,\n"
    "1010000000,0,0.1,0,0,0.1,0.003,0.004\n"
    "1020000000,0,0.1,0,0.001,0.1,0,0\n"
    "1030000000,5,0.2,0,0,0.1,0,0\n";

class ControlPage : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("flextip-control-page-" + std::to_string(getpid()) + "-" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_ / "session0");
    Write("session0/cycles.csv", kCycles);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  void Summarise(bool only_timing, bool done, int missed) const {
    const nlohmann::json times{{"count", 4},
                               {"p50_s", 0.00012},
                               {"p99_s", 0.0004},
                               {"p99.9_s", 0.001},
                               {"worst_s", 0.002}};
    Write("summary.json",
          nlohmann::json{{"command", "control"},
                         {"inputs", {"here/session.yaml"}},
                         {"output", "out/live"},
                         {"only_timing", only_timing},
                         {"path_done", done},
                         {"robot_not_enabled_at_end", true},
                         {"duration_s", 12.0},
                         {"cycles", 4},
                         {"missed_cycles", missed},
                         {"unsent_commands", 0},
                         {"holds", {{"none", 2}, {"not_enabled", 7}, {"stopped", 0}}},
                         {"limited", {{"speed", 3}}},
                         {"work", times},
                         {"wake_late", times},
                         {"sample_to_command", {{"count", 0}}}}
              .dump());
  }
  std::string Page() const {
    WriteReport(folder_);
    return ReadBytes(folder_ / "report.html");
  }
  std::vector<nlohmann::json> Plots() const { return PlotsIn(Page()); }

  std::filesystem::path folder_;
};

TEST_F(ControlPage, SaysWhetherThePathWasDoneAndShowsHoldsAndTimes) {
  Summarise(false, true, 0);
  const std::string page = Page();
  EXPECT_THAT(page, HasSubstr("<section class=\"verdict good\">"));
  EXPECT_THAT(page, HasSubstr("The tip followed its path to the end, in 12 s."));
  EXPECT_THAT(page, HasSubstr("takes 0.12 ms, 99 % of them at most 0.4 ms"));
  EXPECT_THAT(page, HasSubstr("flextip diagnose out/live -o out/live-cause"));
  EXPECT_LT(page.find("not_enabled"), page.find("<td>none</td>"));
  EXPECT_THAT(page, HasSubstr("cycle begun to command sent"));
  EXPECT_THAT(page, Not(HasSubstr("wrist's sample to command sent")));  // was not taken
}

TEST_F(ControlPage, DrawsTheTipWhereNothingHeldTheRobot) {
  Summarise(false, true, 0);
  const auto plots = Plots();
  ASSERT_EQ(plots.size(), 2u);  // without figures.json
  const auto& distance = plots[0]["traces"][0]["y"];
  std::vector<double> found;
  for (const auto& y : distance)
    if (y.is_number()) found.push_back(y.get<double>());
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0], 5.0, 1e-9);  // mm: 3, 4
  EXPECT_NEAR(found[1], 1.0, 1e-9);
}

TEST_F(ControlPage, SaysWhatWentWrong) {
  Summarise(false, false, 3);
  const std::string page = Page();
  EXPECT_THAT(page, HasSubstr("<section class=\"verdict beware\">"));
  EXPECT_THAT(page, HasSubstr("The run ended after 12 s, before the path was done."));
  EXPECT_THAT(page, HasSubstr("3 missed cycles"));
}

TEST_F(ControlPage, OfTimesAloneGoesOnWithWatching) {
  Summarise(true, false, 0);
  std::string page = Page();
  EXPECT_THAT(page, HasSubstr("None of 4 cycles was missed."));
  EXPECT_THAT(page, HasSubstr("flextip control here/session.yaml --wait --page"));
  Summarise(true, false, 1);
  page = Page();
  EXPECT_THAT(page, HasSubstr("1 of 4 cycles were missed."));
}

TEST_F(ControlPage, NeedsTheCycles) {
  Summarise(false, true, 0);
  std::filesystem::remove(folder_ / "session0/cycles.csv");
  EXPECT_THROW(WriteReport(folder_), InputError);
}

}  // namespace
}  // namespace flextip::report
