#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/next_motion/trial.h"
#include "core/median.h"

namespace flextip::bench {
namespace {

const std::vector<std::string> kWays{"planned", "library", "random"};

}  // namespace

std::string TrialLine(const TrialRecord& r) {
  return nlohmann::json{
      {"key", r.key},       {"effect", r.effect},  {"qualifies", r.qualifies},
      {"why", r.why},       {"rivals", r.rivals},  {"planned_seconds", r.planned_seconds},
      {"load_N", r.load_N}, {"seconds", r.seconds}}
      .dump();
}

std::vector<TrialRecord> ReadTrials(const std::filesystem::path& file) {
  std::vector<TrialRecord> records;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (json.is_discarded()) continue;
    TrialRecord& r = records.emplace_back();
    json.at("key").get_to(r.key);
    json.at("effect").get_to(r.effect);
    json.at("qualifies").get_to(r.qualifies);
    json.at("why").get_to(r.why);
    json.at("rivals").get_to(r.rivals);
    json.at("planned_seconds").get_to(r.planned_seconds);
    json.at("load_N").get_to(r.load_N);
    json.at("seconds").get_to(r.seconds);
  }
  return records;
}

std::string TrialTable(const std::vector<TrialRecord>& records) {
  std::map<std::string, std::vector<double>> seconds;
  std::map<std::string, int> certain, no_slower;
  int of = 0;
  for (const TrialRecord& r : records) {
    if (!r.qualifies) continue;
    ++of;
    double least = 1e300;
    for (const std::string& way : kWays) least = std::min(least, r.seconds.at(way));
    for (const std::string& way : kWays) {
      seconds[way].push_back(r.seconds.at(way));
      certain[way] += r.seconds.at(way) <= 20.0 ? 1 : 0;
      no_slower[way] += r.seconds.at(way) <= least ? 1 : 0;
    }
  }
  std::string table =
      fmt::format("{} of {} trials left causes to tell apart\n", of, records.size());
  table += fmt::format("{:<10} {:>9} {:>7} {:>22} {:>10}\n", "way", "median s", "mean s",
                       "certain within 20 s", "quickest");
  for (const std::string& way : kWays) {
    if (of == 0) break;
    double sum = 0.0;
    for (const double value : seconds[way]) sum += value;
    table += fmt::format("{:<10} {:>9.1f} {:>7.1f} {:>22} {:>10}\n", way,
                         Quantile(seconds[way], 0.5), sum / of, certain[way], no_slower[way]);
  }
  return table;
}

}  // namespace flextip::bench
