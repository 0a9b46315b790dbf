#include "apps/common/input/input_check.h"

#include <fmt/format.h>

#include <cstdio>

#include "apps/common/input/findings.h"
#include "core/error.h"
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
  for (const Finding& f : found.stopping) fmt::print(stderr, "{}", FindingText("wrong", f));
  if (!check.quiet)
    for (const Finding& f : found.beware) fmt::print(stderr, "{}", FindingText("beware", f));
  if (!found.stopping.empty()) {
    const std::size_t count = found.stopping.size();
    throw WorkError(fmt::format(
        "{}: {} {} wrong, and {} would be wrong with {}: mend the recording, or go on with "
        "--no-check",
        check.recording.string(), count, count == 1 ? "thing is" : "things are", use.command,
        count == 1 ? "it" : "them"));
  }
  plausibility::LeaveOut(found.left_out, recording);
  return found.beware;
}

}  // namespace flextip
