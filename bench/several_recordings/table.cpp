#include "bench/several_recordings/table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/median.h"

namespace flextip::bench {
namespace {

using Json = nlohmann::json;

struct Count {
  int drawn = 0, qualified = 0, right = 0, alone_right = 0, with_false_change = 0, found = 0;
  int errors = 0;
};

Count CountOf(const std::vector<SeveralRecord>& records, const std::string& part) {
  Count count;
  for (const SeveralRecord& r : records) {
    if (r.part != part) continue;
    ++count.drawn;
    count.errors += !r.error.empty();
    if (!r.qualifies || !r.error.empty()) continue;
    ++count.qualified;
    count.right += r.IsRight();
    count.alone_right += r.alone == std::vector<std::string>{r.effect};
    count.with_false_change += r.FalseChanges() > 0;
    const std::string change = fmt::format("{}@{}", r.effect, r.begin);
    count.found += std::ranges::find(r.changes, change) != r.changes.end();
  }
  return count;
}

std::string PredictRow(const std::vector<SeveralRecord>& records) {
  std::vector<double> ratios, excess;
  int below = 0;
  for (const SeveralRecord& r : records) {
    if (r.part != "predict" || !r.qualifies || !r.error.empty()) continue;
    ratios.push_back(r.ratio);
    excess.push_back(r.ratio / r.ratio_of_own_fit);
    below += r.ratio < 0.9;
  }
  if (ratios.empty()) return "";
  return fmt::format(
      "predict   {} models: ratio {:.2f} (median), below 0.9 in {}; {:.2f} times "
      "that of a fit to the recording itself (median), {:.2f} at most\n",
      ratios.size(), Median(ratios), below, Median(excess), *std::ranges::max_element(excess));
}

}  // namespace

std::string SeveralLine(const SeveralRecord& r) {
  return Json{{"key", r.key},
              {"part", r.part},
              {"error", r.error},
              {"effect", r.effect},
              {"size", r.size},
              {"seed", r.seed},
              {"load", r.load},
              {"begin", r.begin},
              {"qualifies", r.qualifies},
              {"separation_of_one", r.separation_of_one},
              {"separation_of_all", r.separation_of_all},
              {"rival", r.rival},
              {"verdict", r.verdict},
              {"changes", r.changes},
              {"alone", r.alone},
              {"ratio", r.ratio},
              {"ratio_of_own_fit", r.ratio_of_own_fit},
              {"seconds", r.seconds}}
      .dump();
}

std::vector<SeveralRecord> ReadSeveral(const std::filesystem::path& file) {
  std::vector<SeveralRecord> records;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const Json j = Json::parse(line, nullptr, false);
    if (!j.is_object()) continue;
    SeveralRecord r;
    r.key = j.at("key"), r.part = j.at("part"), r.error = j.at("error");
    r.effect = j.at("effect"), r.size = j.at("size"), r.rival = j.at("rival");
    r.seed = j.at("seed"), r.load = j.at("load"), r.begin = j.at("begin");
    r.qualifies = j.at("qualifies");
    r.separation_of_one = j.at("separation_of_one");
    r.separation_of_all = j.at("separation_of_all");
    r.verdict = j.at("verdict").get<std::vector<std::string>>();
    r.changes = j.at("changes").get<std::vector<std::string>>();
    r.alone = j.at("alone").get<std::vector<std::string>>();
    r.ratio = j.at("ratio"), r.ratio_of_own_fit = j.at("ratio_of_own_fit");
    r.seconds = j.at("seconds");
    records.push_back(std::move(r));
  }
  return records;
}

std::string SeveralTable(const std::vector<SeveralRecord>& records) {
  std::string text;
  const Count pairs = CountOf(records, "pairs"), changes = CountOf(records, "changes"),
              healthy = CountOf(records, "healthy");
  text += fmt::format(
      "pairs     {} of {} series need and have three recordings: {} right, {} by "
      "the first recording alone; {} with a false change\n",
      pairs.qualified, pairs.drawn, pairs.right, pairs.alone_right, pairs.with_false_change);
  text += fmt::format(
      "changes   {} of {} series show what began: {} right, {} with the change in "
      "the right recording; {} with a false change\n",
      changes.qualified, changes.drawn, changes.right, changes.found, changes.with_false_change);
  text += fmt::format("healthy   {} series: {} right, {} with a false change\n", healthy.qualified,
                      healthy.right, healthy.with_false_change);
  text += PredictRow(records);
  const int errors = pairs.errors + changes.errors + healthy.errors;
  if (errors > 0) text += fmt::format("{} series with an error\n", errors);
  return text;
}

}  // namespace flextip::bench
