#include "apps/shape/table.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "core/check.h"
#include "recording/text/csv.h"

namespace flextip {
namespace {

void Add(std::vector<std::string>& names, const std::string& name) {
  for (const char* axis : {"_x", "_y", "_z"}) names.push_back(name + axis);
}

std::vector<std::string> InputColumns() {
  std::vector<std::string> names{"length_m", "bending_stiffness_Nm2"};
  for (const char* name : {"p_wrist_m", "p_port_m", "f_tip_N", "q_weight_N_per_m"})
    Add(names, name);
  return names;
}

std::vector<std::string> AllColumns() {
  auto names = InputColumns();
  for (const char* name : {"p_tip_m", "t_wrist", "t_tip"}) Add(names, name);
  names.emplace_back("s_port_m");
  for (const char* name : {"f_port_on_shaft_N", "f_wrist_on_shaft_N", "m_at_half_wrist_segment_Nm",
                           "m_at_half_tip_segment_Nm"}) {
    Add(names, name);
  }
  names.emplace_back("status");
  return names;
}

constexpr int kShapeNumbers = 22;  ///< result columns before `status`

void Add(CsvWriter& csv, const Eigen::Vector3d& v) { csv.Add(v.x()).Add(v.y()).Add(v.z()); }

void AddShape(CsvWriter& csv, const Shape& shape) {
  for (const auto* v : {&shape.p_tip, &shape.t_wrist, &shape.t_tip}) Add(csv, *v);
  csv.Add(shape.s_port_m);
  for (const auto* v : {&shape.f_port, &shape.f_wrist, &shape.m_half_wrist, &shape.m_half_tip}) {
    Add(csv, *v);
  }
}

nlohmann::ordered_json List(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

std::vector<RodProblem> ReadShapeProblems(const std::filesystem::path& file) {
  ReadLog log;
  CsvReader csv(file, InputColumns(), log, {.from_recorder = false, .allow_other_columns = true});
  const auto vector = [&](std::size_t first) {
    return Eigen::Vector3d(csv.Number(first), csv.Number(first + 1), csv.Number(first + 2));
  };
  std::vector<RodProblem> problems;
  while (csv.Next()) {
    RodProblem problem;
    problem.length_m = csv.Number(0);
    problem.bending_stiffness_Nm2 = csv.Number(1);
    problem.p_wrist = vector(2);
    problem.p_port = vector(5);
    problem.f_tip = vector(8);
    problem.q_weight = vector(11);
    problems.push_back(problem);
  }
  return problems;
}

std::string ShapeTable(const std::vector<RodProblem>& problems, const std::vector<Shape>& shapes) {
  FLEXTIP_CHECK(problems.size() == shapes.size(), "a shape for each problem");
  CsvWriter csv(AllColumns());
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const auto& problem = problems[i];
    csv.Add(problem.length_m).Add(problem.bending_stiffness_Nm2);
    for (const auto* v : {&problem.p_wrist, &problem.p_port, &problem.f_tip, &problem.q_weight}) {
      Add(csv, *v);
    }
    if (shapes[i].IsUsable()) {
      AddShape(csv, shapes[i]);
    } else {
      csv.AddEmpty(kShapeNumbers);
    }
    csv.Add(shapes[i].status);
    csv.EndRow();
  }
  return csv.text();
}

std::string ShapeJson(const RodProblem& problem, const Shape& shape) {
  nlohmann::ordered_json json{{"status", shape.status},
                              {"length_m", problem.length_m},
                              {"bending_stiffness_Nm2", problem.bending_stiffness_Nm2},
                              {"p_wrist_m", List(problem.p_wrist)},
                              {"p_port_m", List(problem.p_port)},
                              {"f_tip_N", List(problem.f_tip)},
                              {"q_weight_N_per_m", List(problem.q_weight)}};
  if (shape.IsUsable()) {
    json["p_tip_m"] = List(shape.p_tip);
    json["t_wrist"] = List(shape.t_wrist);
    json["t_tip"] = List(shape.t_tip);
    json["s_port_m"] = shape.s_port_m;
    json["f_port_on_shaft_N"] = List(shape.f_port);
    json["f_wrist_on_shaft_N"] = List(shape.f_wrist);
    json["m_at_half_wrist_segment_Nm"] = List(shape.m_half_wrist);
    json["m_at_half_tip_segment_Nm"] = List(shape.m_half_tip);
  }
  return json.dump(2);
}

}  // namespace flextip
