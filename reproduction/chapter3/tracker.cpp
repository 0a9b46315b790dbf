#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "control/motion_error.h"
#include "reproduction/chapter3/noise.h"
#include "reproduction/chapter3/parts.h"

namespace flextip::reproduction {
namespace {

constexpr SensorNoiseLevel kMinibird{0.00013, 0.00056};  // rms, 3.5
constexpr FlexionForm kForm = FlexionForm::kPortForce;   // the three differ by less than 1 % here

SensorNoiseLevel Times(double scale) {
  return {scale * kMinibird.position_m, scale * kMinibird.angle_rad};
}

/// One way to read "for this magnitude of noise".
struct Reading {
  const char* name;
  double scale;  ///< on the stated noise
  bool worst;    ///< else the median under Gaussian noise
  const char* note;
};
const Reading kReadings[] = {
    {"worst within the stated noise", 1.0, true,
     "As Figs. 3.6 to 3.9 are made. About 30 times the thesis's."},
    {"median, stated noise per axis", 1.0, false,
     "The stated figures are rms, so this is the reading nearest their wording. Ten times the "
     "thesis's 0.006."},
    {"median, stated noise over three axes together", 1.0 / 1.7320508, false,
     "If the rms was that of the position's distance and not of an axis."},
    {"median, a tenth of the stated noise", 0.1, false,
     "Reaches 0.006, but then the depth from which it is better than straight is not 0.05 L."},
    {"worst within a thirtieth of the stated noise", 1.0 / 30.0, true,
     "Reaches 0.006 as well; the same."}};

double Metric(const Reading& reading, const BeamState& truth, int draws, std::uint64_t seed) {
  const SensorNoiseLevel noise = Times(reading.scale);
  if (reading.worst) return WorstOverNoise(kForm, truth, noise).worst.metric;
  return MetricUnderGaussianNoise(kForm, truth, noise, draws, seed).median;
}

/// The least insertion depth, over L, from which the flexion Jacobian stays below the straight one
/// (up to 0.9 L), by halving.
double BetterFrom(const BentShaft& shaft, FlexionForm form,
                  const std::function<double(const BeamState&)>& metric) {
  double low = 0.0, high = 0.9;
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (low + high);
    const BeamState truth = BeamAtDepth(shaft, middle * shaft.length_m);
    const double straight = FindStepError(FlexionJacobian(form, truth), LeverJacobian(truth)).norm;
    (metric(truth) < straight ? high : low) = middle;
  }
  return high;
}

/// The insertion depth, over L, at which the straight Jacobian's metric reaches `wanted`.
double StraightReaches(const BentShaft& shaft, FlexionForm form, double wanted) {
  double low = 0.0, high = 0.9;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    const BeamState truth = BeamAtDepth(shaft, middle * shaft.length_m);
    const double straight = FindStepError(FlexionJacobian(form, truth), LeverJacobian(truth)).norm;
    (straight < wanted ? low : high) = middle;
  }
  return low;
}

/// How far the noise would have to be scaled for the worst metric at `depth` to be `wanted`.
double ScaleFor(const BeamState& truth, double wanted) {
  double low = 1e-6, high = 1.0;
  for (int i = 0; i < 30; ++i) {
    const double middle = std::sqrt(low * high);
    const double metric = WorstOverNoise(kForm, truth, Times(middle)).worst.metric;
    (metric < wanted ? low : high) = middle;
  }
  return low;
}

void AddReadings(const BentShaft& shaft, const ReproduceOptions& options,
                 std::vector<TableRow>& rows) {
  const BeamState half = BeamAtDepth(shaft, 0.5 * shaft.length_m);
  const int draws = options.quick ? 1000 : 10000;
  for (const Reading& reading : kReadings) {
    const auto metric = [&](const BeamState& truth) {
      return Metric(reading, truth, draws, options.seed);
    };
    rows.push_back({.quantity = fmt::format("3.5 metric at half insertion, {}", reading.name),
                    .thesis = 0.006,
                    .flextip = metric(half),
                    .note = reading.note});
    rows.push_back(
        {.quantity = fmt::format("3.5 better than straight beyond r / L, {}", reading.name),
         .thesis = 0.05,
         .flextip = BetterFrom(shaft, kForm, metric),
         .note = "Straight against the corrected Jacobian, F_p held."});
  }
}

void AddLimits(const BentShaft& shaft, std::vector<TableRow>& rows) {
  const double L = shaft.length_m;
  for (const FlexionForm form : {FlexionForm::kPrinted, FlexionForm::kTipForce}) {
    const auto worst = [&](const BeamState& truth) {
      return WorstOverNoise(form, truth, kMinibird).worst.metric;
    };
    rows.push_back(
        {.quantity = fmt::format("3.5 better than straight beyond r / L, worst within the "
                                 "stated noise, {}",
                                 Name(form)),
         .thesis = 0.05,
         .flextip = BetterFrom(shaft, form, worst)});
  }
  rows.push_back({.quantity = "3.5 r / L at which the straight metric, as printed, is 0.006",
                  .thesis = 0.05,
                  .flextip = StraightReaches(shaft, FlexionForm::kPrinted, 0.006),
                  .note =
                      "So 0.05 L is where the straight curve passes the flexion Jacobian's value "
                      "at half insertion, as if that held at every depth. It does not: under "
                      "noise the flexion metric grows without bound toward the port."});
  const BeamState shallow = BeamAtDepth(shaft, 0.05 * L);
  const double straight =
      FindStepError(FlexionJacobian(kForm, shallow), LeverJacobian(shallow)).norm;
  rows.push_back({.quantity = "3.5 straight Jacobian's metric at r = 0.05 L",
                  .thesis = {},
                  .flextip = straight,
                  .note = "As printed half of it, 0.0063."});
  rows.push_back(
      {.quantity = "3.5 part of the stated noise for which 0.05 L would hold, worst",
       .thesis = 1.0,
       .flextip = ScaleFor(shallow, straight),
       .note = "There the whole shaft bends by 9 mrad; the angles' noise is 0.56 mrad."});
  rows.push_back({.quantity = "3.5 part of the stated noise for which 0.006 would hold, worst",
                  .thesis = 1.0,
                  .flextip = ScaleFor(BeamAtDepth(shaft, 0.5 * L), 0.006),
                  .note = "The text's two numbers ask for different noises: they do not belong "
                          "together."});
}

/// The box of the noise stands along the axes of the sensors, the chord need not.
void AddTurned(const BentShaft& shaft, std::vector<TableRow>& rows) {
  BeamState truth = BeamAtDepth(shaft, 0.5 * shaft.length_m);
  truth.phi = 0.785398;
  rows.push_back(
      {.quantity = "3.5 metric at half insertion, worst, chord at 45 deg to the sensors' axes",
       .thesis = 0.006,
       .flextip = WorstOverNoise(kForm, truth, kMinibird).worst.metric,
       .note = "The thesis takes the port for a centre of symmetry; its noise is not."});
  const BentShaft more{shaft.length_m, 2.0 * shaft.F_t_over_EI};
  const BeamState bent = BeamAtDepth(more, 0.5 * shaft.length_m);
  rows.push_back(
      {.quantity = "3.5 metric at half insertion, worst, twice the tip force",
       .thesis = {},
       .flextip = WorstOverNoise(kForm, bent, kMinibird).worst.metric,
       .note = fmt::format("More flexion makes it better, and the straight one worse ({:.3f}), "
                           "as the text says.",
                           FindStepError(FlexionJacobian(kForm, bent), LeverJacobian(bent)).norm)});
}

}  // namespace

ChapterResult Ch3Tracker(const ReproduceOptions& options, const ChapterProgress& progress) {
  const BentShaft shaft;
  ChapterResult result;
  AddReadings(shaft, options, result.rows);
  progress(0.8);
  AddLimits(shaft, result.rows);
  AddTurned(shaft, result.rows);
  progress(1.0);
  return result;
}

}  // namespace flextip::reproduction
