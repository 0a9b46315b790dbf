// The reference table of exact rod equilibria, read by column name.
#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "kinematics/rod.h"

namespace flextip {

using ReferenceRow = std::map<std::string, double>;

/// Returns the rows of testdata/reference/rod_equilibria.csv, each column by its name.
inline std::vector<ReferenceRow> ReadRodReference() {
  std::ifstream file(FLEXTIP_SOURCE_DIR "/testdata/reference/rod_equilibria.csv");
  const auto split = [](const std::string& line) {
    std::vector<std::string> cells;
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    return cells;
  };
  std::string line;
  if (!std::getline(file, line)) return {};
  const std::vector<std::string> names = split(line.substr(1));
  std::vector<ReferenceRow> rows;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = split(line);
    ReferenceRow row;
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = std::stod(cells[i]);
    rows.push_back(row);
  }
  return rows;
}

inline Eigen::Vector3d Vector(const ReferenceRow& row, const std::string& name) {
  return {row.at(name + "_x"), row.at(name + "_y"), row.at(name + "_z")};
}

inline RodProblem Problem(const ReferenceRow& row) {
  return {row.at("length_m"),       row.at("bending_stiffness_Nm2"),
          Vector(row, "p_wrist_m"), Vector(row, "p_port_m"),
          Vector(row, "f_tip_N"),   Vector(row, "q_weight_N_per_m")};
}

}  // namespace flextip
