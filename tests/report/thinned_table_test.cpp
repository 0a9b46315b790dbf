// Long tables thinned against the same table read whole.
#include "report/thinned_table.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "core/error.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

const ThinnedColumn kValue{{"v"}, [](const std::vector<double>& v) { return 2 * v[0]; }};

class Thinned : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::ofstream out(file_);
    out << "#timestamp [ns],v [m],status []\n";
    for (int i = 0; i < GetParam(); ++i) {
      const bool lost = i % 97 == 13;
      values_.push_back(lost ? std::nan("") : std::round(1e6 * normal(random)) / 1e6);
      out << 5'000'000'000 + i * 1'000'000'000LL << ",";
      if (!lost) out << std::to_string(values_.back());
      out << (lost ? ",lost\n" : ",ok\n");
    }
  }
  void TearDown() override { std::filesystem::remove(file_); }

  std::string file_ = std::filesystem::temp_directory_path() /
                      ("flextip-thinned-" + std::to_string(getpid()) + ".csv");
  std::vector<double> values_;
};

TEST_P(Thinned, KeepsExtremesTimesAndTheWorstStatus) {
  constexpr std::size_t kMax = 64;
  const auto table = ReadThinned(file_, {kValue}, "status", {"ok", "predicted", "lost"}, kMax);
  ASSERT_LE(table.buckets.size(), kMax);
  EXPECT_GE(table.buckets.size(), std::min<std::size_t>(values_.size(), kMax / 2));
  EXPECT_DOUBLE_EQ(table.end_s, GetParam() - 1);
  for (std::size_t b = 0; b < table.buckets.size(); ++b) {
    const auto& bucket = table.buckets[b];
    const double end = b + 1 < table.buckets.size() ? table.buckets[b + 1].t_s : GetParam();
    double least = INFINITY, greatest = -INFINITY;
    bool lost = false;
    for (auto i = static_cast<std::size_t>(std::llround(bucket.t_s));
         i < static_cast<std::size_t>(std::llround(end)); ++i) {
      lost = lost || std::isnan(values_[i]);
      least = std::fmin(least, 2 * values_[i]);
      greatest = std::fmax(greatest, 2 * values_[i]);
    }
    EXPECT_EQ(bucket.worst_text, lost ? "lost" : "ok") << b;
    if (std::isinf(least)) {
      EXPECT_TRUE(std::isnan(bucket.columns[0].least));
      continue;
    }
    EXPECT_DOUBLE_EQ(bucket.columns[0].least, least) << b;
    EXPECT_DOUBLE_EQ(bucket.columns[0].greatest, greatest) << b;
    EXPECT_DOUBLE_EQ(
        2 * values_[static_cast<std::size_t>(std::llround(bucket.columns[0].t_least_s))], least);
  }
  std::vector<double> x, y;
  table.Trace(0, x, y);
  EXPECT_TRUE(std::is_sorted(x.begin(), x.end()));
  EXPECT_LE(x.size(), 2 * kMax);
}

// Two of the largest numbers, subtracted, are beyond them.
TEST(TimesOfResults, AreRefusedBeyondTheirBounds) {
  const std::string file = std::filesystem::temp_directory_path() /
                           ("flextip-times-" + std::to_string(getpid()) + ".csv");
  for (const char* time : {"9223372036854775807", "-9223372036854775808", "1.5", "x", ""}) {
    std::ofstream(file) << "#timestamp [ns],v [m],status []\n0,1,ok\n" << time << ",2,ok\n";
    EXPECT_THROW(ReadThinned(file, {kValue}, "status", {"ok"}, 4), InputError) << time;
    EXPECT_THROW(ReadResultTable(file), InputError) << time;
  }
  std::ofstream(file) << "#timestamp [ns],v [m],status []\n-4000000000000000000,1,ok\n"
                         "4000000000000000000,2,ok\n";
  EXPECT_DOUBLE_EQ(ReadThinned(file, {kValue}, "status", {"ok"}, 4).end_s, 8e9);
  std::ofstream(file) << "image [],v [m]\na,1\n";
  EXPECT_THROW(ReadThinned(file, {kValue}, "", {}, 4), InputError);
  EXPECT_TRUE(ReadResultTable(file).t_ns.empty());
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(Rows, Thinned, testing::Values(1, 14, 64, 65, 128, 129, 5000));

}  // namespace
}  // namespace flextip::report
