// The page of a batch and the spread of its numbers, by tables whose numbers are known.
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "core/error.h"
#include "report/batch/spread.h"
#include "report/compare/summary_values.h"
#include "report/pages.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class BatchPage : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("flextip-batch-" + std::to_string(getpid()) + "-" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    Write("table.csv",
          "name,input,exit_code,status,message,grade,frames,ok,tip_rms_error_m,seconds,host\n"
          "a,in/a,0,ok,,good,10,9,0.0004,1.5,h\n"
          "b,in/b,139,crashed SIGSEGV,<the last line>,,,,,0.5,h\n"
          "c,in/c,0,ok,,beware,10,7,0.0001,2.5,h\n"
          "d,in/d,0,ok,,good,10,8,0.0002,3.5,h\n");
    Write("summary.json", R"({"command": "batch", "of": "track", "version": "1", "items": 4,
      "ok": 3, "verdict": {"grade": "beware", "says": "3 of 4 ran through.", "reasons": []}})");
    Write("items/a/report.html", "page");
    Write("logs/b.log", "log");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void Write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::string Page() const {
    WriteFigures(folder_ / "figures.json", SpreadOf(folder_ / "table.csv", "track"));
    WriteBatchReport(folder_);
    std::ostringstream text;
    text << std::ifstream(folder_ / "report.html").rdbuf();
    return text.str();
  }

  fs::path folder_;
};

TEST_F(BatchPage, DrawsTheNumbersThatDiffer) {
  EXPECT_THAT(SpreadColumns(folder_ / "table.csv", "track"),
              ElementsAre("ok", "tip_rms_error_m", "seconds"));
  const std::vector<Figure> figures = SpreadOf(folder_ / "table.csv", "track");
  ASSERT_EQ(figures.size(), 3U);
  EXPECT_EQ(figures[1].title, "tip error, RMS");
  EXPECT_THAT(figures[1].traces.at(0).y, ElementsAre(0.1, 0.2, 0.4));  // mm
  EXPECT_EQ(figures[1].caption, "Median 0.2 mm; from 0.1 mm (c) to 0.4 mm (a).");
}

TEST_F(BatchPage, ShowsWhatFailedFirst) {
  const std::string page = Page();
  EXPECT_THAT(page, HasSubstr("3 of 4 ran through."));
  EXPECT_LT(page.find("Items that did not run through"), page.find("<h2>Spread"));
  EXPECT_THAT(page, HasSubstr("crashed SIGSEGV"));
  EXPECT_THAT(page, HasSubstr("&lt;the last line&gt;"));
  EXPECT_THAT(page, HasSubstr("<a href=\"logs/b.log\">"));
}

TEST_F(BatchPage, LeadsToTheItemsAndSortsByNumbers) {
  const std::string page = Page();
  EXPECT_THAT(page, HasSubstr("<a href=\"items/a/report.html\">a</a>"));
  EXPECT_THAT(page, Not(HasSubstr("<a href=\"items/c/report.html\">")));  // has none
  EXPECT_THAT(page, HasSubstr("<td data-order=\"0.0004\">0.4 mm</td>"));
  EXPECT_THAT(page, HasSubstr("<table class=\"sortable\">"));
}

TEST_F(BatchPage, TakesTheValuesOfASummary) {
  Write("run/summary.json", R"({"command": "x", "version": "1", "date": "d", "typed": "t",
    "inputs": ["i"], "warnings": [], "verdict": {"grade": "good", "says": "Yes."},
    "verdicts": ["sag", "drag"], "frames": 3, "converged": true,
    "controllers": {"rod-track": {"max_deviation_m": 0.5}}, "views": [{"view": 1}]})");
  std::vector<std::string> values;
  for (const SummaryValue& v : ValuesOf(folder_ / "run")) values.push_back(v.Path() + "=" + v.text);
  EXPECT_THAT(values, ElementsAre("grade=good", "answer=Yes.", "verdicts=sag+drag", "frames=3",
                                  "converged=true", "rod-track/max_deviation_m=0.5"));
}

}  // namespace
}  // namespace flextip::report
