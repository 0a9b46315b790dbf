#include "exports/text_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

/// A column's name with its unit, and its cells, in the asked units.
struct Column {
  std::string name;
  double factor = 1.0;  ///< 1: cells are copied as they are
};

Column InUnits(const std::string& name, const TableUnits& units) {
  struct Change {
    const char *from, *to;
    double factor;
    bool wanted;
  };
  constexpr double kDegrees = 57.29577951308232;
  for (const Change& change : {Change{" [m]", " [mm]", 1e3, units.millimetres},
                               Change{" [m2]", " [mm2]", 1e6, units.millimetres},
                               Change{" [rad]", " [deg]", kDegrees, units.degrees}}) {
    const std::size_t kept = name.size() - std::min(name.size(), std::string(change.from).size());
    if (change.wanted && name.ends_with(change.from))
      return {name.substr(0, kept) + change.to, change.factor};
  }
  return {name};
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
                                       const std::filesystem::path& folder,
                                       const TableUnits& units) {
  TimeNs first_ns = std::numeric_limits<TimeNs>::max();
  for (const TimedTable& table : tables) {
    if (!table.cells.t_ns.empty()) first_ns = std::min(first_ns, table.cells.t_ns.front());
  }
  std::vector<WrittenFile> written;
  for (const TimedTable& table : tables) {
    std::vector<std::string> header{"time_s"};
    std::vector<double> factors;
    for (const std::string& name : table.cells.names) {
      const Column column = InUnits(name, units);
      header.push_back(PlainColumn(column.name));
      factors.push_back(column.factor);
    }
    CsvWriter csv(header, false);
    for (std::size_t row = 0; row < table.cells.t_ns.size(); ++row) {
      csv.Add(Seconds(table.cells.t_ns[row] - first_ns));
      for (std::size_t k = 0; k < factors.size(); ++k) {
        const std::string& cell = table.cells.texts[k][row];
        const double number = table.cells.numbers[k][row];
        const bool as_it_is = factors[k] == 1.0 || !std::isfinite(number);
        csv.Add(as_it_is ? cell : fmt::format("{}", factors[k] * number));
      }
      csv.EndRow();
    }
    written.push_back({FileOf(folder, table.name, ".csv"), table.cells.t_ns.size()});
    WriteTextFile(written.back().file, csv.text());
  }
  return written;
}

}  // namespace flextip::exports
