#include "report/report.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/error.h"
#include "report/embedded/embedded.h"

namespace flextip::report {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The JSON of each plot in a page.
std::vector<nlohmann::json> PlotsOf(const std::string& html) {
  const std::string begin = "<script type=\"application/json\">", end = "</script>";
  std::vector<nlohmann::json> plots;
  for (auto at = html.find(begin); at != std::string::npos; at = html.find(begin, at)) {
    at += begin.size();
    plots.push_back(nlohmann::json::parse(html.substr(at, html.find(end, at) - at)));
  }
  return plots;
}

/// The page without the plotting library, which has addresses of its own that it does not call.
std::string WithoutPlotly(std::string html) {
  for (const auto plotly : {PlotlyJs(), PlotlyFlatJs()}) {
    const auto at = html.find(plotly);
    if (at != std::string::npos) html.erase(at, plotly.size());
  }
  return html;
}

TEST(Base64, AgreesWithTheStandardsExamples) {  // RFC 4648, section 10
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Base64(std::string("\xFB\xFF\x00", 3)), "+/8A");
}

TEST(Report, HasPlotlyInsideAndNothingFromANetwork) {
  Report report("title", "subtitle");
  report.AddFigure({.title = "p", .traces = {{.name = "t", .x = {1, 2}, .y = {3, 4}}}});
  report.AddPictures({{"\x89PNG", "caption"}});
  const std::string html = report.Html();
  EXPECT_THAT(html, HasSubstr("Plotly.newPlot"));
  EXPECT_GT(PlotlyJs().size(), 1000000U);
  EXPECT_GT(PlotlyFlatJs().size(), 1000000U);
  const std::string own = WithoutPlotly(html);
  EXPECT_LT(own.size(), 50000U);
  EXPECT_FALSE(
      std::regex_search(own, std::regex("https?://|src=\"(?!data:)|<link|@import|url\\(")));
}

TEST(Report, LeavesPlotlyOutWhereNothingIsPlotted) {
  Report report("title");
  report.AddHeading("no plot here");
  EXPECT_LT(report.Html().size(), 50000U);
}

TEST(Report, KeepsEveryNumberOfAPlot) {
  const double third = 1.0 / 3.0, nan = std::numeric_limits<double>::quiet_NaN();
  Report report("title");
  report.AddFigure(
      {.x_label = "time (s)",
       .traces = {{.name = "a", .x = {0, third, 2}, .y = {1e-17, nan, -5}, .dashed = true}}});
  report.AddFigure({.traces = {{.name = "b", .x = {1}, .y = {2}, .z = {3}, .color = "red"}}});
  const auto plots = PlotsOf(report.Html());
  ASSERT_EQ(plots.size(), 2U);
  EXPECT_EQ(plots[0]["x_label"], "time (s)");
  EXPECT_EQ(plots[0]["traces"][0]["x"][1].get<double>(), third);
  EXPECT_EQ(plots[0]["traces"][0]["y"][0].get<double>(), 1e-17);
  EXPECT_TRUE(plots[0]["traces"][0]["y"][1].is_null());
  EXPECT_EQ(plots[0]["traces"][0]["dashed"], true);
  EXPECT_FALSE(plots[0]["traces"][0].contains("z"));
  EXPECT_EQ(plots[1]["traces"][0]["z"][0].get<double>(), 3.0);
}

TEST(Report, TakesTheLargerPlotlyOnlyForPathsInSpace) {
  Report flat("title"), space("title");
  flat.AddFigure({.traces = {{.x = {1}, .y = {2}}}});
  space.AddFigures(
      {{.traces = {{.x = {1}, .y = {2}}}}, {.traces = {{.x = {1}, .y = {2}, .z = {3}}}}});
  EXPECT_THAT(flat.Html(), HasSubstr(std::string(PlotlyFlatJs())));
  EXPECT_THAT(space.Html(), HasSubstr(std::string(PlotlyJs())));
  EXPECT_THAT(space.Html(), Not(HasSubstr(std::string(PlotlyFlatJs()))));
}

TEST(Report, TakesTextForTextAndNotForHtml) {
  Report report("<b>&title", "'sub\"");
  report.AddWarnings({"<img src=x>"});
  report.AddTable({.header = {"<h>"}, .rows = {{"a<b"}}});
  report.AddFigure(
      {.traces = {{.name = "</script><script>alert(1)</script>", .x = {1}, .y = {1}}}});
  const std::string html = WithoutPlotly(report.Html());
  EXPECT_THAT(html, HasSubstr("<title>&lt;b&gt;&amp;title</title>"));
  EXPECT_THAT(html, Not(HasSubstr("<img src=x>")));
  EXPECT_THAT(html, HasSubstr("<td>a&lt;b</td>"));
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_EQ(PlotsOf(html).at(0)["traces"][0]["name"], "</script><script>alert(1)</script>");
}

TEST(Report, ShowsPicturesAsTheyAre) {
  Report report("title");
  report.AddPictures({{"\x89PNG123", "one"}, {"\xFF\xD8jpeg", "two"}});
  const std::string html = report.Html();
  EXPECT_THAT(html, HasSubstr("src=\"data:image/png;base64," + Base64("\x89PNG123") + "\""));
  EXPECT_THAT(html, HasSubstr("src=\"data:image/jpeg;base64," + Base64("\xFF\xD8jpeg") + "\""));
}

TEST(Report, SaysWhereItCannotBeWritten) {
  const Report report("title");
  // A file is no folder.
  EXPECT_THROW(report.Write("/etc/hostname/report.html"), WorkError);
}

}  // namespace
}  // namespace flextip::report
