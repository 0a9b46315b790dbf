#include "stops/stop_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "recording/text/csv.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

void AddPlace(CsvWriter& csv, const std::optional<Eigen::Vector3d>& p) {
  if (!p) {
    csv.AddEmpty(3);
    return;
  }
  for (const double value : *p) csv.AddOrEmpty(value);
}

std::vector<std::string> Columns() {
  std::vector<std::string> columns{"timestamp [ns]", "time [s]"};
  const auto add = [&](const std::string& name) {
    for (const char* axis : {"_x [m]", "_y [m]", "_z [m]"}) columns.push_back(name + axis);
  };
  add("p_RE_wanted");
  add("p_RE_used");
  for (int i = 0; i < kVotedSensors; ++i)
    add(fmt::format("p_RE_{}", Name(static_cast<VotedSensor>(i))));
  add("p_RE_rest");
  columns.insert(columns.end(), {"sensors []", "out []", "chi2 []", "chi2_limit []",
                                 "worst_angle [rad]", "reaction []", "stop []"});
  return columns;
}

void AddRow(CsvWriter& csv, const SeenMoment& seen, TimeNs start_ns) {
  const Moment& moment = seen.moment;
  const Supervision& found = moment.supervision;
  csv.Add(moment.t_ns).Add(1e-9 * static_cast<double>(moment.t_ns - start_ns));
  AddPlace(csv, moment.p_RE_wanted);
  AddPlace(csv, moment.p_RE_used);
  for (const auto& p_RE : seen.p_RE) AddPlace(csv, p_RE);
  AddPlace(csv, seen.p_RE_rest);
  csv.Add(TimeNs(seen.sensors)).Add(TimeNs(found.voted_out));
  csv.AddOrEmpty(found.chi2).AddOrEmpty(found.chi2_limit).AddOrEmpty(found.worst_angle_rad);
  const bool held = *moment.cause != '\0';
  const Reaction reaction =
      held && found.reaction < Reaction::kHold ? Reaction::kHold : found.reaction;
  csv.Add(std::string(Name(reaction)));
  csv.Add(std::string(held ? moment.cause : Name(found.stop)));
  csv.EndRow();
}

}  // namespace

StopsOfRun StopsFound(const std::vector<StopEvent>& stops) {
  StopsOfRun found;
  found.found = stops.size();
  found.faults = static_cast<std::size_t>(
      std::count_if(stops.begin(), stops.end(), [](const auto& stop) { return stop.IsFault(); }));
  return found;
}

std::pair<TimeNs, TimeNs> SpanOf(const StopEvent& stop) {
  constexpr TimeNs kBefore_ns = 10'000'000'000, kAfter_ns = 1'000'000'000;
  const TimeNs last_ns = stop.IsFault() ? stop.fault_ns : stop.begin_ns;
  return {stop.begin_ns - kBefore_ns, last_ns + kAfter_ns};
}

std::string StopFolder(std::size_t number, const StopEvent& stop) {
  return fmt::format("stops/{}_{}", number, stop.cause);
}

void WriteStopTable(const std::filesystem::path& folder, const StopStory& story, TimeNs start_ns) {
  CsvWriter csv(Columns());
  for (const SeenMoment& seen : story.moments) AddRow(csv, seen, start_ns);
  WriteTextFile(folder / "stop.csv", csv.text());
}

}  // namespace flextip
