#include "exports/text_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"

namespace flextip::exports {
namespace {

constexpr TimeNs kSecond_ns = 1'000'000'000;

std::filesystem::path FileOf(const std::filesystem::path& folder, std::string name,
                             const char* ending) {
  std::replace(name.begin(), name.end(), '/', '-');
  return folder / (name + ending);
}

/// Seconds with nine digits, from whole numbers: none is lost.
std::string Seconds(TimeNs t_ns) {
  const TimeNs whole = t_ns / kSecond_ns, rest = t_ns % kSecond_ns;
  return fmt::format("{}{}.{:09}", t_ns < 0 ? "-" : "", std::abs(whole), std::abs(rest));
}

}  // namespace

std::vector<WrittenFile> WriteTum(const std::vector<TimedTable>& tables,
                                  const std::filesystem::path& folder) {
  std::vector<WrittenFile> written;
  for (const TimedTable& table : tables) {
    for (const Trajectory& path : TrajectoriesIn(table)) {
      std::string text;
      for (const TimedPose& pose : path.poses) {
        text += Seconds(pose.t_ns);
        for (const double v :
             {pose.p.x(), pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w()}) {
          text += fmt::format(" {}", v);
        }
        text += '\n';
      }
      written.push_back({FileOf(folder, path.name, ".tum"), path.poses.size(), path.has_turn});
      WriteTextFile(written.back().file, text);
    }
  }
  if (written.empty()) {
    throw InputError("no table holds positions (p_..._x, _y, _z): there is no trajectory to write");
  }
  return written;
}

std::string PlainColumn(const std::string& column) {
  const std::size_t bracket = column.find(" [");
  std::string name = column.substr(0, bracket);
  std::string unit =
      bracket == std::string::npos ? "" : column.substr(bracket + 2, column.size() - bracket - 3);
  if (unit.starts_with("1/")) unit = "per_" + unit.substr(2);
  if (!unit.empty()) name += "_" + unit;
  for (char& c : name) {
    if (c == ' ' || c == '/' || c == '-' || c == '.' || c == ',') c = '_';
  }
  return name.starts_with("#") ? name.substr(1) : name;
}

std::vector<WrittenFile> WritePlainCsv(const std::vector<TimedTable>& tables,
                                       const std::filesystem::path& folder) {
  TimeNs first_ns = std::numeric_limits<TimeNs>::max();
  for (const TimedTable& table : tables) {
    if (!table.t_ns.empty()) first_ns = std::min(first_ns, table.t_ns.front());
  }
  std::vector<WrittenFile> written;
  for (const TimedTable& table : tables) {
    std::vector<std::string> header{"time_s"};
    for (const std::string& column : table.cells.names) header.push_back(PlainColumn(column));
    CsvWriter csv(header, false);
    for (std::size_t row = 0; row < table.t_ns.size(); ++row) {
      csv.Add(Seconds(table.t_ns[row] - first_ns));
      for (const auto& column : table.cells.texts) csv.Add(column[row]);
      csv.EndRow();
    }
    written.push_back({FileOf(folder, table.name, ".csv"), table.t_ns.size()});
    WriteTextFile(written.back().file, csv.text());
  }
  return written;
}

}  // namespace flextip::exports
