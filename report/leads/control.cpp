#include "report/leads/control.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "report/leads/numbers.h"
#include "report/result_files.h"
#include "report/stops/stops.h"

namespace flextip::report::leads {
namespace {

using Json = nlohmann::ordered_json;

/// A time of the summary in ms.
double Ms(const Json& summary, const char* spread, const char* part) {
  return summary.contains(spread) ? 1e3 * Number(summary[spread], part) : 0.0;
}

std::string TimesText(const Json& summary) {
  return fmt::format(
      "From begin to command a cycle takes {:.2g} ms, 99 % of them at most {:.2g} ms; it begins at "
      "most {:.2g} ms late.",
      Ms(summary, "work", "p50_s"), Ms(summary, "work", "p99_s"),
      Ms(summary, "wake_late", "worst_s"));
}

Head TimingLead(const Json& summary, Head head) {
  const double missed = Number(summary, "missed_cycles"), cycles = Number(summary, "cycles");
  head.says = missed == 0.0 ? fmt::format("None of {:.0f} cycles was missed.", cycles)
                            : fmt::format("{:.0f} of {:.0f} cycles were missed.", missed, cycles);
  head.more = TimesText(summary) + " It enabled nothing.";
  head.next = "watch the streams while somebody else moves the robot";
  head.command = "flextip control RECORDING --wait --page -o RESULT-watched";
  if (missed > 0.0) {
    head.next = "give the cycle a lower rate_hz, or the machine less other work, and measure again";
    head.command = "";
  }
  return head;
}

}  // namespace

Head ControlLead(const std::filesystem::path& folder) {
  const Json summary = Json::parse(ReadBytes(folder / "summary.json"));
  if (!Has(summary, "cycles") || !Has(summary, "missed_cycles")) return {};
  Head head{.grade = kGood};
  const auto beware = [&head](const std::string& why) {
    head.grade = kBeware;
    head.reasons.push_back(why);
  };
  if (Number(summary, "missed_cycles") > 0.0)
    beware(fmt::format(
        "{:.0f} missed cycles: the one before took too long, or the system woke it late",
        Number(summary, "missed_cycles")));
  if (Number(summary, "unsent_commands") > 0.0)
    beware(fmt::format("{:.0f} commands were not sent: the robot was gone, or did not read",
                       Number(summary, "unsent_commands")));
  if (!summary.value("robot_not_enabled_at_end", true))
    beware("the robot did not say that it is paused: it was enabled when the run ended");
  if (summary.value("only_timing", false)) return TimingLead(summary, head);
  const bool done = summary.value("path_done", false);
  head.says = done ? fmt::format("The tip followed its path to the end, in {:.3g} s.",
                                 Number(summary, "duration_s"))
                   : fmt::format("The run ended after {:.3g} s, before the path was done.",
                                 Number(summary, "duration_s"));
  if (const auto stops = StopsIn(folder); !stops.empty()) {
    head.grade = kBeware;
    head.more = head.says;
    head.says = StopSays(stops.front());
  }
  if (!done)
    beware("the table of holds below says for how many cycles the robot was held, and why");
  head.more += (head.more.empty() ? "" : " ") + TimesText(summary);
  head.next = "let a diagnosis say what the simulation gets wrong of this run";
  head.command = "flextip diagnose RESULT -o RESULT-cause";
  return head;
}

}  // namespace flextip::report::leads
