#include "bench/campaign/campaign.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <opencv2/core/utility.hpp>
#include <optional>

#include "batch/cores.h"
#include "batch/line_file.h"
#include "batch/ranks.h"
#include "batch/run.h"
#include "core/error.h"

namespace flextip::bench {
namespace {

/// The record's line, and behind it the line for the terminal.
int RunCase(const Campaign& campaign, std::size_t index, int threads, std::string& payload) {
  const tbb::global_control share(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  cv::setNumThreads(threads);
  const CaseResult result = campaign.run(index);
  payload = result.record + "\n" + result.said;
  return 0;
}

/// Keeps the records of the cases that ended. Returns how many ended without one.
int Keep(const std::vector<batch::Ended>& ended, batch::LineFile& records) {
  std::vector<std::string> lines;
  int lost = 0;
  for (const batch::Ended& one : ended) {
    const std::string& payload = one.outcome.payload;
    const std::size_t end = payload.find('\n');
    if (one.outcome.status == batch::Status::kOk) {
      lines.push_back(payload.substr(0, end));
      fmt::print("{}\n", payload.substr(end + 1));
    } else {
      fmt::print("{}: {}  {}\n", one.outcome.name, StatusText(one.outcome), payload);
      ++lost;
    }
  }
  records.Append(lines);
  std::fflush(stdout);
  return lost;
}

}  // namespace

bool RunCampaign(const Campaign& campaign) {
  const int threads = batch::ThreadsOfAnItem(campaign.jobs);
  batch::Pool pool(
      [&](const batch::Item& item, std::string& payload) {
        return RunCase(campaign, std::stoul(item.arguments.at(0)), threads, payload);
      },
      {.jobs = campaign.jobs});
  std::optional<batch::Ranks> ranks;
  if (batch::IsRank() && batch::HasMpi()) ranks.emplace();
  if (ranks && batch::RankNumber() > 0) {
    ranks->Serve(pool, {}, {});
    return false;
  }
  std::vector<batch::Item> items;
  for (std::size_t i = 0; i < campaign.names.size(); ++i) {
    if (campaign.done.contains(campaign.names[i])) continue;
    items.push_back({campaign.names[i], {std::to_string(i)}, 0.0});
  }
  fmt::print("{} cases, {} of them done before\n", campaign.names.size(),
             campaign.names.size() - items.size());
  batch::LineFile records(campaign.records);
  int lost = 0;
  const batch::Done keep = [&](const std::vector<batch::Ended>& ended) {
    lost += Keep(ended, records);
  };
  if (ranks) {
    ranks->RunItems(pool, items, keep, {});
  } else {
    RunItems(pool, items, keep);
  }
  if (lost > 0) throw WorkError(fmt::format("{} cases did not come to an end", lost));
  return true;
}

}  // namespace flextip::bench
