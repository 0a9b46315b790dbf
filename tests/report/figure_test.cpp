// Figures as data, and the pages that draw them.
#include "report/figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "report/pages.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

class FigureFiles : public testing::Test {
 protected:
  FigureFiles() { fs::create_directories(folder_); }
  ~FigureFiles() override { fs::remove_all(folder_); }
  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  nlohmann::json Written(const Figure& figure) const {
    WriteFigures(folder_ / "figures.json", {figure});
    return nlohmann::json::parse(ReadBytes(folder_ / "figures.json")).at(0);
  }

  fs::path folder_ =
      fs::temp_directory_path() / ("flextip_figures_" + std::to_string(::getpid()) + "_" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST(Segments, GoThroughTheirMiddles) {
  const FigureTrace trace = Segments({1.0, 5.0}, {2.0, 6.0}, {0.2, 0.0}, {0.0, 0.4});
  ASSERT_EQ(trace.x.size(), 6U);
  EXPECT_DOUBLE_EQ(trace.x[0], 0.9);
  EXPECT_DOUBLE_EQ(trace.x[1], 1.1);
  EXPECT_TRUE(std::isnan(trace.x[2]));
  EXPECT_DOUBLE_EQ(trace.y[3], 5.8);
  EXPECT_DOUBLE_EQ(trace.y[4], 6.2);
}

TEST_F(FigureFiles, HoldAFieldRowByRowWithItsGaps) {
  const Figure figure{.name = "fig",
                      .fields = {{.name = "||G||",
                                  .x = {0.0, 1.0, 2.0},
                                  .y = {0.0, 1.0},
                                  .values = {1.0, 2.0, kGap, 4.0, 5.0, 6.0},
                                  .levels = {2.5},
                                  .high = 6.0}}};
  const auto field = Written(figure).at("fields").at(0);
  EXPECT_EQ(field.at("values").dump(), "[[1.0,2.0,null],[4.0,5.0,6.0]]");
  EXPECT_EQ(field.at("low"), nullptr);
  EXPECT_EQ(field.at("high"), 6.0);
}

TEST_F(FigureFiles, HoldBarsByTheirLabels) {
  const Figure figure{.traces = {{.name = "ours",
                                  .kind = FigureTrace::Kind::kBars,
                                  .y = {1.0, 2.0},
                                  .labels = {"straight", "rod"},
                                  .y_error = {0.1, 0.2}}}};
  const auto trace = Written(figure).at("traces").at(0);
  EXPECT_EQ(trace.at("kind"), "bars");
  EXPECT_EQ(trace.at("x").dump(), R"(["straight","rod"])");
  EXPECT_EQ(trace.at("y_error").size(), 2U);
}

TEST_F(FigureFiles, SayWhatIsWrittenBesideAndWhichBarsStandOut) {
  const auto figure = Written({.lying_bars = true,
                               .traces = {{.kind = FigureTrace::Kind::kBars,
                                           .y = {98.0, 2.0},
                                           .labels = {"friction", "none"},
                                           .texts = {"98 %", "2 %"},
                                           .colors = {"#00697d", "#9fb0bf"}},
                                          {.x = {0.0, 1.0}, .y = {0.0, 1.0}, .arrow = true}},
                               .bands = {{1.0, 1.0, "#1d2733"}}});
  EXPECT_EQ(figure.at("lying_bars"), true);
  EXPECT_EQ(figure.at("traces").at(0).at("texts").dump(), R"(["98 %","2 %"])");
  EXPECT_EQ(figure.at("traces").at(0).at("colors").at(1), "#9fb0bf");
  EXPECT_EQ(figure.at("traces").at(1).at("arrow"), true);
  EXPECT_EQ(figure.at("bands").at(0).at("from"), figure.at("bands").at(0).at("to"));
}

TEST_F(FigureFiles, HoldCells) {
  const auto figure =
      Written({.fields = {{.x = {0.5}, .y = {0.5}, .values = {3.0}, .cells = true}}});
  EXPECT_EQ(figure.at("fields").at(0).at("cells"), true);
  EXPECT_EQ(figure.at("fields").at(0).at("values").dump(), "[[3.0]]");
}

TEST_F(FigureFiles, AreDrawnOnThePageBesideTheTable) {
  Written({.name = "fig-2-4a", .title = "Norm < 1", .caption = "Where it converges"});
  Write("summary.json", R"({"command": "reproduce", "version": "0", "warnings": []})");
  Write("table.csv", "quantity,thesis,flextip,unit,note\n\"a, b\",1,2,mm,\"says \"\"so\"\"\"\n");
  WriteReproduceReport(folder_);
  const std::string page = ReadBytes(folder_ / "report.html");
  EXPECT_THAT(page, HasSubstr("class=\"drawing\""));
  EXPECT_THAT(page, HasSubstr("Norm &lt; 1"));
  EXPECT_THAT(page, HasSubstr("<td>a, b</td>"));
  EXPECT_THAT(page, HasSubstr("says &quot;so&quot;"));
}

TEST_F(FigureFiles, ThatAreBrokenAreNamed) {
  Write("summary.json", R"({"command": "map", "version": "0", "warnings": []})");
  Write("figures.json", "{]");
  try {
    WriteMapReport(folder_);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("figures.json"));
  }
}

TEST_F(FigureFiles, WithoutAFolderAreRefused) {
  WriteFigures(folder_ / "none", {});  // a file, which is no folder
  EXPECT_THROW(WriteFigures(folder_ / "none" / "figures.json", {}), WorkError);
}

}  // namespace
}  // namespace flextip::report
