#include "report/result_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/error.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"

namespace flextip::report {

double NumberIn(const std::string& cell) {
  return ParseNumber(cell).value_or(std::numeric_limits<double>::quiet_NaN());
}

namespace {

constexpr const char* kTimestamp = "timestamp [ns]";

std::ptrdiff_t Find(const ResultTable& table, const std::string& name) {
  const auto same = [&](const std::string& n) { return n == name || n.starts_with(name + " ["); };
  const auto it = std::find_if(table.names.begin(), table.names.end(), same);
  return it == table.names.end() ? -1 : it - table.names.begin();
}

bool IsTimed(const CsvReader& csv) { return csv.Columns().front() == kTimestamp; }

bool IsPicture(const std::filesystem::path& path) {
  const auto extension = path.extension().string();
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

}  // namespace

const std::vector<double>* ResultTable::Column(const std::string& name) const {
  const auto i = Find(*this, name);
  return i < 0 ? nullptr : &numbers[static_cast<std::size_t>(i)];
}

const std::vector<std::string>* ResultTable::Texts(const std::string& name) const {
  const auto i = Find(*this, name);
  return i < 0 ? nullptr : &texts[static_cast<std::size_t>(i)];
}

void ForEachTimedRow(const std::filesystem::path& path,
                     const std::function<void(const std::vector<std::string>& names, TimeNs t_ns,
                                              const std::vector<std::string>& cells)>& row) {
  ReadLog log;
  CsvReader csv(path, log, {.from_recorder = false});
  if (!IsTimed(csv)) {
    throw csv.Error(fmt::format("found {} as the first column, expected {}",
                                Quoted(csv.Columns().front()), kTimestamp));
  }
  std::vector<std::string> cells(csv.Columns().size());
  while (csv.Next()) {
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = csv.Text(i);
    row(csv.Columns(), csv.Integer(0), cells);
  }
}

ResultTable ReadResultTable(const std::filesystem::path& path) {
  ReadLog log;
  CsvReader csv(path, log, {.from_recorder = false});
  ResultTable table{.names = csv.Columns(), .numbers = {}, .texts = {}, .t_ns = {}};
  table.numbers.resize(table.names.size());
  table.texts.resize(table.names.size());
  const bool timed = IsTimed(csv);
  while (csv.Next()) {
    if (timed) table.t_ns.push_back(csv.Integer(0));
    for (std::size_t i = 0; i < table.names.size(); ++i) {
      table.texts[i].emplace_back(csv.Text(i));
      table.numbers[i].push_back(NumberIn(table.texts[i].back()));
    }
  }
  return table;
}

std::string ReadBytes(const std::filesystem::path& path) { return ReadTextFile(path); }

std::vector<std::filesystem::path> PicturesIn(const std::filesystem::path& folder,
                                              std::size_t limit) {
  std::vector<std::filesystem::path> all;
  if (!std::filesystem::is_directory(folder)) return all;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_regular_file() && IsPicture(entry.path())) all.push_back(entry.path());
  }
  std::sort(all.begin(), all.end());
  if (all.size() <= limit) return all;
  std::vector<std::filesystem::path> chosen;
  for (std::size_t i = 0; i < limit; ++i) {
    chosen.push_back(all[limit == 1 ? 0 : i * (all.size() - 1) / (limit - 1)]);
  }
  return chosen;
}

std::vector<std::filesystem::path> FoldersWith(const std::filesystem::path& folder,
                                               const std::string& name) {
  std::vector<std::filesystem::path> found;
  if (!std::filesystem::is_directory(folder)) return found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_directory() && std::filesystem::exists(entry.path() / name)) {
      found.push_back(entry.path());
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace flextip::report
