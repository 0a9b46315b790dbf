// flextip shape: the shaft's equilibrium for given wrist, port and load, one or a table of them.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/length_option.h"
#include "apps/common/next_step.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "apps/common/vector_option.h"
#include "apps/shape/figures.h"
#include "apps/shape/table.h"
#include "core/error.h"
#include "kinematics/shaft_shape.h"
#include "recording/text/text.h"
#include "report/drawing/picture.h"
#include "report/pages.h"
#include "report/report.h"

namespace flextip {
namespace {

struct ShapeOptions {
  RodProblem problem;
  ShapeModel model = ShapeModel::kRod;
  bool json = false;
  bool has_force = false;  ///< --force x,y,z was given
  std::string unit = "m";  ///< of printed lengths; JSON and files stay in SI
  bool replace = false;    ///< --force was given without a value
  std::filesystem::path plot, batch, out;
};

constexpr const char* kNoValue = "";  // what CLI11 hands on for an option without its value

const std::map<std::string, ShapeModel> kModels{
    {"rod", ShapeModel::kRod}, {"beam", ShapeModel::kBeam}, {"straight", ShapeModel::kStraight}};

// Adding zero turns -0 into 0.
std::string Triple(const Eigen::Vector3d& v) {
  return fmt::format("{:>13.7g} {:>13.7g} {:>13.7g}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

void PrintShape(const Shape& shape, const std::string& unit) {
  const double scale = unit == "mm" ? 1e3 : 1.0;
  fmt::print("{:<23} {}\n", fmt::format("tip ({})", unit), Triple(scale * shape.p_tip));
  fmt::print("tangent at the wrist    {}\n", Triple(shape.t_wrist));
  fmt::print("tangent at the tip      {}\n", Triple(shape.t_tip));
  fmt::print("force of the port (N)   {}\n", Triple(shape.f_port));
  fmt::print("force of the wrist (N)  {}\n", Triple(shape.f_wrist));
  fmt::print("{:<23} {:>13.7g}\n", fmt::format("port along shaft ({})", unit),
             scale * shape.s_port_m);
}

/// The solved shape, or the error that says what was wrong with the problem.
Shape SolveOne(const ShapeOptions& options) {
  Shape shape = SolveShape(options.problem, options.model);
  if (shape.IsUsable()) return shape;
  const RodProblem& p = options.problem;
  const auto what = fmt::format(
      "shape: {} (length {:.6g} m, stiffness {:.6g} N m2, the port is {:.6g} m from the wrist)",
      shape.status, p.length_m, p.bending_stiffness_Nm2, (p.p_port - p.p_wrist).norm());
  if (shape.bad_input) throw InputError(what);
  throw WorkError(what);
}

nlohmann::json Counts(const std::vector<Shape>& shapes) {
  std::map<std::string, int> statuses;
  for (const auto& shape : shapes) ++statuses[shape.status];
  return {{"shapes", shapes.size()}, {"ok", statuses["ok"]}, {"statuses", statuses}};
}

void WriteResults(OutputFolder& output, const std::vector<RodProblem>& problems,
                  const std::vector<Shape>& shapes) {
  WriteTextFile(output.folder() / "shapes.csv", ShapeTable(problems, shapes));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!shapes[i].IsUsable()) output.Warn(fmt::format("row {}: {}", i + 1, shapes[i].status));
  }
  output.WriteSummary(Counts(shapes));
  report::WriteShapeReport(output.folder());
  output.Commit();
}

/// Writes a page where the name ends in .html, else a picture; makes the folder.
void WritePlot(const std::filesystem::path& file, const std::vector<report::Figure>& figures) {
  std::error_code error;  // without the folder the file cannot be written, which is reported
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  if (file.extension() != ".html") {
    report::WritePicture(file, figures);
    return;
  }
  report::Report page("Shape of the shaft");
  page.AddFigures(figures);
  page.Write(file);
}

void RunSingle(const ShapeOptions& options) {
  const Shape shape = SolveOne(options);
  if (options.json) {
    fmt::print("{}\n", ShapeJson(options.problem, shape));
  } else {
    PrintShape(shape, options.unit);
  }
  if (!options.plot.empty()) {
    WritePlot(options.plot, ShapeFigures(options.problem, shape));
  }
  if (options.out.empty()) return;
  OutputFolder output(options.out, "shape", {.force = options.replace});
  const auto figures = ShapeFigures(options.problem, shape);
  report::WriteFigures(output.folder() / "figures.json", figures);
  report::WritePicture(output.folder() / "shape.png", figures);
  WriteResults(output, {options.problem}, {shape});
}

void RunBatch(const ShapeOptions& options, bool quiet) {
  const auto problems = ReadShapeProblems(options.batch);
  OutputFolder output(options.out, "shape", {.force = options.replace, .inputs = {options.batch}});
  std::vector<Shape> shapes;
  {
    Progress progress("shapes", problems.size(), quiet);
    for (const auto& problem : problems) {
      shapes.push_back(SolveShape(problem, options.model));
      progress.Update(shapes.size());
    }
  }
  WriteResults(output, problems, shapes);
  if (quiet) return;
  fmt::print("{} shapes in {}\n", shapes.size(), (options.out / "shapes.csv").string());
  PrintNextOf(output.folder());
}

/// --tip-force is the load and --overwrite the leave to replace earlier results. --force stands for
/// both, as scripts have it: with a value the load, alone the leave. It may be given twice.
void AddForceOptions(CLI::App& command, ShapeOptions& options) {
  const auto take = [&options](const std::vector<std::string>& texts) {
    for (const auto& text : texts) {
      const auto force = ParseVector(text);
      if (!force && text != kNoValue) {
        throw CLI::ValidationError("--tip-force", "'" + text + "' is not x,y,z");
      }
      if (force) options.problem.f_tip = *force;
      (force ? options.has_force : options.replace) = true;
    }
  };
  command
      .add_option_function<std::string>(
          "--tip-force", [take](const std::string& text) { take({text}); },
          "Force on the tip in R (N)")
      ->type_name("X,Y,Z");
  command.add_flag("--overwrite", options.replace, "Replace the folder of an earlier run");
  command
      .add_option_function<std::vector<std::string>>("--force", take,
                                                     "With X,Y,Z: --tip-force; alone: --overwrite")
      ->type_name("X,Y,Z")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(0, 1);
}

void AddProblemOptions(CLI::App& command, RodProblem& problem, CLI::Option* batch) {
  const auto positive = [](const std::string& text) -> std::string {
    const auto number = ParseFinite(text);
    return number && *number > 0 ? "" : "'" + text + "' is not a positive number";
  };
  std::vector<CLI::Option*> options{
      AddLength(command, "--length", problem.length_m,
                "From the wrist's pivot to the tip: 0.6 or 600mm")
          ->check(CLI::Validator(positive, "")),
      command.add_option("--stiffness", problem.bending_stiffness_Nm2, "E I (N m2)")
          ->check(CLI::Validator(positive, "NM2")),
      AddPlaceOption(command, "--wrist", problem.p_wrist, "The wrist's pivot in R"),
      AddPlaceOption(command, "--port", problem.p_port, "The port in R: 0.28,0,0 or 280mm,0,0"),
      AddVectorOption(command, "--weight", problem.q_weight, "Weight per length in R (N/m)")};
  for (auto* option : options) option->excludes(batch);
}

/// Without a table, what a single shape needs must be there; with one, a place for the results.
void CheckUsage(const CLI::App& command, const ShapeOptions& options) {
  if (!options.batch.empty()) {
    if (options.has_force) throw InputError("shape: --batch takes the forces from its table");
    if (options.out.empty()) throw InputError("shape: --batch needs -o OUT");
    if (options.json || !options.plot.empty()) {
      throw InputError("shape: --json and --plot are for single shapes, not for --batch");
    }
    return;
  }
  const std::set<std::filesystem::path> endings{".html", ".pdf", ".png", ".svg"};
  if (!options.plot.empty() && !endings.contains(options.plot.extension())) {
    throw InputError("shape: --plot takes a name that ends in .png, .svg, .pdf or .html");
  }
  for (const char* name : {"--length", "--stiffness", "--wrist", "--port"}) {
    if (command.count(name) == 0) throw InputError(fmt::format("shape: {} is required", name));
  }
  if (!options.has_force) throw InputError("shape: --tip-force X,Y,Z is required");
}

}  // namespace

void AddShape(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("shape", "The shaft's equilibrium: tip, tangents, reactions");
  auto options = std::make_shared<ShapeOptions>();
  auto* batch = command->add_option("--batch", options->batch, "Solve every row of a table");
  AddProblemOptions(*command, options->problem, batch);
  AddForceOptions(*command, *options);
  command->add_option("--model", options->model, "rod (exact), beam (thesis) or straight")
      ->transform(CLI::CheckedTransformer(kModels).description(""))
      ->type_name("MODEL");
  command->add_option("--unit", options->unit, "Of the lengths that are printed: m or mm")
      ->check(CLI::IsMember({"m", "mm"}))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print the shape as JSON");
  command->add_option("--plot", options->plot,
                      "Draw the shape into this file: .png, .svg, .pdf or .html");
  command->add_option("-o,--output", options->out, "Folder for the results");
  command->footer(
      "Examples:\n"
      "  flextip shape --length 0.6 --stiffness 0.304 --wrist 0,0,0 --port 0.28,0,0 \\\n"
      "      --tip-force 0,0,-2 --plot shape.png\n"
      "  flextip shape --batch problems.csv -o shapes\n");
  OnRun(*command, context, [command, options, &context] {
    CheckUsage(*command, *options);
    if (options->batch.empty()) {
      RunSingle(*options);
    } else {
      RunBatch(*options, context.quiet);
    }
  });
}

}  // namespace flextip
