#include "recording/text/csv.h"

#include <gmock/gmock.h>

#include <bit>
#include <clocale>
#include <random>

#include "recording/text/text.h"
#include "tests/recording/sample_recording.h"

namespace flextip {
namespace {

using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteText;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(NumberText, RandomBitPatternsComeBackBitForBit) {
  std::mt19937_64 generator(3);
  int finite = 0;
  for (int i = 0; i < 200'000; ++i) {
    const auto bits = generator();
    const auto value = std::bit_cast<double>(bits);
    if (!std::isfinite(value)) continue;
    ++finite;
    const auto back = ParseNumber(NumberText(value));
    ASSERT_TRUE(back.has_value());
    ASSERT_EQ(std::bit_cast<std::uint64_t>(*back), bits) << NumberText(value);
  }
  EXPECT_GT(finite, 190'000);
}

TEST(NumberText, OnlyWholeFiniteNumbersParse) {
  EXPECT_EQ(ParseFinite("-1.5e-3"), -1.5e-3);
  for (const char* bad :
       {"", "-", "1,5", "1.5x", "x", "0x10", "1e", "nan", "-inf", "1e400", " 1"}) {
    EXPECT_FALSE(ParseFinite(bad).has_value()) << bad;
  }
  EXPECT_EQ(ParseInteger("1700000000033333333"), 1700000000033333333);
  for (const char* bad : {"1.7e18", "99999999999999999999", "1.0", ""}) {
    EXPECT_FALSE(ParseInteger(bad).has_value()) << bad;
  }
}

struct Table {
  std::vector<std::vector<double>> rows;
  ReadLog log;
};
Table ReadTable(const std::filesystem::path& file, const CsvOptions& options = {}) {
  Table table;
  CsvReader csv(file, {"timestamp [ns]", "x [m]"}, table.log, options);
  while (csv.Next()) {
    table.rows.push_back({static_cast<double>(csv.Integer(0)), csv.Number(1)});
  }
  return table;
}
std::string Failure(const std::filesystem::path& file, const CsvOptions& options = {}) {
  try {
    ReadTable(file, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read without an error";
}

TEST(Csv, SpacesCarriageReturnsByteOrderMarkAndTheOrderOfColumnsDoNotMatter) {
  const TemporaryFolder folder;
  WriteText(folder / "a.csv", "\xEF\xBB\xBF#x [m], timestamp [ns]\r\n 0.5, 1\r\n-2 ,2 \r\n\r\n");
  const auto table = ReadTable(folder / "a.csv");
  EXPECT_THAT(table.rows, ElementsAre(ElementsAre(1, 0.5), ElementsAre(2, -2)));
  EXPECT_TRUE(table.log.warnings.empty());
}

TEST(Csv, TornLastLinesAreSkippedAndReported) {
  const TemporaryFolder folder;
  const std::string whole = "#timestamp [ns],x [m]\n1,0.5\n";
  for (const char* torn : {"2", "2,", "2,0.5", "2\n", "17000", "2\n\n"}) {
    WriteText(folder / "a.csv", whole + torn);
    const auto table = ReadTable(folder / "a.csv");
    EXPECT_EQ(table.rows.size(), 1u) << torn;
    EXPECT_EQ(table.log.torn_lines, 1) << torn;
    ASSERT_EQ(table.log.warnings.size(), 1u) << torn;
    EXPECT_THAT(table.log.warnings[0], HasSubstr("a.csv:3: skipped a torn last line"));
  }
}

TEST(Csv, ALineThatLacksFieldsInTheMiddleIsNoTornLine) {
  const TemporaryFolder folder;
  WriteText(folder / "a.csv", "#timestamp [ns],x [m]\n1\n2,0.5\n");
  EXPECT_THAT(Failure(folder / "a.csv"), HasSubstr("a.csv:2: found 1 fields, expected 2"));
  WriteText(folder / "a.csv", "#timestamp [ns],x [m]\n1,2\n\n2,0.5\n");
  EXPECT_THAT(Failure(folder / "a.csv"), HasSubstr("a.csv:3: found 1 fields, expected 2"));
  WriteText(folder / "a.csv", "#timestamp [ns],x [m]\n1,2\n2,0.5,7");
  EXPECT_THAT(Failure(folder / "a.csv"), HasSubstr("a.csv:3: found 3 fields, expected 2"));
}

TEST(Csv, HandMadeTablesMayEndWithoutALineBreakAndHoldOtherColumns) {
  const TemporaryFolder folder;
  WriteText(folder / "a.csv", "x [m],note,timestamp [ns]\n0.5,first,1\n0.25,second,2");
  const auto table =
      ReadTable(folder / "a.csv", {.from_recorder = false, .allow_other_columns = true});
  EXPECT_THAT(table.rows, ElementsAre(ElementsAre(1, 0.5), ElementsAre(2, 0.25)));
  WriteText(folder / "a.csv", "timestamp [ns],x [m]\n1,0.5\n2");
  EXPECT_THAT(Failure(folder / "a.csv", {.from_recorder = false}),
              HasSubstr("a.csv:3: found 1 fields, expected 2"));
}

TEST(Csv, ColumnsThatMayBeLackingAreEmpty) {
  TemporaryFolder folder;
  WriteText(folder / "t.csv", "#a,c\n1,3\n");
  ReadLog log;
  CsvOptions options;
  EXPECT_THROW(CsvReader(folder / "t.csv", {"a", "b", "c"}, log, options), InputError);
  options.may_lack = {"b"};
  CsvReader reader(folder / "t.csv", {"a", "b", "c"}, log, options);
  ASSERT_TRUE(reader.Next());
  EXPECT_EQ(reader.Integer(0), 1);
  EXPECT_TRUE(reader.Empty(1));
  EXPECT_EQ(reader.Integer(2), 3);
}

TEST(Csv, BrokenFilesFailWithOneLine) {
  const TemporaryFolder folder;
  EXPECT_THAT(Failure(folder / "none.csv"), HasSubstr("none.csv: no such file"));
  EXPECT_THAT(Failure(folder.path()), HasSubstr("cannot be read as a file"));
  const std::pair<std::string, const char*> cases[] = {
      {"", "a.csv:1: empty, expected a header"},
      {"\n", "a.csv:1: empty, expected a header"},
      {"timestamp [ns],x [m]\n", "a.csv:1: found \"timestamp [ns],x [m]\", expected a header that"},
      {"#timestamp [ns]\n", "a.csv:1: column \"x [m]\" is missing"},
      {"#timestamp [ns],x [m],y [m]\n", "a.csv:1: extra column \"y [m]\""},
      {"#timestamp [ns],x [m],x [m]\n", "a.csv:1: column \"x [m]\" is there twice"},
      {"#timestamp [ns],x [m]\n1.5,2\n", "a.csv:2: found \"1.5\" in column \"timestamp [ns]\""},
      {"#timestamp [ns],x [m]\n1,two\n",
       "a.csv:2: found \"two\" in column \"x [m]\", expected a f"},
      {std::string("#timestamp [ns],x [m]\n1,\0\1\n2,3\n", 32), "a.csv:2: found \"??\" in column"},
  };
  for (const auto& [text, message] : cases) {
    WriteText(folder / "a.csv", text);
    EXPECT_THAT(Failure(folder / "a.csv"), HasSubstr(message));
    EXPECT_THAT(Failure(folder / "a.csv"), ::testing::Not(HasSubstr("\n")));
  }
}

TEST(Csv, TextsComeBackAsTheyWereWritten) {
  const TemporaryFolder folder;
  const std::string texts[] = {"plain",    "a, b", "says \"so\"", "\"", ",",
                               " spaces ", "",     "\"\",\""};
  CsvWriter csv({"name, of", "value"});
  for (const auto& text : texts) csv.Add(text).AddOrEmpty(std::nan("")).EndRow();
  csv.Add("number").Add(1.0 / 3, 6).EndRow();
  WriteText(folder / "a.csv", csv.text());
  EXPECT_THAT(csv.text(), HasSubstr("number,0.333333\n"));
  ReadLog log;
  CsvReader read(folder / "a.csv", log);
  EXPECT_THAT(read.Columns(), ElementsAre("name, of", "value"));
  for (const auto& text : texts) {
    ASSERT_TRUE(read.Next());
    EXPECT_EQ(read.Text(0), text);
    EXPECT_TRUE(read.Empty(1));
  }
  ASSERT_TRUE(read.Next());
  EXPECT_EQ(read.Number(1), 0.333333);
  EXPECT_FALSE(read.Next());
  EXPECT_TRUE(log.warnings.empty());
}

TEST(Csv, QuotesThatDoNotCloseAreNamed) {
  const TemporaryFolder folder;
  WriteText(folder / "a.csv", "#timestamp [ns],x [m]\n1,\"2\n3,4\n");
  EXPECT_THAT(Failure(folder / "a.csv"), HasSubstr("a.csv:2: a quote is not closed"));
  WriteText(folder / "a.csv", "#timestamp [ns],x [m]\n1,\"2\"5\n3,4\n");
  EXPECT_THAT(Failure(folder / "a.csv"), HasSubstr("a.csv:2: found \"5\" after a closing quote"));
}

TEST(Csv, NeverWritesWhatItWouldNotRead) {
  CsvWriter csv({"a", "b"});
  EXPECT_THROW(csv.Add(std::nan("")), WorkError);
  EXPECT_THROW(csv.Add(HUGE_VAL), WorkError);
  csv.Add(TimeNs{1}).Add(0.25).EndRow();
  csv.AddFixed(2.0 / 3.0, 4).AddFixed(HUGE_VAL, 4).EndRow();
  EXPECT_EQ(csv.text(), "#a,b\n1,0.25\n0.6667,\n");
}

}  // namespace
}  // namespace flextip
