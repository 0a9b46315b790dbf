// A campaign's cases: each has one record, however often the campaign is interrupted.
#include "bench/campaign/campaign.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>

#include "batch/line_file.h"
#include "bench/calibration/chain_record.h"
#include "core/error.h"

namespace flextip::bench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

class CampaignTest : public testing::Test {
 protected:
  CampaignTest() {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = fs::temp_directory_path() / ("flextip_campaign_" + name);
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~CampaignTest() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(CampaignTest, DoesAgainOnlyTheCasesWithoutARecord) {
  Campaign campaign{.records = folder_ / "records", .jobs = 2, .names = {"a", "b", "c", "d"}};
  const fs::path mended = folder_ / "mended";
  campaign.run = [&](std::size_t index) -> CaseResult {
    if (index == 2 && !fs::exists(mended)) std::abort();
    if (index == 3 && !fs::exists(mended)) throw WorkError("no disk");
    return {campaign.names[index] + (fs::exists(mended) ? " second" : " first"), "said"};
  };
  try {
    RunCampaign(campaign);
    FAIL() << "two cases came to no end";
  } catch (const WorkError& error) {
    EXPECT_THAT(error.what(), HasSubstr("2 cases did not come to an end"));
  }
  EXPECT_THAT(batch::WholeLines(campaign.records), UnorderedElementsAre("a first", "b first"));
  campaign.done = {"a", "b"};
  fs::create_directories(mended);
  EXPECT_TRUE(RunCampaign(campaign));
  EXPECT_THAT(batch::WholeLines(campaign.records),
              UnorderedElementsAre("a first", "b first", "c second", "d second"));
}

TEST_F(CampaignTest, RecordsOfTheChainComeBackWhole) {
  ChainRun run;
  run.error_V["total"] = {{0.1, 1.0 / 3, -2e-9}, {4, 5, 6}};
  run.claimed_m["total"] = {{1e-3, 2e-5}, {3, 4}};
  run.claimed_V.push_back((Eigen::Matrix3d() << 1, 2, 3, 2, 5, 6, 3, 6, 1.0 / 7).finished());
  batch::LineFile(folder_ / "runs").Append({JsonLine(7, run), "{\"seed\": 8}"});
  EXPECT_THROW(ReadChainRuns(folder_ / "runs"), InputError);
  fs::remove(folder_ / "runs");
  batch::LineFile(folder_ / "runs").Append({JsonLine(7, run)});
  const auto back = ReadChainRuns(folder_ / "runs");
  ASSERT_EQ(back.count(7), 1U);
  EXPECT_EQ(back.at(7).error_V, run.error_V);
  EXPECT_EQ(back.at(7).claimed_m, run.claimed_m);
  EXPECT_EQ(back.at(7).claimed_V, run.claimed_V);
}

}  // namespace
}  // namespace flextip::bench
