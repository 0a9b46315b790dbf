#include "bench/running_diagnosis/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/error.h"
#include "diagnosis/running/running_diagnosis.h"

namespace flextip::bench {
namespace {

std::string NamesOf(const FoundCause& cause) {
  std::string names = diagnosis::CauseName(cause.likeliest.cause);
  if (cause.other.cause >= 0) names += " or " + diagnosis::CauseName(cause.other.cause);
  return names;
}

bool Names(const std::string& names, const std::string& cause) {
  return names == cause || names.starts_with(cause + " or ") || names.ends_with(" or " + cause);
}

double Quantile(std::vector<double> values, double part) {
  if (values.empty()) return -1.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1) + 0.5)];
}

struct Row {
  int runs = 0, early = 0, warned = 0, first_right = 0, last_right = 0, alone = 0;
  std::vector<double> delays_s;

  void Add(const WatchedRecord& record) {
    ++runs;
    early += record.WarnedTooEarly();
    if (!record.Warned() || record.WarnedTooEarly()) return;
    ++warned;
    first_right += Names(record.first_names, record.cause);
    last_right += Names(record.last_names, record.cause);
    alone += record.last_names == record.cause;
    delays_s.push_back(record.warned_s - record.onset_s);
  }
  std::string Text(const std::string& name) const {
    const auto second = [](double s) {
      return s < 0.0 ? std::string("") : fmt::format("{:.1f}", s);
    };
    return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", name, runs, early,
                       warned, first_right, last_right, alone, second(Quantile(delays_s, 0.5)),
                       second(Quantile(delays_s, 0.9)));
  }
};

}  // namespace

WatchedRecord RunWatched(const WatchedRun& run) {
  WatchedRecord record;
  record.cause = run.cause;
  record.size = run.cause.empty() ? "" : kOnsetSizeNames[run.size];
  record.suite = Name(run.suite);
  record.onset_s = run.onset_s;
  simulation::LoopResult result;
  try {
    result = RunClosedLoop(run.setup, nullptr);
  } catch (const WorkError& error) {
    record.ended = error.what();
    return record;
  }
  for (const simulation::LoopUpdate& update : result.updates) {
    record.simulated_s = 1e-9 * static_cast<double>(update.t_ns - simulation::kSimulationStart_ns);
    if (!update.cause.IsThere()) continue;
    if (!record.Warned()) {
      record.warned_s = record.simulated_s;
      record.first_names = NamesOf(update.cause);
    }
  }
  const FoundCause& last = result.updates.back().cause;
  if (!last.IsThere()) return record;
  record.last_names = NamesOf(last);
  record.text = diagnosis::Text(last);
  record.value = last.likeliest.value;
  record.sd = last.likeliest.sd;
  return record;
}

std::string CsvText(const std::vector<WatchedRecord>& records) {
  std::string text =
      "cause,size,suite,simulated_s,onset_s,warned_s,first_names,last_names,value,sd,text,ended\n";
  for (const WatchedRecord& r : records) {
    text += fmt::format("{},{},{},{:.2f},{:.2f},{:.2f},{},{},{:.6g},{:.3g},\"{}\",\"{}\"\n",
                        r.cause, r.size, r.suite, r.simulated_s, r.onset_s, r.warned_s,
                        r.first_names, r.last_names, r.value, r.sd, r.text, r.ended);
  }
  return text;
}

std::string OnsetTable(const std::vector<WatchedRecord>& records) {
  std::map<std::string, Row> by_cause, by_size, by_suite;
  Row all;
  int ended = 0;
  for (const WatchedRecord& record : records) {
    if (!record.ended.empty()) {
      ++ended;
      continue;
    }
    by_cause[record.cause + " " + record.size].Add(record);
    by_size[record.size].Add(record);
    by_suite[record.suite].Add(record);
    all.Add(record);
  }
  std::string text =
      "| cause | runs | warned before | warned | right at first | right at the end | it alone "
      "| median s | 90 % s |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const auto* rows : {&by_cause, &by_size, &by_suite})
    for (const auto& [name, row] : *rows) text += row.Text(name);
  text += all.Text("all");
  if (ended > 0) text += fmt::format("{} runs ended without an equilibrium\n", ended);
  return text;
}

std::string HealthyTable(const std::vector<WatchedRecord>& records) {
  struct Hours {
    double s = 0.0;
    int alarms = 0;
  };
  std::map<std::string, Hours> by_suite;
  std::map<std::string, int> by_name;
  for (const WatchedRecord& record : records) {
    for (const std::string& suite : {record.suite, std::string("all suites")}) {
      // A warning stays: what comes after it cannot warn again.
      by_suite[suite].s += record.Warned() ? record.warned_s : record.simulated_s;
      by_suite[suite].alarms += record.Warned();
    }
    if (record.Warned()) ++by_name[record.first_names];
  }
  std::string text = "| sensors | hours | false alarms | in an hour |\n|---|---|---|---|\n";
  for (const auto& [name, hours] : by_suite) {
    text += fmt::format("| {} | {:.2f} | {} | {:.2f} |\n", name, hours.s / 3600.0, hours.alarms,
                        3600.0 * hours.alarms / std::max(1.0, hours.s));
  }
  for (const auto& [name, count] : by_name) text += fmt::format("{} times {}\n", count, name);
  return text;
}

}  // namespace flextip::bench
