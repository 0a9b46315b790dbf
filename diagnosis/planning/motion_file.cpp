#include "diagnosis/planning/motion_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/check.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip::diagnosis {
namespace {

std::string NamesOf(const NextMotion& plan) {
  std::string names;
  for (std::size_t i = 0; i < plan.rivals.size(); ++i) {
    if (i > 0) names += i + 1 < plan.rivals.size() ? ", " : " and ";
    names += fmt::format("{}", fmt::join(plan.rivals[i], "+"));
  }
  return names;
}

std::string Task(const NextMotion& plan) {
  if (plan.rivals.size() == 1)
    return fmt::format("make sure of {}", fmt::join(plan.rivals[0], "+"));
  return fmt::format("tell {} apart", NamesOf(plan));
}

}  // namespace

std::string Sentence(const NextMotion& plan) {
  if (!plan.needed) return "Nothing has to be told apart: no motion is planned.";
  if (plan.places_m.empty()) {
    return fmt::format("No motion within the limits was found to {}.", Task(plan));
  }
  const std::string weight =
      plan.load_N > 0.0 ? fmt::format(", with {:.2g} N hung from the tip", plan.load_N) : "";
  if (plan.seconds_to_certain) {
    return fmt::format("{:.1f} s of the planned motion{} are enough to {}.", plan.seconds, weight,
                       Task(plan));
  }
  if (plan.probability >= kCertain) {
    return fmt::format(
        "{:.1f} s of the planned motion{} should just do to {}: if {} is right, it will be {:.0f} "
        "% "
        "likely.",
        plan.seconds, weight, Task(plan), fmt::join(plan.least_sure, "+"),
        100.0 * plan.probability);
  }
  return fmt::format(
      "{:.1f} s of the planned motion{} are not enough to {}: if {} is right, it will be {:.0f} % "
      "likely.",
      plan.seconds, weight, Task(plan), fmt::join(plan.least_sure, "+"), 100.0 * plan.probability);
}

std::string MotionYaml(const NextMotion& plan) {
  FLEXTIP_CHECK(!plan.places_m.empty(), "a motion has places");
  std::string text = fmt::format("# {}\n", Sentence(plan));
  text += "# The tip goes from wherever it is to where the recording ended, then on.\n";
  text += fmt::format("frame: R\nspeed_m_s: {}\nsettle_s: 0.5\nwaypoints:\n",
                      YamlNumber(plan.speed_m_s));
  for (const Eigen::Vector3d& p : plan.places_m)
    text += fmt::format("  - {{to_m: {}}}\n", YamlNumbers({p.x(), p.y(), p.z()}));
  return text;
}

void WriteMotion(const std::filesystem::path& file, const NextMotion& plan) {
  WriteTextFile(file, MotionYaml(plan));
}

}  // namespace flextip::diagnosis
