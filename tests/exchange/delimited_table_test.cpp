// Tables in other programs' dialects.
#include "exchange/tables/delimited_table.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/recording/sample_recording.h"

namespace flextip::exchange {
namespace {

using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteText;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Tables : public testing::Test {
 protected:
  DelimitedTable Open(const std::string& text, const Dialect& told = {}) {
    WriteText(folder_ / "a.csv", text);
    return DelimitedTable(folder_ / "a.csv", told);
  }
  std::string Failure(const std::string& text) {
    try {
      auto table = Open(text);
      while (table.Next()) continue;
    } catch (const InputError& error) {
      return error.what();
    }
    return "read";
  }
  /// All numbers, row by row.
  static std::vector<double> Numbers(DelimitedTable& table) {
    std::vector<double> numbers;
    while (table.Next()) {
      for (std::size_t i = 0; i < table.Columns().size(); ++i) {
        numbers.push_back(table.Number(i).value());
      }
    }
    return numbers;
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(Tables, SeparatorsAndDecimalSignsAreFound) {
  struct Case {
    const char* text;
    char separator, decimal;
  };
  for (const Case& c : {Case{"a,b\n1.5,2\n3,4.25\n", ',', '.'},
                        {"a;b\n1,5;2\n3;4,25\n", ';', ','},
                        {"a;b\n1.5;2\n3;4.25\n", ';', '.'},
                        {"a\tb\n1,5\t2\n3\t4,25\n", '\t', ','},
                        {"a b\n1.5 2\n3   4.25\n", ' ', '.'},
                        {"a b\n1,5 2\n3 4,25\n", ' ', ','},
                        {"a, b\n1.5, 2\n3, 4.25\n", ',', '.'},
                        {"\"a\",\"b\"\n\"1,5\",\"2\"\n\"3\",\"4,25\"\n", ',', ','},
                        {"\xEF\xBB\xBF"
                         "a,b\r\n1.5,2\r\n3,4.25\r\n",
                         ',', '.'}}) {
    auto table = Open(c.text);
    EXPECT_EQ(table.separator(), c.separator) << c.text;
    EXPECT_EQ(table.decimal(), c.decimal) << c.text;
    EXPECT_THAT(table.Columns(), ElementsAre("a", "b")) << c.text;
    EXPECT_THAT(Numbers(table), ElementsAre(1.5, 2, 3, 4.25)) << c.text;
  }
}

TEST_F(Tables, HeadersMayBeAbsentOrComments) {
  auto bare = Open("1,2\n3,4\n");
  EXPECT_FALSE(bare.has_header());
  EXPECT_THAT(bare.Columns(), ElementsAre("1", "2"));
  EXPECT_THAT(Numbers(bare), ElementsAre(1, 2, 3, 4));
  auto comment = Open("# made by hand, in 2024, at home\n#time [s],x [mm]\n1,2\n# a pause\n3,4\n");
  EXPECT_THAT(comment.Columns(), ElementsAre("time [s]", "x [mm]"));
  EXPECT_THAT(Numbers(comment), ElementsAre(1, 2, 3, 4));
  auto percent = Open("%time,x\n1,2\n3,4\n");
  EXPECT_THAT(percent.Columns(), ElementsAre("time", "x"));
  auto told = Open("1,2\n3,4\n", {.separator = ',', .decimal = '.', .header = true});
  EXPECT_THAT(told.Columns(), ElementsAre("1", "2"));
  EXPECT_THAT(Numbers(told), ElementsAre(3, 4));
}

TEST_F(Tables, LinesAboveAndARowOfUnitsAreSeen) {
  auto table = Open("Tracker export\nOperator: me\n\nt,x,y\ns,mm,mm\n0,1,2\n0.1,3,4\n");
  EXPECT_THAT(table.Columns(), ElementsAre("t [s]", "x [mm]", "y [mm]"));
  EXPECT_THAT(Numbers(table), ElementsAre(0, 1, 2, 0.1, 3, 4));
  EXPECT_THAT(table.Remarks(), ElementsAre(HasSubstr("left out 2 lines above the table")));
}

TEST_F(Tables, TrailingSeparatorsEmptyRowsAndMissingValues) {
  auto table = Open("a,b,\n1,2,\n,,\n3,,\nNaN,+4,\n");
  ASSERT_TRUE(table.Next());
  EXPECT_EQ(table.Number(1), 2.0);
  ASSERT_TRUE(table.Next());
  EXPECT_EQ(table.line(), 4);
  EXPECT_TRUE(std::isnan(table.Number(1).value()));
  ASSERT_TRUE(table.Next());
  EXPECT_TRUE(std::isnan(table.Number(0).value()));
  EXPECT_EQ(table.Number(1), 4.0);
  EXPECT_FALSE(table.Next());
}

TEST_F(Tables, ATornLastLineIsLeftOut) {
  auto table = Open("a,b\n1,2\n3");
  EXPECT_THAT(Numbers(table), ElementsAre(1, 2));
  EXPECT_THAT(table.Remarks(), ElementsAre(HasSubstr(":3: left out a torn last line")));
  auto whole = Open("a,b\n1,2\n3,4");
  EXPECT_THAT(Numbers(whole), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(whole.Remarks(), IsEmpty());
}

TEST_F(Tables, ASingleColumnIsATable) {
  auto table = Open("0.5\n1.5\n2.5\n");
  EXPECT_THAT(table.Columns(), ElementsAre("1"));
  EXPECT_THAT(Numbers(table), ElementsAre(0.5, 1.5, 2.5));
}

TEST_F(Tables, ARewoundTableBeginsAgain) {
  auto table = Open("a,b\n1,2\n3,4\n");
  EXPECT_THAT(Numbers(table), ElementsAre(1, 2, 3, 4));
  table.Rewind();
  EXPECT_THAT(Numbers(table), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(table.line(), 3);
}

TEST_F(Tables, RefusalsNameFileAndLine) {
  EXPECT_THAT(Failure("a,b\n1,2\n3\n5,6\n7,8\n9,10\n"),
              HasSubstr("a.csv:3: found 1 fields, expected 2"));
  EXPECT_THAT(Failure("a,b\n1,2\n\"3,4\n5,6\n7,8\n9,1\n"),
              HasSubstr("a.csv:3: a quote is not closed"));
  EXPECT_THAT(Failure(""), HasSubstr("no rows, expected a table"));
  EXPECT_THAT(Failure("# only\n"), HasSubstr("no rows"));
  EXPECT_THAT(Failure(std::string("\xFF\xFE"
                                  "a\0",
                                  4)),
              HasSubstr("UTF-16, expected UTF-8"));
}

}  // namespace
}  // namespace flextip::exchange
