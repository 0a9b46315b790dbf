#include "stops/open_excerpt.h"

#include <fmt/format.h>

#include <tuple>

#include "stops/words.h"

namespace flextip {

std::vector<OpenExcerpt> OpenExcerpts(const std::vector<StopEvent>& found, StopsOfRun& stops) {
  std::vector<OpenExcerpt> excerpts;
  for (const StopEvent& stop : Gravest(found, kMostExcerpts)) {
    OpenExcerpt& open = excerpts.emplace_back();
    open.stop = stop;
    open.number = stops.kept.size();
    std::tie(open.from_ns, open.to_ns) = SpanOf(stop);
    stops.kept.push_back({StopFolder(open.number + 1, stop), "", {}});
  }
  return excerpts;
}

void CloseExcerpt(const OpenExcerpt& open, const StoppedRun& run,
                  const std::filesystem::path& folder, const std::string& detail,
                  const std::string& why, StopsOfRun& stops) {
  StopStory story = TellStop(run, open.stop, open.moments);
  story.facts.detail = detail;
  WriteStopTable(folder, story, run.start_ns);
  KeptStop& kept = stops.kept[open.number];
  kept.facts = story.facts;
  kept.says = SayStop(story.facts);
  if (open.differ == 0) return;
  kept.warnings.push_back(
      fmt::format("{} of {} cycles came out differently when the excerpt was cut: {}", open.differ,
                  open.moments.size(), why));
}

}  // namespace flextip
