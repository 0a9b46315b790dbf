// flextip shape, as a user runs it.
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

const std::vector<std::string> kShape{"shape",   "--length", "0.6",    "--stiffness", "0.304",
                                      "--wrist", "0,0,0",    "--port", "0.28,0,0"};

std::vector<std::string> With(std::vector<std::string> arguments,
                              const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

const char* kHeader =
    "#length_m,bending_stiffness_Nm2,p_wrist_m_x,p_wrist_m_y,p_wrist_m_z,p_port_m_x,p_port_m_y,"
    "p_port_m_z,f_tip_N_x,f_tip_N_y,f_tip_N_z,q_weight_N_per_m_x,q_weight_N_per_m_y,"
    "q_weight_N_per_m_z\n";

std::vector<std::string> Split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, at);) parts.push_back(part);
  return parts;
}

/// Rows of a table as maps from column to cell.
std::vector<std::map<std::string, std::string>> Rows(const std::string& text) {
  const auto lines = Split(text, '\n');
  auto names = Split(lines.at(0), ',');
  names[0].erase(0, names[0].find_first_not_of('#'));
  std::vector<std::map<std::string, std::string>> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto cells = Split(lines[i] + ",", ',');
    for (std::size_t j = 0; j < names.size(); ++j) {
      if (j == 0) rows.emplace_back();
      rows.back()[names[j]] = cells.at(j);
    }
  }
  return rows;
}

Eigen::Vector3d Vector(const nlohmann::json& list) {
  return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
}

TEST(ShapeCommand, BalancesTheForcesItReports) {
  const auto result =
      RunProgram(With(kShape, {"--force", "-0.3,0.5,-1", "--weight", "0,0,-0.4", "--json"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  const Eigen::Vector3d f_tip = Vector(json["f_tip_N"]), f_port = Vector(json["f_port_on_shaft_N"]),
                        f_wrist = Vector(json["f_wrist_on_shaft_N"]);
  const Eigen::Vector3d weight = 0.6 * Vector(json["q_weight_N_per_m"]);
  EXPECT_LT((f_tip + f_port + f_wrist + weight).norm(), 1e-9);
  EXPECT_GT(f_port.norm(), 1.0);
}

TEST(ShapeCommand, KnowsThreeModels) {
  const auto tip_z = [](const std::string& model) {
    const auto result = RunProgram(With(kShape, {"--force", "0,0,-2", "--json", "--model", model}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out)["p_tip_m"][2].get<double>();
  };
  EXPECT_EQ(tip_z("straight"), 0.0);
  // Small deflections: the beam is about the rod; at 2 N they are some millimetres apart.
  EXPECT_NEAR(tip_z("rod"), tip_z("beam"), 0.02);
  EXPECT_LT(tip_z("rod"), -0.1);
}

TEST(ShapeCommand, WritesEveryColumnOfTheReferenceTable) {
  const std::filesystem::path reference =
      std::filesystem::path(FLEXTIP_SOURCE_DIR) / "testdata/reference/rod_equilibria.csv";
  const TestFolder folder;
  const auto out = (folder / "out").string();
  ASSERT_EQ(RunProgram({"shape", "--batch", reference.string(), "-o", out}).exit_code, 0);
  const auto expected = Rows(ReadText(reference)),
             found = Rows(ReadText(folder / "out/shapes.csv"));
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].at("status"), "ok");
    for (const auto& [column, cell] : expected[i]) {
      const bool force_or_moment = column.ends_with("N_x") || column.ends_with("N_y") ||
                                   column.ends_with("N_z") ||
                                   column.find("Nm_") != std::string::npos;
      const double value = std::stod(cell);
      const double tolerance = force_or_moment ? 1e-8 + 1e-6 * std::abs(value) : 1e-8;
      EXPECT_NEAR(std::stod(found[i].at(column)), value, tolerance) << column << ", row " << i + 1;
    }
  }
}

TEST(ShapeCommand, GivesARowThatCannotBeSolvedItsStatus) {
  const TestFolder folder;
  const auto table = folder.Write("t.csv", std::string(kHeader) +
                                               "0.6,0.304,0,0,0,0.28,0,0,0,0,-1,0,0,0\n"
                                               "0.2,0.304,0,0,0,0.28,0,0,0,0,-1,0,0,0\n"
                                               "-0.6,0.304,0,0,0,0.28,0,0,0,0,-1,0,0,0\n");
  const auto result = RunProgram({"shape", "--batch", table, "-o", (folder / "out").string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto rows = Rows(ReadText(folder / "out/shapes.csv"));
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].at("status"), "ok");
  EXPECT_EQ(rows[1].at("status"), "unreachable");
  EXPECT_EQ(rows[1].at("p_tip_m_x"), "");
  EXPECT_EQ(rows[2].at("status"), "bad_input");
  const auto summary = nlohmann::json::parse(ReadText(folder / "out/summary.json"));
  EXPECT_EQ(summary["ok"], 1);
  EXPECT_EQ(summary["warnings"].size(), 2U);
}

TEST(ShapeCommand, RefusesABadTableWithFileAndLine) {
  const TestFolder folder;
  const auto out = (folder / "out").string();
  const auto refused = [&](const std::string& text, const std::vector<std::string>& parts) {
    return IsRefused(RunProgram({"shape", "--batch", folder.Write("t.csv", text), "-o", out}),
                     parts);
  };
  const std::string good = "0.6,0.304,0,0,0,0.28,0,0,0,0,-1,0,0,0\n";
  const std::string header = kHeader;
  EXPECT_TRUE(
      refused(header + good + "0.6,0.304,0,0,0,0.28,0,0,0,nan,-1,0,0,0\n", {"t.csv:3:", "nan"}));
  EXPECT_TRUE(refused(header + good + "0.6,0.304,0,0,0,0.28\n" + good, {"t.csv:3:"}));
  EXPECT_TRUE(refused("length_m,p_wrist_m_x\n", {"t.csv:1:", "bending_stiffness_Nm2"}));
  EXPECT_TRUE(refused("", {"t.csv"}));
  EXPECT_TRUE(IsRefused(RunProgram({"shape", "--batch", (folder / "none.csv").string(), "-o", out}),
                        {"none.csv"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(ShapeCommand, RefusesAPortOutOfReach) {
  auto arguments = With(kShape, {"--force", "0,0,-1"});
  arguments[8] = "0.7,0,0";
  EXPECT_TRUE(IsRefused(RunProgram(arguments), {"unreachable", "0.7 m from the wrist"}));
}

TEST(ShapeCommand, FailsWithOneOnAShaftThatBuckles) {
  const auto result = RunProgram(With(kShape, {"--force", "-500,0,0.1"}));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, StartsWith("flextip: shape: "));
}

TEST(ShapeCommand, TakesAndPrintsMillimetres) {
  const auto si = RunProgram(With(kShape, {"--tip-force", "0,0,-2"}));
  const auto mm = RunProgram({"shape", "--length", "600mm", "--stiffness", "0.304", "--wrist",
                              "0,0,0", "--port", "28cm,0mm,0", "--tip-force", "0,0,-2"});
  EXPECT_EQ(mm.exit_code, 0) << mm.err;
  EXPECT_EQ(mm.out, si.out);
  const auto printed = RunProgram(With(kShape, {"--tip-force", "0,0,-2", "--unit", "mm"}));
  double m = 0.0, in_mm = 0.0;
  ASSERT_EQ(std::sscanf(si.out.c_str(), "tip (m) %lf", &m), 1) << si.out;
  ASSERT_EQ(std::sscanf(printed.out.c_str(), "tip (mm) %lf", &in_mm), 1) << printed.out;
  EXPECT_NEAR(in_mm, 1e3 * m, 1e-3);
  EXPECT_TRUE(IsRefused(RunProgram({"shape", "--length", "600 miles"}), {"--length", "miles"}));
}

TEST(ShapeCommand, RefusesWrongUsage) {
  EXPECT_TRUE(IsRefused(RunProgram({"shape"}), {"--length is required"}));
  EXPECT_TRUE(IsRefused(RunProgram(With(kShape, {"--force", "1,2"})), {"'1,2' is not x,y,z"}));
  EXPECT_TRUE(IsRefused(RunProgram(With(kShape, {"--tip-force", "1,2"})), {"'1,2' is not x,y,z"}));
  EXPECT_TRUE(IsRefused(RunProgram(kShape), {"--tip-force X,Y,Z is required"}));
  EXPECT_TRUE(IsRefused(RunProgram(With(kShape, {"--force", "1,2,nan"})), {"is not x,y,z"}));
  EXPECT_TRUE(
      IsRefused(RunProgram(With(kShape, {"--force", "0,0,1", "--model", "jelly"})), {"jelly"}));
  EXPECT_TRUE(IsRefused(RunProgram({"shape", "--batch", "t.csv"}), {"-o OUT"}));
  EXPECT_TRUE(IsRefused(RunProgram({"shape", "--length", "-1"}), {"--length"}));
  EXPECT_TRUE(IsRefused(RunProgram(With(kShape, {"--force", "0,0,1", "--plot", "shape.txt"})),
                        {"--plot", ".png, .svg, .pdf or .html"}));
}

TEST(ShapeCommand, DrawsAPictureAndAPage) {
  const TestFolder folder;
  const auto plot = (folder / "shape.html").string();
  const auto out = (folder / "out").string();
  const auto arguments = With(kShape, {"--force", "0,0,-2", "--plot", plot, "-o", out});
  ASSERT_EQ(RunProgram(arguments).exit_code, 0);
  const auto figures = nlohmann::json::parse(ReadText(folder / "out/figures.json"));
  ASSERT_EQ(figures.size(), 2U);
  for (const auto& page : {ReadText(plot), ReadText(folder / "out/report.html")}) {
    EXPECT_THAT(page, HasSubstr("Plotly.newPlot"));
    for (const auto& figure : figures) EXPECT_THAT(page, HasSubstr(figure.dump()));
  }
  EXPECT_THAT(ReadText(folder / "out/shape.png"), StartsWith("\x89PNG"));
  // Seen from the side, the tip hangs below the wrist and the force points at it.
  const auto& side = figures[0]["traces"];
  EXPECT_EQ(side[1]["name"], "shaft");
  EXPECT_LT(side[1]["y"].back().get<double>(), -10.0);
  EXPECT_EQ(side[4]["texts"][0], "tip");
  EXPECT_EQ(side[5]["name"], "force on the tip, 2 N");
  EXPECT_EQ(side[5]["y"].back(), side[4]["y"].back());
  EXPECT_GT(side[5]["y"].front(), side[5]["y"].back());
  // From above the force points away from the viewer.
  for (const auto& trace : figures[1]["traces"]) EXPECT_FALSE(trace.contains("arrow"));
  EXPECT_TRUE(PageIsMadeAgain(folder / "out"));
  EXPECT_TRUE(IsRefused(RunProgram(arguments), {"--force replaces it"}));
  EXPECT_EQ(RunProgram(With(arguments, {"--force"})).exit_code, 0);
  EXPECT_EQ(RunProgram(With(arguments, {"--overwrite"})).exit_code, 0);
}

}  // namespace
}  // namespace flextip
