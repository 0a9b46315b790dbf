#include "report/result_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <string_view>

#include "core/error.h"
#include "report/unit_suffix.h"

namespace flextip::report {
namespace {

std::string Trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

/// A cell in quotes may hold commas, and quotes as "" (RFC 4180).
std::vector<std::string> Cells(std::string_view line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"') {
        cells.back() += line[i++];
      } else {
        quoted = !quoted;
      }
    } else if (line[i] == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  for (auto& cell : cells) cell = Trimmed(cell);
  return cells;
}

}  // namespace

double NumberIn(const std::string& cell) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return value;
}

namespace {

std::ptrdiff_t Find(const ResultTable& table, const std::string& name) {
  const auto same = [&](const std::string& n) { return n == name || n.starts_with(name + " ["); };
  const auto it = std::find_if(table.names.begin(), table.names.end(), same);
  return it == table.names.end() ? -1 : it - table.names.begin();
}

bool IsPicture(const std::filesystem::path& path) {
  const auto extension = path.extension().string();
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

constexpr std::array<UnitSuffix, 13> kUnits{{{"_m_N", "mm/N", 1000},
                                             {"_Nm2", "N m²", 1},
                                             {"_N_m", "N/m", 1},
                                             {"_Nm", "N m", 1},
                                             {"_mm", "mm", 1},
                                             {"_ms", "ms", 1},
                                             {"_us", "µs", 1},
                                             {"_px", "px", 1},
                                             {"_rad", "mrad", 1000},
                                             {"_deg", "°", 1},
                                             {"_hz", "Hz", 1},
                                             {"_m", "mm", 1000},
                                             {"_N", "N", 1}}};

}  // namespace

const std::vector<double>* ResultTable::Column(const std::string& name) const {
  const auto i = Find(*this, name);
  return i < 0 ? nullptr : &numbers[static_cast<std::size_t>(i)];
}

const std::vector<std::string>* ResultTable::Texts(const std::string& name) const {
  const auto i = Find(*this, name);
  return i < 0 ? nullptr : &texts[static_cast<std::size_t>(i)];
}

void ForEachRow(const std::filesystem::path& path,
                const std::function<void(const std::vector<std::string>& names,
                                         const std::vector<std::string>& cells)>& row) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) throw InputError::At(path.string(), 0, "no table to read");
  const auto names = Cells(line.starts_with('#') ? line.substr(1) : line);
  for (long number = 2; std::getline(file, line); ++number) {
    if (Trimmed(line).empty()) continue;
    const auto cells = Cells(line);
    if (cells.size() != names.size()) {
      throw InputError::At(path.string(), number,
                           fmt::format("{} cells, expected {}", cells.size(), names.size()));
    }
    row(names, cells);
  }
}

ResultTable ReadResultTable(const std::filesystem::path& path) {
  ResultTable table;
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) throw InputError::At(path.string(), 0, "no table to read");
  table.names = Cells(line.starts_with('#') ? line.substr(1) : line);
  table.numbers.resize(table.names.size());
  table.texts.resize(table.names.size());
  ForEachRow(path, [&](const auto&, const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      table.numbers[i].push_back(NumberIn(cells[i]));
      table.texts[i].push_back(cells[i]);
    }
  });
  return table;
}

std::string ReadBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError::At(path.string(), 0, "cannot be read");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

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

std::string SpokenName(const std::string& key) {
  std::string name = key;
  if (const UnitSuffix* unit = SuffixOf(key, kUnits)) {
    name.resize(name.size() - unit->ending.size());
  }
  std::replace(name.begin(), name.end(), '_', ' ');
  return name == "seconds" ? "time taken" : name;
}

std::string SpokenValue(const std::string& key, double value) {
  if (key == "seconds") return fmt::format("{:.3g} s", value);
  const UnitSuffix* unit = SuffixOf(key, kUnits);
  if (unit == nullptr) {
    const bool whole = value == std::floor(value) && std::abs(value) < 1e9;
    return whole ? fmt::format("{:.0f}", value) : fmt::format("{:.4g}", value);
  }
  const double shown = value * unit->factor;
  return std::abs(shown) < 1000 ? fmt::format("{:.3g} {}", shown, unit->shown)
                                : fmt::format("{:.1f} {}", shown, unit->shown);
}

}  // namespace flextip::report
