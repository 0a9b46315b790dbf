#include "diagnosis/search/motion_library.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "diagnosis/planning/imagined_samples.h"

namespace flextip::diagnosis {
namespace {

constexpr double kSeconds = 20.0;
constexpr int kPlaces = 200;  // of a path
// What may hang from an instrument, however stiff it is; a slender one carries a part of EI / L^2.
constexpr double kSmallMost_N = 2.0, kLargeMost_N = 6.0;
constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// Where the straight shaft would point: inserted part of its length, and two angles about the
/// recorded mean direction.
struct Aim {
  double inserted = 0.5, yaw_rad = 0.0, pitch_rad = 0.0;
};
struct Path {
  std::string text;
  std::function<Aim(double)> at;  ///< of t / kSeconds
};

double Wave(double turns, double u) { return std::sin(kTwoPi * turns * u); }

std::vector<Path> Paths() {
  return {
      {"push the instrument slowly in from 35 % to 75 % of its length and back, straight",
       [](double u) {
         return Aim{0.55 - 0.2 * std::cos(kTwoPi * u), 0, 0};
       }},
      {"push in and out between 40 % and 70 % of its length, a stroke every 2 s",
       [](double u) {
         return Aim{0.55 + 0.15 * Wave(10, u), 0, 0};
       }},
      {"sweep 25 degrees to either side, in and out of the plane in turn, at half insertion",
       [](double u) {
         return Aim{0.5, u < 0.5 ? 0.43 * Wave(4, u) : 0.0, u < 0.5 ? 0.0 : 0.43 * Wave(4, u)};
       }},
      {"circle the tip at 20 degrees about the port, at half insertion",
       [](double u) {
         return Aim{0.5, 0.35 * Wave(5, u), 0.35 * std::cos(kTwoPi * 5 * u)};
       }},
      {"circle at 20 degrees while going in from 35 % to 75 %",
       [](double u) {
         return Aim{0.35 + 0.4 * u, 0.35 * Wave(6, u), 0.35 * std::cos(kTwoPi * 6 * u)};
       }},
      {"jog the tip quickly to and fro (1 Hz) in all three directions about half insertion",
       [](double u) {
         return Aim{0.5 + 0.06 * Wave(20, u), 0.12 * Wave(17, u), 0.12 * Wave(23, u)};
       }},
      {"hold still at five places, two near, two far and one half way in",
       [](double u) {
         const int place = std::min(4, int(5 * u));
         return Aim{0.4 + 0.07 * place, place % 2 ? 0.3 : -0.3, place < 2 ? 0.2 : -0.2};
       }},
  };
}

struct Condition {
  std::string text;
  double load_N = 0.0;  ///< force hung from the tip
  bool roll = false;
};

/// Where the straight shaft is, `along` of its length from the wrist.
Eigen::Vector3d PlaceOf(const Aim& aim, double along, const SampleSet& recorded,
                        const Eigen::Matrix3d& R_mean) {
  const Eigen::Vector3d d =
      R_mean * Eigen::Vector3d(std::cos(aim.yaw_rad) * std::cos(aim.pitch_rad),
                               std::sin(aim.yaw_rad) * std::cos(aim.pitch_rad),
                               std::sin(aim.pitch_rad));
  return recorded.p_RP + (along - 1.0 + aim.inserted) * recorded.instrument.length_m * d;
}

}  // namespace

std::vector<LibraryMotion> MotionLibrary(const SampleSet& recorded) {
  const Eigen::Matrix3d R_mean = MeanShaftFrame(recorded);
  const double unit_N =
      recorded.instrument.bending_stiffness_Nm2 / std::pow(recorded.instrument.length_m, 2);
  const double small_N = std::min(kSmallMost_N, 0.4 * unit_N);
  const double large_N = std::min(kLargeMost_N, 1.2 * unit_N);
  const std::vector<Condition> conditions = {
      {"with nothing at the tip", 0.0, false},
      {fmt::format("with {:.2g} N hung from the tip", small_N), small_N, false},
      {fmt::format("with {:.2g} N hung from the tip", large_N), large_N, false},
      {fmt::format(
           "with {:.2g} N hung from the tip and a full turn of the instrument about its axis",
           small_N),
       small_N, true}};
  std::vector<LibraryMotion> motions;
  for (const Path& path : Paths()) {
    for (const Condition& condition : conditions) {
      const ImaginedMotion motion{
          .seconds = kSeconds, .load_N = condition.load_N, .at = [&](double t_s) {
            const double u = t_s / kSeconds;
            return ImaginedInstant{PlaceOf(path.at(u), 0.0, recorded, R_mean),
                                   condition.roll ? kTwoPi * u : 0.0};
          }};
      motions.push_back({path.text + ", " + condition.text,
                         ImagineSamples(recorded, motion),
                         {},
                         condition.load_N});
      for (int i = 0; i <= kPlaces; ++i)
        motions.back().places_m.push_back(
            PlaceOf(path.at(double(i) / kPlaces), 1.0, recorded, R_mean));
    }
  }
  return motions;
}

}  // namespace flextip::diagnosis
