#include "apps/common/input/input_check.h"

#include <fmt/format.h>

#include <cstdio>

#include "apps/common/input/findings.h"
#include "plausibility/check_recording.h"
#include "plausibility/pictures/check_pictures.h"

namespace flextip {
namespace {

using plausibility::CheckResult;
using plausibility::Finding;

constexpr std::size_t kPictures = 4;  // to cost little beside the command

}  // namespace

void AddNoCheckOption(CLI::App& command, bool& skip) {
  command.add_flag("--no-check", skip,
                   "Do not check first whether the recording can be what it says");
}

std::vector<Finding> CheckInput(const InputCheck& check, const plausibility::CommandUse& use,
                                Recording& recording, const PicturesToCheck& pictures) {
  if (check.skip) return {};
  const plausibility::CheckOptions options{.unknown = use.unknown};
  CheckResult result = plausibility::CheckRecording(recording, options);
  if (pictures.frames != nullptr) {
    plausibility::CheckPictures(recording, *pictures.frames, options,
                                {.pictures = kPictures, .share = pictures.share}, result);
  }
  auto found = plausibility::SortForUse(result.findings, use);
  plausibility::LeaveOut(found.left_out, recording);
  std::vector<Finding> all = found.needed;
  all.insert(all.end(), found.beware.begin(), found.beware.end());
  for (const Finding& f : all) {
    const bool wrong = f.severity == plausibility::Severity::kWrong;
    if (check.silent || (check.quiet && !wrong)) continue;
    fmt::print(stderr, "{}", FindingText(wrong ? "wrong" : "beware", f));
  }
  return all;
}

}  // namespace flextip
