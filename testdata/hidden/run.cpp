#include "testdata/hidden/run.h"

#include <algorithm>
#include <cmath>

namespace flextip::hidden {
namespace {

constexpr double kLeadIn_s = 0.5;  // friction, play and latency have a past

simulation::PlantSetup MakePlantSetup(const HiddenScene& scene,
                                      const simulation::PlantEffects& effects) {
  simulation::PlantSetup setup;
  setup.instrument = scene.instrument;
  setup.p_RP = scene.p_RP;
  setup.weight_N_m = scene.instrument.mass_per_length_kg_m * scene.gravity_m_s2;
  setup.load = scene.load.At(-kLeadIn_s);
  setup.roll_rad = scene.RollAt(-kLeadIn_s);
  setup.gravity_m_s2 = scene.gravity_m_s2;
  setup.effects = effects;
  return setup;
}

}  // namespace

std::optional<Run> RunPlant(const HiddenScene& scene, const simulation::PlantEffects& effects,
                            const std::vector<HiddenForm>& forms, const HiddenOptions& options) {
  simulation::Plant plant(MakePlantSetup(scene, effects),
                          {options.links_per_side, options.links_per_side});
  const WristCourse motion = scene.Motion();
  Run run;
  const int lead_in = static_cast<int>(std::lround(kLeadIn_s * options.tick_rate_hz));
  const int ticks = static_cast<int>(std::lround(scene.duration_s * options.tick_rate_hz));
  if (options.carrier != nullptr) {
    options.carrier->Follow([&](double t_s) { return motion.At(t_s); }, -kLeadIn_s,
                            scene.duration_s);
  }
  for (int tick = -lead_in; tick < ticks; ++tick) {
    const double t = tick / options.tick_rate_hz;
    plant.SetLoad(scene.load.At(t));
    plant.SetRoll(scene.RollAt(t));
    for (const HiddenForm& form : forms) {
      if (!form.IsOfPlant()) continue;
      simulation::PlantEffects changed;
      form.ActOnPlant(t, effects, changed);
      plant.SetEffects(changed);
    }
    run.t_s.push_back(t);
    run.shapes.push_back(
        plant.Solve(options.carrier ? options.carrier->WristAt(t) : motion.At(t), t));
    const simulation::PlantShape& shape = run.shapes.back();
    constexpr double kMostTurn = 0.3;  // cosine of the turn from wrist to tip
    if (!shape.IsUsable()) return {};
    if (shape.Tangent(0.0).dot(shape.Tangent(shape.length_m)) < kMostTurn) return {};
  }
  return run;
}

Eigen::Vector3d EmCentre(const Run& run, const EmStream& em) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < run.shapes.size(); ++i) {
    if (run.t_s[i] < 0) continue;
    sum += run.shapes[i].Position(run.shapes[i].length_m - em.distance_from_tip_m);
    ++count;
  }
  return sum / count;
}

double HighestMoment(const Run& run, const StrainStream& strain) {
  double highest = 0.0;
  for (const simulation::PlantShape& shape : run.shapes) {
    for (const double s : strain.station_from_wrist_m) {
      const Eigen::Vector3d local = shape.Frame(s).R.transpose() * shape.Moment(s);
      highest = std::max(highest, local.tail<2>().cwiseAbs().maxCoeff());
    }
  }
  return highest;
}

}  // namespace flextip::hidden
