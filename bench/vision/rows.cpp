#include "bench/vision/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "recording/text/text.h"

namespace flextip::bench {
namespace {

using Json = nlohmann::json;

struct Number {
  const char* name;
  double PeerFigures::*field;
  bool of_pose;
};
constexpr Number kNumbers[] = {{"corner_rms_px", &PeerFigures::corner_rms_px, false},
                               {"pose_corner_rms_px", &PeerFigures::pose_corner_rms_px, true},
                               {"tip_rms_mm", &PeerFigures::tip_rms_mm, true},
                               {"tip_median_mm", &PeerFigures::tip_median_mm, true},
                               {"tip_largest_mm", &PeerFigures::tip_largest_mm, true},
                               {"depth_bias_mm", &PeerFigures::depth_bias_mm, true},
                               {"turn_rms_deg", &PeerFigures::turn_rms_deg, true}};
struct Count {
  const char* name;
  int PeerFigures::*field;
};
constexpr Count kCounts[] = {
    {"pictures", &PeerFigures::pictures},     {"tags", &PeerFigures::tags},
    {"tags_found", &PeerFigures::tags_found}, {"false_tags", &PeerFigures::false_tags},
    {"poses", &PeerFigures::poses},           {"false_poses", &PeerFigures::false_poses}};

Json ToJson(const PeerFigures& f) {
  Json one = {{"name", f.name}, {"ms", f.ms}};
  for (const Count& c : kCounts) one[c.name] = f.*c.field;
  for (const Number& n : kNumbers) {
    const bool measured = n.of_pose ? f.GoodPoses() > 0 : f.tags_found > 0;
    one[n.name] = measured ? Json(f.*n.field) : Json();
  }
  return one;
}

PeerFigures ToFigures(const Json& one) {
  PeerFigures f;
  f.name = one.at("name");
  f.ms = one.at("ms");
  for (const Count& c : kCounts) f.*c.field = one.at(c.name);
  for (const Number& n : kNumbers) {
    if (!one.at(n.name).is_null()) f.*n.field = one.at(n.name);
  }
  return f;
}

CompareRow ToRow(const std::string& line) {
  const Json json = Json::parse(line);
  CompareRow row{json.at("sweep"), json.at("unit"),      json.at("value"),
                 json.at("gamma"), json.at("with_pose"), {}};
  for (const Json& peer : json.at("peers")) row.peers.push_back(ToFigures(peer));
  return row;
}

// A dash where there was nothing to measure.
std::string Cell(double value, const char* format, bool measured) {
  return measured ? fmt::format(fmt::runtime(format), value) : "–";
}

std::string PoseCells(const PeerFigures& f) {
  const bool good = f.GoodPoses() > 0;
  return fmt::format("{} | {} | {} | {} | {} | {} of {} | {} of {} | {} | {:.1f}",
                     Cell(f.corner_rms_px, "{:.3f}", f.tags_found > 0),
                     Cell(f.pose_corner_rms_px, "{:.3f}", good), Cell(f.tip_rms_mm, "{:.3f}", good),
                     Cell(f.depth_bias_mm, "{:+.3f}", good), Cell(f.turn_rms_deg, "{:.3f}", good),
                     f.tags_found, f.tags, f.poses, f.pictures, f.false_poses, f.ms);
}

std::string TagCells(const PeerFigures& f) {
  return fmt::format("{} | {} of {} | {} | {:.1f}",
                     Cell(f.corner_rms_px, "{:.3f}", f.tags_found > 0), f.tags_found, f.tags,
                     f.false_tags, f.ms);
}

std::string Rule(int columns) {
  std::string rule = "|";
  for (int i = 0; i < columns; ++i) rule += "---|";
  return rule + '\n';
}

std::string ValueTable(const std::vector<CompareRow>& rows,
                       std::string (*cell)(const PeerFigures&)) {
  if (rows.empty()) return {};
  std::string table = "| " + rows[0].unit + " |";
  for (const CompareRow& row : rows) table += fmt::format(" {:g} |", row.value);
  table += '\n' + Rule(1 + static_cast<int>(rows.size()));
  for (std::size_t k = 0; k < rows[0].peers.size(); ++k) {
    table += "| " + rows[0].peers[k].name + " |";
    for (const CompareRow& row : rows) table += ' ' + cell(row.peers[k]) + " |";
    table += '\n';
  }
  return table;
}

}  // namespace

std::string RowText(const CompareRow& row) {
  Json json = {{"sweep", row.sweep}, {"unit", row.unit},           {"value", row.value},
               {"gamma", row.gamma}, {"with_pose", row.with_pose}, {"peers", Json::array()}};
  for (const PeerFigures& f : row.peers) json["peers"].push_back(ToJson(f));
  return json.dump();
}

std::vector<CompareRow> ReadRows(const std::filesystem::path& file) {
  std::vector<CompareRow> rows;
  if (!std::filesystem::exists(file)) return rows;
  std::istringstream text(ReadTextFile(file));
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    if (text.eof()) break;  // torn: a whole line ends
    try {
      rows.push_back(ToRow(line));
    } catch (const Json::exception& error) {
      throw InputError(fmt::format("{}:{}: expected a row of the comparison: {}", file.string(),
                                   number, error.what()));
    }
  }
  return rows;
}

std::string CompareTable(const std::vector<CompareRow>& rows) {
  if (rows.empty()) return {};
  const bool swept = !rows[0].unit.empty();
  std::string table = swept ? "| " + rows[0].unit + " | |" : "| |";
  table += rows[0].with_pose
               ? " corner RMS px | of the pose's corners px | tip RMS mm | depth bias mm | turn "
                 "deg | tags found | poses | false poses | ms |\n"
               : " corner RMS px | tags found | other tags | ms |\n";
  table += Rule((swept ? 2 : 1) + (rows[0].with_pose ? 9 : 4));
  for (const CompareRow& row : rows) {
    for (const PeerFigures& f : row.peers) {
      if (swept) table += fmt::format("| {:g} ", row.value);
      table += fmt::format("| {} | {} |\n", f.name, row.with_pose ? PoseCells(f) : TagCells(f));
    }
  }
  return table;
}

std::string TipTable(const std::vector<CompareRow>& rows) {
  return ValueTable(rows, [](const PeerFigures& f) {
    std::string cell = Cell(f.tip_rms_mm, "{:.3f}", f.GoodPoses() > 0);
    if (f.false_poses > 0) cell += fmt::format(" ({} false)", f.false_poses);
    return cell;
  });
}

std::string RecallTable(const std::vector<CompareRow>& rows) {
  return ValueTable(rows,
                    [](const PeerFigures& f) { return Cell(100 * f.Recall(), "{:.0f}", true); });
}

std::vector<Panel> ComparePlots(const std::vector<CompareRow>& rows, const std::string& y_label,
                                double (*figure)(const PeerFigures&), bool log_y) {
  std::vector<Panel> plots;
  for (const CompareRow& row : rows) {
    auto plot = std::find_if(plots.begin(), plots.end(),
                             [&](const Panel& p) { return p.title == row.sweep; });
    if (plot == plots.end()) {
      plot = plots.insert(plots.end(),
                          {row.sweep, row.unit, y_label, row.sweep != "angle", log_y, {}});
    }
    for (const PeerFigures& f : row.peers) {
      auto line = std::find_if(plot->lines.begin(), plot->lines.end(),
                               [&](const PlotLine& l) { return l.name == f.name; });
      if (line == plot->lines.end()) line = plot->lines.insert(plot->lines.end(), {f.name, {}});
      line->points.emplace_back(row.value, figure(f));
    }
  }
  return plots;
}

}  // namespace flextip::bench
