// Figures read back from a page, and drawn as files.
#include "report/drawing/page_figures.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "core/error.h"
#include "report/drawing/picture.h"
#include "report/report.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

std::vector<Figure> Figures() {
  Figure lines{.title = "Tip <error> & \"more\"",
               .x_label = "time (s)",
               .log_y = true,
               .traces = {{.name = "a", .x = {0, 1, 2}, .y = {1, NAN, 3}, .dashed = true}},
               .bands = {{.from = 0.5, .to = 1.0, .color = "#e3e8ed"}}};
  Figure bars{.name = "bars",
              .title = "Bars",
              .lying_bars = true,
              .traces = {{.kind = FigureTrace::Kind::kBars,
                          .y = {1, 2},
                          .labels = {"x", "y"},
                          .texts = {"one", "two"}}}};
  Figure field{.title = "Bars",
               .fields = {{.name = "f",
                           .x = {0, 1},
                           .y = {0, 1, 2},
                           .values = {1, 2, 3, 4, 5, NAN},
                           .levels = {2.5}}}};
  return {lines, bars, field};
}

TEST(PageFigures, AreThoseThatWereDrawn) {
  const auto folder = fs::temp_directory_path() / fmt::format("flextip-figures-{}", ::getpid());
  fs::create_directories(folder);
  EXPECT_THROW(FiguresOfPage(folder), InputError);
  Report page("Test");
  page.AddFigures(Figures());
  page.Write(folder / "report.html");
  const auto read = FiguresOfPage(folder);
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read[0].name, "tip-error-more");
  EXPECT_EQ(read[1].name, "bars");
  EXPECT_EQ(read[2].name, "bars-2");  // a name of its own
  for (std::size_t i = 0; i < 3; ++i) {
    Figure named = Figures()[i];
    named.name = read[i].name;
    EXPECT_EQ(FigureText(read[i]), FigureText(named));  // all that a page draws
    for (const char* ending : {".svg", ".png", ".pdf"}) {
      const auto file = folder / (read[i].name + ending);
      WritePicture(file, {read[i]});
      EXPECT_GT(fs::file_size(file), 1000u) << file;
    }
  }
  fs::remove_all(folder);
}

TEST(PageFigures, AreRefusedWhereTheyAreNone) {
  EXPECT_THROW(ReadFigure("{", "page"), InputError);
  EXPECT_THROW(ReadFigure(R"({"traces":[{"kind":"cake","x":[1],"y":[1]}]})", "page"), InputError);
  EXPECT_THROW(ReadFigure(R"({"traces":[{"x":[1,2],"y":[1]}]})", "page"), InputError);
}

}  // namespace
}  // namespace flextip::report
