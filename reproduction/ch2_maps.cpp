// Maps of the measures over the two-link arm's workspace (2.3.1) and what the text says of them.
#include "reproduction/ch2_map_pictures.h"
#include "reproduction/ch2_parts.h"

namespace flextip {
namespace {

void Add(std::vector<Figure>& to, std::vector<Figure> more) {
  for (auto& figure : more) to.push_back(std::move(figure));
}

}  // namespace

ChapterResult Ch2Maps(const ReproduceOptions& options, const ChapterProgress& progress) {
  const double spacing_m = options.quick ? 0.01 : 0.0025;
  const double coarse_m = options.quick ? 0.01 : 0.004;
  const auto map = ComputeMap(ThesisSetup(kThesisError), {}, spacing_m);
  std::vector<WorkspaceMap<2>> four;
  for (const auto& error : FourErrors())
    four.push_back(ComputeMap(ThesisSetup(error.port_error_m), {}, coarse_m));
  ChapterResult result;
  result.figures.push_back(DrawWorkspaces());
  Add(result.figures, DrawMeasures(map));
  Add(result.figures, DrawDirections(map));
  Add(result.figures, DrawFourErrors(four));
  progress(1.0);
  return result;
}

}  // namespace flextip
