#include "report/labels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "report/unit_suffix.h"

namespace flextip::report {
namespace {

constexpr std::array<UnitSuffix, 16> kUnits{{{"_m_N", "mm/N", 1000},
                                             {"_Nm2", "N m²", 1},
                                             {"_N_m", "N/m", 1},
                                             {"_Nm", "N m", 1},
                                             {"_cm2", "cm²", 1},
                                             {"_mm", "mm", 1},
                                             {"_ms", "ms", 1},
                                             {"_us", "µs", 1},
                                             {"_px", "px", 1},
                                             {"_grey", "grey levels", 1},
                                             {"_rad", "mrad", 1000},
                                             {"_deg", "°", 1},
                                             {"_hz", "Hz", 1},
                                             {"_m", "mm", 1000},
                                             {"_N", "N", 1},
                                             {"_s", "s", 1}}};

using Labelled = std::pair<std::string, std::string>;

/// Keys of summary.json; "COMMAND KEY" where a key means something else there. Of a command the
/// first are the most important.
const std::vector<Labelled>& Labels() {
  static const std::vector<Labelled> labels{
      {"seconds", "time taken"},
      // track
      {"track ok", "frames with the tip seen"},
      {"track predicted", "frames with the tip predicted"},
      {"track lost", "frames with the tip lost"},
      {"scored_frames", "seen frames compared with the truth"},
      {"scored_frames_predicted", "predicted frames compared with the truth"},
      {"tip_rms_error_m", "tip error, RMS"},
      {"tip_max_error_m", "tip error, largest"},
      {"tip_rms_error_across_m", "tip error across the view, RMS"},
      {"tip_rms_error_depth_m", "tip error in depth, RMS"},
      {"tip_mean_nees", "tip error² over its variance (honest: 3)"},
      {"tip_share_inside_95", "tip errors inside their 95 % ellipsoid"},
      {"predicted_tip_rms_error_m", "predicted tip's error, RMS"},
      {"predicted_tip_max_error_m", "predicted tip's error, largest"},
      {"predicted_tip_mean_nees", "predicted tip's error² over its variance (honest: 3)"},
      {"predicted_tip_share_inside_95", "predicted tip's errors inside their 95 % ellipsoid"},
      {"frames_by_pixels", "frames fitted to the tags' pixels"},
      {"frames_by_corners", "frames fitted to the tags' corners"},
      {"tags_per_frame", "tags a frame"},
      {"noise_grey", "noise of the tags' pixels"},
      {"rms_reprojection_error_px", "corners to the fit, RMS"},
      // simulate
      {"rendered", "seen through rendered frames"},
      {"max_deviation_m", "largest deviation"},
      {"rms_deviation_m", "deviation, RMS"},
      {"final_error_m", "error at the end"},
      {"updates", "control steps"},
      {"steps_limited", "steps cut to their bound"},
      {"steps_damped", "steps damped near a singularity"},
      // estimate
      {"tip_sd_m", "standard deviation of the tip, an axis"},
      {"force_across_sd_N", "standard deviation of the tip's force across the shaft"},
      {"force_along_sd_N", "standard deviation of the tip's force along the shaft"},
      {"chi2_per_measurement", "misfit² over its variance (noise alone: 1)"},
      {"estimate ok", "samples estimated"},
      {"estimate unobservable", "samples whose load no sensor shows"},
      {"estimate not_converged", "samples without convergence"},
      {"estimate bad_input", "samples with readings that are no numbers"},
      {"scored_samples", "samples compared with the truth"},
      // diagnose
      {"heldout_error_ratio", "held-out error over the base's"},
      {"fits", "models fitted"},
      {"failed_samples", "samples without an equilibrium"},
      // predict
      {"ratio", "error over the base's"},
      {"tip_ratio", "tip's error over the base's"},
      {"extended_tip_rms_m", "predicted tip, RMS"},
      {"base_tip_rms_m", "predicted tip by the base, RMS"},
      {"extended_tip_mean_m", "predicted tip, mean"},
      {"base_tip_mean_m", "predicted tip by the base, mean"},
      {"judged_samples", "samples judged"},
      // shape
      {"shape ok", "shapes solved"},
      // control
      {"path_done", "path followed to its end"},
      {"robot_not_enabled_at_end", "robot not enabled at the end"},
      {"missed_cycles", "missed cycles"},
      {"unsent_commands", "commands not sent"},
      {"duration_s", "duration"},
      {"bad_states", "states of the robot that were not understood"},
      {"real_time_priority", "real-time priority given"},
      {"locked_memory", "memory kept in place"},
      {"only_timing", "only timed, the robot not moved"},
      // align
      {"offset_standard_deviation_s", "its standard deviation"},
      {"rate_standard_deviation", "standard deviation of the rate"},
      // collar
      {"tag_px", "side of a tag"},
      {"tip_rms_m", "tip error, RMS"},
      {"tip_worst_roll_m", "at the worst roll"},
      {"direction_deg", "direction error, RMS"},
      {"least_tip_m", "least possible, tip"},
      {"least_direction_deg", "least possible, direction"},
      {"tag_with_rim_m", "tag with its white rim"},
      {"across_faces_m", "mount across its faces"},
      {"outer_diameter_m", "over the corners, with paper"},
      {"readable_to_m", "read up to"},
      {"fills_view_at_m", "fills the view at"},
      {"cell_m", "smallest part"},
      {"collar noise_grey", "noise of a pixel"},
      // map
      {"without_measures", "points without measures"},
      {"largest_norm_G", "largest ||G||"},
      // all
      {"streams_not_used", "streams that were not used"}};
  return labels;
}

/// Returns the place of a key in the table, its length where the key is not there.
std::size_t PlaceOf(const std::string& key, const std::string& command) {
  const auto& labels = Labels();
  for (const std::string& wanted : {fmt::format("{} {}", command, key), key}) {
    const auto found = std::find_if(labels.begin(), labels.end(),
                                    [&](const Labelled& l) { return l.first == wanted; });
    if (found != labels.end()) return static_cast<std::size_t>(found - labels.begin());
  }
  return labels.size();
}

bool IsShare(const std::string& key) { return key.ends_with("share_inside_95"); }

}  // namespace

std::string Label(const std::string& key, const std::string& command) {
  const std::size_t place = PlaceOf(key, command);
  if (place < Labels().size()) return Labels()[place].second;
  std::string name = key;
  if (const UnitSuffix* unit = SuffixOf(key, kUnits)) {
    name.resize(name.size() - unit->ending.size());
  }
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

bool IsBefore(const std::string& a, const std::string& b, const std::string& command) {
  return PlaceOf(a, command) < PlaceOf(b, command);
}

SpokenUnit UnitOf(const std::string& key) {
  if (key == "seconds") return {"s", 1.0};
  if (IsShare(key)) return {"%", 100.0};
  const UnitSuffix* unit = SuffixOf(key, kUnits);
  if (unit == nullptr) return {};
  return {std::string(unit->shown), unit->factor};
}

std::string SpokenValue(const std::string& key, double value) {
  if (key == "seconds") return fmt::format("{:.3g} s", value);
  if (IsShare(key)) return fmt::format("{:.1f} %", 100.0 * value);
  const UnitSuffix* unit = SuffixOf(key, kUnits);
  if (unit == nullptr) {
    const bool whole = value == std::floor(value) && std::abs(value) < 1e9;
    return whole ? fmt::format("{:.0f}", value) : fmt::format("{:.4g}", value);
  }
  const double shown = value * unit->factor;
  return std::abs(shown) < 1000 ? fmt::format("{:.3g} {}", shown, unit->shown)
                                : fmt::format("{:.1f} {}", shown, unit->shown);
}

}  // namespace flextip::report
