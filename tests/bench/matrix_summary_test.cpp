// Cases in a file and back, and their figures.
#include "bench/diagnosis_matrix/output/summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"

namespace flextip::bench {
namespace {

using testing::HasSubstr;
using testing::Not;

MatrixRecord Single(const std::string& effect, const std::string& answer, double separation) {
  MatrixRecord record;
  record.made.part = "singles";
  record.made.size = "plain";
  record.made.effects = {effect};
  record.key = record.made.Key();
  record.label = {effect};
  record.verdict = {answer};
  record.separation = separation;
  record.rival = "hand_eye";
  record.p_truth = effect == answer ? 0.9 : 0.1;
  return record;
}

MatrixRecord Pair(const EffectNames& answer, double separation) {
  MatrixRecord record = Single("length", "", separation);
  record.made.part = "pairs";
  record.label = {"length", "stiffness"};
  record.verdict = answer;
  record.rival = "length";
  return record;
}

double ValueOf(const std::vector<MatrixFigure>& figures, const std::string& figure,
               const std::string& group, int of) {
  for (const MatrixFigure& f : figures) {
    if (f.figure != figure || f.group != group) continue;
    EXPECT_EQ(f.of, of) << figure;
    return f.value;
  }
  ADD_FAILURE() << figure << " of " << group << " is missing";
  return -1.0;
}

TEST(MatrixSummary, SinglesCountTwiceAllAndSeparable) {
  const std::vector<MatrixRecord> records = {Single("stiffness", "stiffness", kSeparable),
                                             Single("tag_offset", "hand_eye", kSeparable - 0.1)};
  const auto figures = Figures(records);
  EXPECT_EQ(ValueOf(figures, "right cause first", "singles plain", 2), 0.5);
  EXPECT_EQ(ValueOf(figures, "right cause first, separable only", "singles plain", 1), 1.0);
  EXPECT_EQ(ValueOf(figures, "mean probability of the truth", "singles plain", 2), 0.5);
  EXPECT_EQ(ValueOf(figures, "mean probability, separable only", "singles plain", 1), 0.9);
}

TEST(MatrixSummary, PairsCountTwiceToo) {
  const std::vector<MatrixRecord> records = {Pair({"length", "stiffness"}, kSeparable),
                                             Pair({"length", "tag_offset"}, kSeparable),
                                             Pair({"hand_eye"}, kSeparable - 0.1)};
  const auto figures = Figures(records);
  EXPECT_EQ(ValueOf(figures, "both right", "pairs plain", 3), 1.0 / 3.0);
  EXPECT_EQ(ValueOf(figures, "both right, separable only", "pairs plain", 2), 0.5);
  EXPECT_EQ(ValueOf(figures, "at least one right", "pairs plain", 3), 2.0 / 3.0);
  EXPECT_EQ(ValueOf(figures, "at least one right, separable only", "pairs plain", 2), 1.0);
  EXPECT_THAT(Misses(records), HasSubstr("17.9 apart from length, answered hand_eye"));
}

TEST(MatrixSummary, DeviationsCountWhereABoundWasMeasured) {
  std::vector<MatrixRecord> records = {Single("length", "length", 50.0),
                                       Pair({"length", "stiffness"}, 50.0)};
  for (const double sd : {0.4, 1.2})
    records[0].parameters.push_back({"length", "delta_m", 0, 0.0, 0.0, sd, 1.0});
  for (const double sd : {1.6, 6.0, 9.0})
    records[1].parameters.push_back({"length", "delta_m", 0, 0.0, 0.0, sd, 2.0});
  records[1].parameters.push_back({"length", "delta_m", 0, 0.0, 0.0, 7.0, 0.0});
  const auto figures = Figures(records);  // 0.4, 0.8, 1.2, 3, 4.5
  const std::string of = "singles and pairs plain";
  EXPECT_DOUBLE_EQ(ValueOf(figures, "sd over Cramer-Rao bound, median", of, 5), 1.2);
  EXPECT_DOUBLE_EQ(ValueOf(figures, "sd 0.5 to 2 times the bound", of, 5), 0.4);
}

TEST(MatrixSummary, HeldOutErrorsAreHeldAgainstTheTrueModelWhereItWasMeasured) {
  std::vector<MatrixRecord> records(4, Single("length", "length", 50.0));
  records[0].heldout_over_true = 1.2;
  records[1].heldout_over_true = 0.99;
  records[2].heldout_over_true = 1.0;
  const auto figures = Figures(records);
  EXPECT_DOUBLE_EQ(ValueOf(figures, "held-out error, extended over true", "median", 3), 1.0);
  EXPECT_DOUBLE_EQ(ValueOf(figures, "held-out error, extended over true", "90 %", 3), 1.16);
}

TEST(MatrixSummary, MissesNameTheRivalsOfWhatIsNotSeparable) {
  EXPECT_THAT(Misses({Single("stiffness", "stiffness", 100.0)}), Not(HasSubstr("separable")));
  const std::string misses = Misses({Single("tag_offset", "tag_offset", 3.0)});
  EXPECT_THAT(misses, HasSubstr("no misses"));
  EXPECT_THAT(misses, HasSubstr("3.0 apart from hand_eye, answered tag_offset"));
}

TEST(MatrixRecordFile, RoundTripIsExact) {
  const auto file = std::filesystem::temp_directory_path() / "flextip_matrix_record_test.jsonl";
  MatrixRecord record = Single("stiffness", "length", 1.0 / 3.0);
  record.probabilities = {{{"length"}, 2.0 / 3.0}, {{"length", "stiffness"}, 0.1}};
  record.indistinguishable = {{"length", "port_offset"}};
  record.parameters = {{"length", "delta_m", 0, 0.1, 1.0 / 7.0, 0.01, 0.1 / 3.0}};
  record.heldout_over_true = 1.0 / 9.0;
  record.made.seed = 1'234'567'890'123ULL;
  std::ofstream(file) << JsonLine(record) << "\n{\"cut o";
  const auto read = ReadRecords(file);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(JsonLine(read[0]), JsonLine(record));
  EXPECT_EQ(read[0].made.seed, record.made.seed);
  EXPECT_EQ(read[0].separation, record.separation);
  EXPECT_EQ(read[0].probabilities, record.probabilities);
  EXPECT_EQ(read[0].parameters[0].value, record.parameters[0].value);
  EXPECT_EQ(read[0].parameters[0].bound, record.parameters[0].bound);
  EXPECT_EQ(read[0].heldout_over_true, record.heldout_over_true);
  std::ofstream(file) << JsonLine(record) << "\n{}\n";
  EXPECT_THROW(ReadRecords(file), InputError);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace flextip::bench
