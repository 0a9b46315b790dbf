// flextip board: a calibration board to print to scale.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "apps/calibrate/verdict_json.h"
#include "apps/common/commands.h"
#include "apps/common/input/camera_option.h"
#include "apps/common/output.h"
#include "calibration/boards/face.h"
#include "report/pages.h"
#include "targets/board/print.h"
#include "targets/board/verdict.h"

namespace flextip {
namespace {

struct BoardOptions {
  std::string spec = "charuco:9x7:0.012:0.009:DICT_4X4_50";
  std::string paper = "a4";
  CameraOption camera;
  std::filesystem::path out;
  bool force = false;
};

void RunBoard(const BoardOptions& options, bool quiet) {
  const BoardSpec board = ParseBoardSpec(options.spec);
  const BoardFace face = FaceOf(board);
  const BoardOnPaper place = PlaceBoard(face, PaperOf(options.paper));
  const BoardReach reach = ReachOf(face, ReadCamera(options.camera));
  OutputFolder output(options.out, "board",
                      {.force = options.force, .inputs = {options.camera.file}});
  const auto& folder = output.folder();
  PrintBoard(face, place, options.spec, folder / "print.pdf");
  PrintBoard(face, place, options.spec, folder / "print.png");
  const CalibrationVerdict verdict = JudgeBoard(options.spec, face, place, reach);
  output.WriteSummary({{"verdict", VerdictJson(verdict)},
                       {"board", options.spec},
                       {"paper", place.paper.name},
                       {"corners", BoardCorners(board).size()},
                       {"width_m", face.extent.sizes().x()},
                       {"height_m", face.extent.sizes().y()},
                       {"cell_m", face.cell_m},
                       {"fills_view_at_m", reach.fills_at_m},
                       {"readable_to_m", reach.readable_to_m}});
  report::WriteReport(folder);
  const auto name = output.name();
  output.Commit();
  if (quiet) return;
  fmt::print("{}\nprint  {}\npage   {}\n", verdict.says, (name / "print.pdf").string(),
             (name / "report.html").string());
}

}  // namespace

void AddBoard(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("board", "A calibration board to print to scale");
  auto options = std::make_shared<BoardOptions>();
  command
      ->add_option("board", options->spec,
                   "chessboard:COLSxROWS:SQUARE_M, charuco:COLSxROWS:SQUARE_M:MARKER_M:DICT or "
                   "aprilgrid:COLSxROWS:TAG_M:GAP_M")
      ->capture_default_str()
      ->type_name("BOARD");
  command->add_option("-o,--output", options->out, "Folder for the results")
      ->required()
      ->type_name("OUT");
  command->add_option("--paper", options->paper, "a4, a3, letter, ...")->capture_default_str();
  AddCameraOption(*command, options->camera);
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Examples:\n"
      "  flextip board -o board                              # for a laparoscope at 5 to 15 cm\n"
      "  flextip board aprilgrid:6x6:0.02:0.005 -o board\n"
      "  flextip calibrate camera pictures/*.png --board BOARD -o camera    # then\n");
  OnRun(*command, context, [options, &context] { RunBoard(*options, context.quiet); });
}

}  // namespace flextip
