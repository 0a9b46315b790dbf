// Results side by side, by summaries whose best is known.
#include "report/compare/comparison.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "core/error.h"

namespace flextip::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Compared : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("flextip-compare-" + std::to_string(getpid()) + "-" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path Run(const std::string& name, const std::string& summary) const {
    Write(name + "/summary.json", summary);
    return folder_ / name;
  }
  void Write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  static const ComparedNumber& Find(const Comparison& comparison, const std::string& key,
                                    const std::string& group = "") {
    for (const auto& number : comparison.numbers)
      if (number.key == key && number.group == group) return number;
    throw std::runtime_error("no number " + key);
  }

  std::filesystem::path folder_;
};

TEST_F(Compared, SaysWhichTrackWasBestAndByHowMuch) {
  const auto before =
      Run("before", R"({"command": "track", "frames": 60, "ok": 50, "tip_rms_error_m": 0.0004})");
  const auto after =
      Run("after", R"({"command": "track", "frames": 60, "ok": 58, "tip_rms_error_m": 0.0001})");
  Write("before/vision0/data.csv", "#timestamp [ns],p_RE_x [m]\n0,0.5\n1000000000,0.51\n");
  Write("after/vision0/data.csv", "#timestamp [ns],p_RE_x [m]\n0,0.4\n1000000000,0.41\n");
  const Comparison comparison = CompareResults({before, after});
  EXPECT_THAT(comparison.names, ElementsAre("before", "after"));
  EXPECT_EQ(comparison.says, "after is best by tip error, RMS: 0.1 mm, against 0.4 mm in before.");
  EXPECT_EQ(Find(comparison, "ok").Best(), 1U);
  EXPECT_EQ(Find(comparison, "frames").Best(), std::nullopt);
  ASSERT_EQ(comparison.figures.size(), 2U);  // bars, and the tip's x
  const FigureTrace& bars = comparison.figures[0].traces.at(0);
  EXPECT_THAT(bars.labels, ElementsAre("before", "after"));
  EXPECT_THAT(bars.y, ElementsAre(0.0004, 0.0001));
  for (const Figure& figure : comparison.figures) EXPECT_NE(FigureText(figure), "");
  const Figure& path = comparison.figures[1];
  ASSERT_EQ(path.traces.size(), 2U);
  EXPECT_EQ(path.traces[1].name, "after");
  EXPECT_NEAR(path.traces[1].y.back(), 410.0, 1e-9);
}

TEST_F(Compared, ATableWithoutTimesIsRefused) {
  std::vector<std::filesystem::path> runs;
  for (const char* name : {"a", "b"}) {
    runs.push_back(Run(name, R"({"command": "track", "frames": 1, "ok": 1})"));
    Write(std::string(name) + "/vision0/data.csv",
          "#timestamp [ns],p_RE_x [m],p_RE_y [m],p_RE_z [m]\nnever,0,0,0\n");
  }
  EXPECT_THROW(CompareResults(runs), InputError);
}

TEST_F(Compared, ControllersAreComparedOneByOne) {
  const auto a = Run("a", R"({"command": "simulate", "controllers": {
    "rod-track": {"max_deviation_m": 0.001}, "flex-track": {"max_deviation_m": 0.002}}})");
  const auto b = Run("b", R"({"command": "simulate", "controllers": {
    "rod-track": {"max_deviation_m": 0.003}, "straight-track": {"max_deviation_m": 0.009}}})");
  const Comparison comparison = CompareResults({a, b});
  EXPECT_EQ(Find(comparison, "max_deviation_m", "rod-track").Best(), 0U);
  EXPECT_EQ(Find(comparison, "max_deviation_m", "flex-track").values[1], std::nullopt);
  EXPECT_EQ(Find(comparison, "max_deviation_m", "flex-track").Best(), std::nullopt);
  EXPECT_THAT(comparison.says, HasSubstr("a is best by rod-track, largest deviation: 1 mm"));
}

TEST_F(Compared, DiagnosesSayTheirAnswers) {
  const auto a = Run("a", R"({"command": "diagnose", "verdict": {"says": "none (95 %)."},
                              "heldout_error_ratio": 1.0})");
  const auto b = Run("b", R"({"command": "diagnose", "heldout_error_ratio": 0.1})");
  const Comparison comparison = CompareResults({a, b});
  EXPECT_THAT(comparison.answers, ElementsAre("none (95 %).", ""));
  EXPECT_EQ(comparison.says, "a: none (95 %). b: no answer.");
  EXPECT_EQ(Find(comparison, "heldout_error_ratio", "").Best(), 1U);
}

TEST_F(Compared, NamesOfOneFolderNameTakeMoreOfThePath) {
  const auto x = Run("x/track", R"({"command": "track", "ok": 1})");
  const auto y = Run("y/track", R"({"command": "track", "ok": 1})");
  const Comparison comparison = CompareResults({x, y});
  EXPECT_THAT(comparison.names, ElementsAre("x/track", "y/track"));
  EXPECT_THAT(comparison.says, HasSubstr("All have the same frames with the tip seen: 1."));
}

TEST_F(Compared, RefusesWhatCannotBeCompared) {
  const auto track = Run("track", R"({"command": "track", "ok": 1})");
  const auto estimate = Run("estimate", R"({"command": "estimate", "samples": 1})");
  const auto refusal = [](const std::vector<std::filesystem::path>& folders) {
    try {
      CompareResults(folders);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(refusal({track, estimate}),
              HasSubstr("a result of estimate, expected one of track as"));
  std::filesystem::create_directory(folder_ / "empty");
  EXPECT_THAT(refusal({track, folder_ / "empty"}), HasSubstr("no summary.json"));
}

}  // namespace
}  // namespace flextip::report
