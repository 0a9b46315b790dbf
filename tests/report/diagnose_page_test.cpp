#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <regex>

#include "core/error.h"
#include "report/diagnose/residuals.h"
#include "report/embedded/embedded.h"
#include "tests/report/diagnose_fixture.h"

namespace flextip::report {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A table in which em0's y follows the sign of the sliding velocity with the base model, and
/// nothing else is more than white noise; every other vision sample is absent.
std::string Residuals(int samples, double friction) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  std::string text =
      "#t_s,insertion_depth,sliding_velocity,base.em0_position_m.0,base.em0_position_m.1,"
      "base.vision0_position_m.0,extended.em0_position_m.0,extended.em0_position_m.1,"
      "extended.vision0_position_m.0\n";
  for (int k = 0; k < samples; ++k) {
    const double t = 0.02 * k, velocity = 0.05 * std::cos(t);
    const double x = noise(random), y = noise(random);
    const std::string seen = k % 2 == 0 ? std::to_string(noise(random)) : "";
    text += std::to_string(t) + "," + std::to_string(0.3 + 0.05 * std::sin(t)) + "," +
            std::to_string(velocity) + "," + std::to_string(x) + "," +
            std::to_string(y + std::copysign(friction, velocity)) + "," + seen + "," +
            std::to_string(x) + "," + std::to_string(y) + "," + seen + "\n";
  }
  return text;
}

/// The page without the plotting library.
std::string Own(std::string html) {
  for (const auto plotly : {PlotlyJs(), PlotlyFlatJs()}) {
    const auto at = html.find(plotly);
    if (at != std::string::npos) html.erase(at, plotly.size());
  }
  return html;
}

TEST_F(DiagnosePage, StandsByItselfAndStatesTheVerdict) {
  Write("residuals.csv", Residuals(1000, 5.0));
  const std::string html = Page(Friction()), own = Own(html);
  EXPECT_THAT(html, HasSubstr("Plotly.newPlot"));
  EXPECT_FALSE(
      std::regex_search(own, std::regex("https?://|src=\"(?!data:)|<link|@import|url\\(")));
  EXPECT_THAT(own, HasSubstr("<title>Diagnosis: port friction</title>"));
  EXPECT_THAT(own, HasSubstr("coefficient 0.213 ± 0.011 (98 %)"));
  EXPECT_THAT(own, HasSubstr("flextip diagnose rec</p>"));
  EXPECT_THAT(own, HasSubstr("the strain gages say nothing"));
  EXPECT_LT(own.find("coefficient 0.213"), own.find("the strain gages"));
}

TEST_F(DiagnosePage, HasGradeReasonsAndNextStepInItsHead) {
  Write("summary.json", R"({"command": "diagnose", "version": "1", "warnings": ["a caveat", "rare"],
    "verdict": {"grade": "beware", "says": "port_friction (98 %).", "reasons": ["a caveat"],
      "next": "let the estimator use the model", "command": "flextip estimate rec -o better"}})");
  auto json = Friction();
  json["warnings"] = {"a caveat"};
  const std::string own = Own(Page(json));
  const auto head_end = own.find("</section>");
  EXPECT_THAT(own.substr(0, head_end), HasSubstr("</span>beware</p>"));
  EXPECT_LT(own.find("coefficient 0.213 ± 0.011 (98 %)"), head_end);
  EXPECT_LT(own.find("<li>a caveat</li>"), head_end);
  EXPECT_EQ(own.find("a caveat", head_end), std::string::npos);  // once on the page
  EXPECT_LT(own.find("<pre>flextip estimate rec -o better</pre>"), head_end);
  EXPECT_GT(own.find("<li>rare</li>"), head_end);
}

TEST_F(DiagnosePage, NeverCallsAModelThatMissesSomethingNearlyCertain) {
  auto json = Friction();
  json["probabilities"]["port_friction"] = 0.9996;
  json["presence"]["port_friction"] = 0.9996;
  EXPECT_THAT(Own(Page(json)), HasSubstr("&gt; 99 %"));
  json["adequate"] = false;
  const std::string own = Own(Page(json));
  EXPECT_THAT(own, Not(HasSubstr("> 99 %")));
  EXPECT_THAT(own, Not(HasSubstr("&gt; 99 %")));
  EXPECT_THAT(own, HasSubstr("nearly all"));
}

TEST_F(DiagnosePage, WhereNoModelComesNearThatIsTheAnswer) {
  Write("summary.json", R"({"command": "diagnose", "version": "1", "verdict": {
    "grade": "not found", "says": "No model of this instrument comes near the recording."}})");
  const std::string own = Own(Page(Friction()));
  EXPECT_THAT(own, HasSubstr("<title>Diagnosis: no answer</title>"));
  EXPECT_THAT(own, HasSubstr("<p class=\"says\">No model of this instrument comes near"));
  EXPECT_THAT(own, Not(HasSubstr("98 %")));
}

TEST_F(DiagnosePage, AlwaysShowsNoneAndUnknown) {
  auto json = Friction();
  for (int i = 0; i < 20; ++i) {
    std::string name = "e";
    name += std::to_string(i);
    json["probabilities"][name] = 0.01;
  }
  const std::string html = Page(json);
  const Json bars = Plot(html, "How likely each answer is")["traces"][0];
  const auto labels = bars["x"].get<std::vector<std::string>>();
  EXPECT_THAT(labels, Contains("none"));
  EXPECT_THAT(labels, Contains("unknown"));
  EXPECT_THAT(labels, Not(Contains("e9")));
  const auto verdict = std::find(labels.begin(), labels.end(), "port friction") - labels.begin();
  EXPECT_DOUBLE_EQ(bars["y"][verdict].get<double>(), 98.1);
  EXPECT_EQ(bars["texts"][verdict], "98 %");
  const auto colors = bars["colors"].get<std::vector<std::string>>();
  EXPECT_EQ(std::count(colors.begin(), colors.end(), colors[verdict]), 1);  // it alone is darker
}

TEST_F(DiagnosePage, CountsParametersInTolerances) {
  const std::string html = Page(Friction());
  EXPECT_THAT(html,
              HasSubstr("<td class=\"text\">coefficient</td><td>0.213 ± 0.011</td><td>0.03</td>"
                        "<td>7.1</td>"));
  // Folded: what moved by more than half a tolerance, which is the y of three components.
  EXPECT_THAT(html, HasSubstr("2 parameters moved within tolerance"));
  EXPECT_THAT(html, HasSubstr("<td>offset y</td><td>-0.16 ± 0.05 mm</td><td>0.2 mm</td>"
                              "<td>0.8</td>"));
  EXPECT_THAT(html, HasSubstr("<td>scale</td><td>1.013 ± 0.006</td>"));  // nominal is one
  EXPECT_THAT(html, Not(HasSubstr("<td>offset x</td>")));
}

TEST_F(DiagnosePage, ShowsErrorsInReadableUnits) {
  auto json = Friction();
  std::string html = Page(json);
  EXPECT_THAT(html,
              HasSubstr("<td>EM position</td><td>0.9</td><td>0.14</td><td class=\"text\">mm</td>"));
  EXPECT_THAT(
      html,
      HasSubstr("<td>strain</td><td>4</td><td>1</td><td class=\"text\">mN m</td><td>0.25</td>"));
  EXPECT_THAT(html, Not(HasSubstr("in units of noise")));  // neither noise nor residuals known
  json["noise_sd"] = {{"em0_position_m", 0.0002}};
  html = Page(json);
  EXPECT_THAT(html, HasSubstr("Held-out error, in units of noise"));
  const Json errors = Plot(html, "Held-out error, in units of noise")["traces"];
  EXPECT_EQ(errors[0]["x"].dump(), R"(["EM position"])");
  EXPECT_EQ(errors[0]["texts"][0], "4.50");
  EXPECT_EQ(errors[1]["texts"][0], "0.70");
  json.erase("noise_sd");
  Write("residuals.csv", Residuals(1000, 5.0));
  EXPECT_THAT(Page(json), HasSubstr("Error by channel over the whole recording"));
}

TEST_F(DiagnosePage, DrawsTheStrongestPatternOfTheTellingComponent) {
  Write("residuals.csv", Residuals(1000, 5.0));
  const auto html = Page(Friction());
  EXPECT_THAT(html, HasSubstr("The strongest pattern: EM position, 2 against sliding velocity"));
  const auto plots = Plots(html);
  ASSERT_EQ(plots.size(), 6U);  // probabilities, presence, pattern, time, errors, memory
  const auto& means = plots[2]["traces"][2];
  EXPECT_EQ(means["name"], "base, mean");
  EXPECT_NEAR(means["y"].front().get<double>(), -5.0, 0.6);  // 5 sd of the mean of 50
  EXPECT_NEAR(means["y"].back().get<double>(), 5.0, 0.6);
  EXPECT_NEAR(plots[2]["traces"][3]["y"].back().get<double>(), 0.0, 0.6);
  EXPECT_EQ(plots[2]["x_label"], "sliding velocity (mm/s)");
  EXPECT_THAT(html, HasSubstr("within the band in every channel"));
}

TEST_F(DiagnosePage, StaysSmallWithALongRecordingAndKeepsSpikes) {
  std::string table = Residuals(40000, 1.0);
  table += "800.0,0.3,0.01,0,77.0,0,0,0,0\n";
  Write("residuals.csv", table);
  const auto html = Page(Friction());
  for (const auto& plot : Plots(html)) {
    for (const auto& trace : plot["traces"]) EXPECT_LE(trace["x"].size(), 1500U);
  }
  EXPECT_LT(Own(html).size(), 500000U);
  const auto y = Plots(html).at(3)["traces"][0]["y"].get<std::vector<double>>();
  EXPECT_EQ(*std::max_element(y.begin(), y.end()), 77.0);
}

TEST_F(DiagnosePage, TakesTextForTextAndNotForHtml) {
  auto json = Friction();
  json["summaries"]["port_friction"] = "<img src=x>";
  json["separating_motion"] = "</script><script>alert(1)</script>";
  json["residual_signature"][0]["channel"] = "<b>c";
  json["catalogue"] = {"<i>e"};
  json["warnings"] = {"<u>w"};
  const std::string html = Own(Page(json));
  for (const char* raw : {"<img src=x>", "<script>alert", "<b>c", "<i>e", "<u>w"}) {
    EXPECT_THAT(html, Not(HasSubstr(raw)));
  }
  EXPECT_THAT(html, HasSubstr("&lt;img src=x&gt;"));
}

TEST_F(DiagnosePage, IsMadeOfTheLeastAnswerToo) {
  const std::string html = Page({{"verdict", "none"}, {"probabilities", {{"none", 0.9}}}});
  EXPECT_THAT(html, HasSubstr("Nothing is wrong beyond tolerance"));
}

TEST_F(DiagnosePage, ShowsSeveralRecordingsAndWhatBegan) {
  Json diagnosis = Friction();
  EXPECT_THAT(Page(diagnosis), Not(HasSubstr("Recording by recording")));
  diagnosis["recordings"] = {"monday", "friday"};
  diagnosis["presence_in"] = {
      {"port_friction", {0.98, 0.97}}, {"port_offset", {0.001, 0.96}}, {"length", {0.001, 0.002}}};
  diagnosis["changes"] = {
      {{"effect", "port_offset"},
       {"first_in", "friday"},
       {"probability", 0.96},
       {"parameters", {{"offset_m", {{"value", {0.0, 0.002, 0.0}}, {"sd", {1e-4, 1e-4, 1e-4}}}}}}}};
  const std::string html = Page(diagnosis);
  EXPECT_THAT(html, HasSubstr("Port offset began in friday (96 %). Before that: "));
  EXPECT_THAT(html, HasSubstr("2.00 ± 0.10 mm"));
  EXPECT_THAT(html, HasSubstr("<td>monday</td>"));
  const auto table = html.substr(html.find("Effects by recording"));
  EXPECT_THAT(table.substr(0, table.find("</table>")), Not(HasSubstr("length")));
}

TEST_F(DiagnosePage, SaysWhichFileIsWrong) {
  Write("diagnosis.json", R"({"verdict": 3})");
  try {
    WriteDiagnoseReport(folder_);
    FAIL() << "no error";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("diagnosis.json"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report.html"));
  std::filesystem::remove(folder_ / "diagnosis.json");
  EXPECT_THROW(WriteDiagnoseReport(folder_), InputError);
}

/// AR(1) noise has the autocorrelation phi^lag.
TEST(ResidualMemory, TellsNoiseThatRemembersFromWhite) {
  std::mt19937 random(11);
  std::normal_distribution<double> noise;
  ResultTable table{.names = {"t_s", "base.a.0", "extended.a.0", "base.b.0", "extended.b.0"},
                    .numbers = std::vector<std::vector<double>>(5),
                    .texts = {}};
  double ar = 0.0;
  for (int k = 0; k < 20000; ++k) {
    ar = 0.8 * ar + noise(random);
    const double white = noise(random);
    const double row[] = {0.01 * k, ar, ar, white, white};
    for (std::size_t i = 0; i < 5; ++i) table.numbers[i].push_back(row[i]);
  }
  const auto memory = ResidualMemory(table, "extended");
  ASSERT_EQ(memory.plot.traces.size(), 3U);  // two channels and the band
  for (std::size_t lag = 1; lag <= 5; ++lag) {
    EXPECT_NEAR(memory.plot.traces[0].y.at(lag - 1), std::pow(0.8, double(lag)), 0.05);
  }
  EXPECT_NEAR(memory.plot.traces[0].x.at(2), 0.03, 1e-9);
  ASSERT_EQ(memory.not_white.size(), 1U);
  EXPECT_THAT(memory.not_white[0], HasSubstr("a (0.8"));
}

}  // namespace
}  // namespace flextip::report
