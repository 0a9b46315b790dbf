// Maps of the measures over the two-link arm's workspace (2.3.1), what the text says of them, and
// what 2.4 proposes to do with them.
#include <iterator>

#include "reproduction/chapter2/maps/pictures.h"
#include "reproduction/chapter2/maps/study.h"
#include "reproduction/chapter2/parts.h"
#include "workspace/outline.h"

namespace flextip::reproduction {
namespace {

template <class T>
void Add(std::vector<T>& to, std::vector<T> more) {
  std::move(more.begin(), more.end(), std::back_inserter(to));
}

std::vector<TableRow> CountWrists(double spacing_m) {
  const auto wrists = FindWristPositions({}, spacing_m);
  const double cm2 = 1e4 * spacing_m * spacing_m;
  return {
      {"Fig. 2.3 area of the wrist's workspace from which the shaft reaches the port",
       {},
       cm2 * double(wrists.reaching.size()),
       "cm2",
       ""},
      {"Fig. 2.3 area of the rest of it", {}, cm2 * double(wrists.not_reaching.size()), "cm2", ""}};
}

}  // namespace

ChapterResult Ch2Maps(const ReproduceOptions& options, const ChapterProgress& progress) {
  const double spacing_m = options.quick ? 0.01 : 0.0025;
  const double coarse_m = options.quick ? 0.02 : 0.005;
  const double four_m = options.quick ? 0.02 : 0.004;
  const auto map = ComputeMap(ThesisSetup(kThesisError), {}, spacing_m);
  std::vector<WorkspaceMap<2>> four;
  for (const auto& error : FourErrors())
    four.push_back(ComputeMap(ThesisSetup(error.port_error_m), {}, four_m));
  ChapterResult result;
  result.figures.push_back(DrawWorkspaces());
  Add(result.figures, DrawMeasures(map));
  Add(result.figures, DrawDirections(map));
  Add(result.figures, DrawFourErrors(four));
  progress(0.2);
  Add(result.rows, CountWrists(spacing_m));
  Add(result.rows, StudyMeasures(map));
  Add(result.rows, StudyGains(coarse_m));
  Add(result.rows, StudyDirections(map));
  Add(result.rows, StudyFourErrors(four));
  progress(0.5);
  Add(result.rows, StudyTolerances(coarse_m));
  PathStudy paths = StudyPaths(coarse_m);
  Add(result.rows, std::move(paths.rows));
  result.figures.push_back(std::move(paths.figure));
  progress(1.0);
  return result;
}

}  // namespace flextip::reproduction
