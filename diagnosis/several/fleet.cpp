#include "diagnosis/several/fleet.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "core/check.h"
#include "core/error.h"
#include "diagnosis/model/catalogue.h"
#include "diagnosis/search/parameter_scan.h"

namespace flextip::diagnosis {
namespace {

[[noreturn]] void RefuseTogether(const NamedRecording& a, const NamedRecording& b,
                                 const std::string& what, const std::string& of_a,
                                 const std::string& of_b) {
  throw InputError(fmt::format(
      "{} and {}: {} is {} in the one and {} in the other, expected recordings of one instrument",
      a.name, b.name, what, of_a, of_b));
}

std::string Text(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
}

std::string Text(const std::map<std::string, std::vector<double>>& tolerances) {
  std::vector<std::string> all;
  all.reserve(tolerances.size());
  for (const auto& [name, values] : tolerances)
    all.push_back(fmt::format("{}: [{}]", name, fmt::join(values, ", ")));
  return fmt::format("{{{}}}", fmt::join(all, ", "));
}

const Eigen::Vector3d& ValueOf(const WristSample& sample) { return sample.p_RW; }
const Eigen::Vector3d& ValueOf(const EmSample& sample) { return sample.p_RS; }
const Eigen::Vector3d& ValueOf(const TipObservation& tip) { return tip.p_RE; }
const Eigen::Vector3d& ValueOf(const Eigen::Vector3d& force) { return force; }
const Eigen::Vector4d& ValueOf(const Eigen::Vector4d& moments) { return moments; }

void RequireAlike(const NamedRecording& a, const NamedRecording& b) {
  const auto number = [&](const char* what, double of_a, double of_b) {
    if (of_a != of_b) RefuseTogether(a, b, what, fmt::format("{}", of_a), fmt::format("{}", of_b));
  };
  const Instrument &x = a.recording.instrument, &y = b.recording.instrument;
  number("instrument length_m", x.length_m, y.length_m);
  number("instrument outer_diameter_m", x.outer_diameter_m, y.outer_diameter_m);
  number("instrument bending_stiffness_Nm2", x.bending_stiffness_Nm2, y.bending_stiffness_Nm2);
  number("instrument mass_per_length_kg_m", x.mass_per_length_kg_m, y.mass_per_length_kg_m);
  number("instrument stiffness_taper", x.stiffness_taper, y.stiffness_taper);
  const auto vector = [&](const char* what, const Eigen::Vector3d& of_a,
                          const Eigen::Vector3d& of_b) {
    if (of_a != of_b) RefuseTogether(a, b, what, Text(of_a), Text(of_b));
  };
  vector("port position_m", a.recording.p_RP, b.recording.p_RP);
  vector("gravity_m_s2", a.recording.gravity_m_s2, b.recording.gravity_m_s2);
  if (a.recording.tolerances != b.recording.tolerances)
    RefuseTogether(a, b, "tolerances", Text(a.recording.tolerances), Text(b.recording.tolerances));
}

/// What the sensors say of themselves, which a join takes from the first.
void RequireSensorsAlike(const NamedRecording& a, const NamedRecording& b) {
  const auto number = [&](const char* what, double of_a, double of_b) {
    if (of_a != of_b) RefuseTogether(a, b, what, fmt::format("{}", of_a), fmt::format("{}", of_b));
  };
  const Recording &x = a.recording, &y = b.recording;
  if (x.wrist0 && y.wrist0)
    number("wrist0 position_noise_m", x.wrist0->position_noise_m, y.wrist0->position_noise_m);
  if (x.em0 && y.em0) {
    number("em0 distance_from_tip_m", x.em0->distance_from_tip_m, y.em0->distance_from_tip_m);
    number("em0 position_noise_m", x.em0->position_noise_m, y.em0->position_noise_m);
    number("em0 registration_noise_m", x.em0->registration_noise_m, y.em0->registration_noise_m);
  }
  if (x.strain0 && y.strain0) {
    for (const int i : {0, 1})
      number("strain0 stations_from_wrist_m", x.strain0->station_from_wrist_m[i],
             y.strain0->station_from_wrist_m[i]);
    number("strain0 moment_noise_Nm", x.strain0->moment_noise_Nm, y.strain0->moment_noise_Nm);
  }
  if (x.load0 && y.load0)
    number("load0 force_noise_N", x.load0->force_noise_N, y.load0->force_noise_N);
  if (x.cam0 && y.cam0) {
    number("cam0 fu_px", x.cam0->calibration.fu_px, y.cam0->calibration.fu_px);
    const bool same_pose = x.cam0->calibration.T_RC.p == y.cam0->calibration.T_RC.p &&
                           x.cam0->calibration.T_RC.R == y.cam0->calibration.T_RC.R;
    if (!same_pose)
      RefuseTogether(a, b, "cam0 T_RC", Text(x.cam0->calibration.T_RC.p),
                     Text(y.cam0->calibration.T_RC.p));
  }
}

/// One recording twice would count as twice the evidence.
void RequireAnother(const NamedRecording& a, const NamedRecording& b) {
  const Recording &x = a.recording, &y = b.recording;
  const auto same = [](const auto& of_a, const auto& of_b, auto value) {
    if (!of_a || !of_b) return !of_a && !of_b;
    const auto &s = value(*of_a), &t = value(*of_b);
    return std::ranges::equal(s, t, [](const auto& one, const auto& other) {
      return one.t_ns == other.t_ns && ValueOf(one.value) == ValueOf(other.value);
    });
  };
  const auto samples = [](const auto& stream) -> const auto& { return stream.samples; };
  const bool all =
      same(x.wrist0, y.wrist0, samples) && same(x.em0, y.em0, samples) &&
      same(
          x.vision0, y.vision0, [](const auto& v) -> const auto& { return v.tips; }) &&
      same(
          x.strain0, y.strain0, [](const auto& s) -> const auto& { return s.moments_Nm; }) &&
      same(
          x.load0, y.load0, [](const auto& l) -> const auto& { return l.f_tip_N; });
  if (!all) return;
  throw InputError(fmt::format("{} and {} hold the same samples, expected different recordings",
                               a.name, b.name));
}

/// One goes on where the one before ended.
void RequireGoesOn(const NamedRecording& before, const NamedRecording& after) {
  constexpr double kNear_m = 0.005;
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("{} and {}: {}, expected stretches of one session", before.name,
                                 after.name, why));
  };
  for (const NamedRecording* one : {&before, &after})
    if (!one->recording.wrist0 || one->recording.wrist0->samples.size() < 2)
      refuse(one->name + " has no wrist0 to speak of");
  const double apart_m = (after.recording.wrist0->samples.front().value.p_RW -
                          before.recording.wrist0->samples.back().value.p_RW)
                             .norm();
  if (apart_m > kNear_m)
    refuse(fmt::format("the wrist begins {:.3g} m from where it had ended", apart_m));
}

Catalogue CatalogueOf(const std::vector<std::string>& effects, const EffectMakers& own) {
  Catalogue catalogue;
  for (const std::string& name : effects) catalogue.push_back(MakeEffect(name, own));
  return catalogue;
}

/// The effects that one of the recordings could show, in the catalogue's order.
std::vector<std::string> EffectsOf(const std::vector<SampleSet>& all,
                                   const DiagnoseOptions& options) {
  std::set<std::string> shown;
  for (const SampleSet& samples : all)
    for (const auto& effect : MakeCatalogue(samples, options.without, options.own_effects))
      shown.insert(effect->Name());
  std::vector<std::string> ordered;
  for (const std::string& name : EffectNames(options.own_effects))
    if (shown.contains(name)) ordered.push_back(name);
  return ordered;
}

/// The field about whose middle an EM gradient is stated is the room's, not a recording's.
void ShareCentre(std::vector<SampleSet>& all) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  const bool any_em =
      std::ranges::any_of(all, [](const SampleSet& samples) { return samples.has_em; });
  for (const SampleSet& samples : all) {
    if (samples.has_em != any_em) continue;
    sum += samples.centre;
    ++count;
  }
  for (SampleSet& samples : all) samples.centre = sum / count;
}

}  // namespace

void RequireOneSession(const std::vector<NamedRecording>& recordings) {
  for (std::size_t i = 1; i < recordings.size(); ++i) {
    RequireAlike(recordings.front(), recordings[i]);
    RequireSensorsAlike(recordings.front(), recordings[i]);
    RequireGoesOn(recordings[i - 1], recordings[i]);
  }
}

Member::Member(std::string its_name, SampleSet its_samples, const std::vector<std::string>& effects,
               const EffectMakers& own)
    : name(std::move(its_name)),
      samples(std::move(its_samples)),
      layout(samples, CatalogueOf(effects, own)) {
  settings.noise_scale.fill(1.0);
}

Fleet::Fleet(const std::vector<NamedRecording>& recordings, const DiagnoseOptions& options) {
  FLEXTIP_CHECK(!recordings.empty(), "several recordings are at least one");
  std::vector<SampleSet> all;
  for (const NamedRecording& one : recordings) {
    RequireAlike(recordings.front(), one);
    for (const NamedRecording* other = recordings.data(); other != &one; ++other)
      RequireAnother(*other, one);
    all.push_back(MakeSampleSet(one.recording, one.name));
  }
  ShareCentre(all);
  const std::vector<std::string> effects = EffectsOf(all, options);
  for (std::size_t r = 0; r < all.size(); ++r)
    members_.push_back(std::make_unique<Member>(recordings[r].name, std::move(all[r]), effects,
                                                options.own_effects));
  for (int e = 0; e < EffectCount(); ++e) {
    const auto& block = Layout().Blocks()[e];
    const std::vector<int> own = block.effect->OwnParameters();
    shared_of_.emplace_back();
    own_of_.emplace_back();
    for (int j = 0; j < block.size; ++j) {
      if (std::ranges::find(own, j) != own.end()) {
        own_of_[e].push_back(block.first + j);
      } else {
        shared_of_[e].push_back(int(shared_.size()));
        shared_.push_back(block.first + j);
      }
    }
  }
}

Place PlaceNow(const Member& member) {
  Place place = member.place;
  place.theta = member.theta;
  return place;
}

std::unique_ptr<Replay> ReplayOf(Member& member, const Place& place) {
  auto replay = std::make_unique<Replay>(member.samples, member.layout);
  replay->Use(member.settings);
  SetScanCentres(member.layout, place.scan_centres);
  if (!place.forces_N.empty()) replay->SetForces(place.forces_N);
  if (!replay->Evaluate(place.theta)) return nullptr;
  return replay;
}

}  // namespace flextip::diagnosis
