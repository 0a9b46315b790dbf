#include "bench/diagnosis_matrix/case.h"

#include <fmt/format.h>

#include <algorithm>

namespace flextip::bench {
namespace {

using Names = std::vector<std::string>;

bool Has(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// FNV-1a, folded to 31 bits: short enough to type.
std::uint64_t Hash(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return (hash ^ (hash >> 31)) & 0x7fffffffULL;
}

const Names& Sensors() {
  static const Names sensors{"em0", "strain0", "vision0", "wrist0_orientation"};
  return sensors;
}

class Planner {
 public:
  explicit Planner(const MatrixPlan& plan) : plan_(plan) {
    effects_ = plan.effects.empty() ? simulation::CatalogueEffects() : plan.effects;
  }

  std::vector<MatrixCase> Plan() {
    for (const std::string& load : plan_.loads) {
      one_.load = load == "known";
      one_.family = plan_.family;
      one_.duration_s = plan_.duration_s;
      one_.noise_correlation = plan_.noise_correlation;
      PlanSizeless();
      for (const std::string& size : plan_.sizes) PlanSize(size);
    }
    return cases_;
  }

 private:
  bool Wanted(const char* part) const { return Has(plan_.parts, part); }

  void Add(MatrixCase one, const std::string& part, int count) {
    one.part = part;
    for (one.index = 0; one.index < count; ++one.index) {
      MatrixCase same_recording = one;
      same_recording.without.clear();
      one.seed = Hash(fmt::format("{} {}", plan_.first_seed, same_recording.Key()));
      cases_.push_back(one);
    }
  }

  void PlanSizeless() {
    MatrixCase one = one_;
    if (Wanted("healthy")) Add(one, "healthy", plan_.healthy);
    for (const std::string& form : hidden::OtherForms()) {
      one.effects = {form};
      if (Wanted("unknown")) Add(one, "unknown", plan_.seeds_per_cell);
    }
  }

  void PlanSize(const std::string& size) {
    MatrixCase one = one_;
    one.size = size;
    one.drawn = 2;
    if (Wanted("pairs")) Add(one, "pairs", plan_.pairs);
    one.drawn = 3;
    if (Wanted("triples")) Add(one, "triples", plan_.triples);
    one.drawn = 0;
    for (const std::string& effect : effects_) {
      if (hidden::SensorOf(effect) == "load0" && !one.load) continue;
      one.effects = {effect};
      if (Wanted("singles")) Add(one, "singles", plan_.seeds_per_cell);
      for (const std::string& sensor : Sensors()) {
        MatrixCase blind = one;
        blind.left_out = sensor;
        const bool shows = hidden::SensorOf(effect) != sensor;
        if (Wanted("leave_sensor") && shows) Add(blind, "leave_sensor", plan_.seeds_per_cell);
      }
      MatrixCase ignorant = one;
      ignorant.without = effect;
      if (Wanted("leave_effect")) Add(ignorant, "leave_effect", plan_.seeds_per_cell);
    }
  }

  const MatrixPlan& plan_;
  Names effects_;
  MatrixCase one_;
  std::vector<MatrixCase> cases_;
};

hidden::EffectSize SizeOf(const std::string& name) {
  if (name == "subtle") return hidden::EffectSize::kSubtle;
  return name == "strong" ? hidden::EffectSize::kStrong : hidden::EffectSize::kPlain;
}

hidden::MotionFamily FamilyOf(const std::string& name) {
  if (name == "tuning") return hidden::MotionFamily::kTuning;
  return name == "held_out" ? hidden::MotionFamily::kHeldOut : hidden::MotionFamily::kAny;
}

}  // namespace

std::string MatrixCase::Key() const {
  const std::string what =
      drawn > 0 ? fmt::format("draw{}", drawn) : fmt::format("{}", fmt::join(effects, "+"));
  const std::string noise =
      noise_correlation == 0.0 ? "" : fmt::format("noise_{}/", noise_correlation);
  return fmt::format("{}/{}/{}/load_{}/left_out_{}/without_{}/{}/{}s/{}{}/seed_{}", part,
                     what.empty() ? "none" : what, size, load ? "known" : "unknown",
                     left_out.empty() ? "nothing" : left_out, without.empty() ? "nothing" : without,
                     family, duration_s, noise, index, seed);
}

const std::vector<std::string>& MatrixParts() {
  static const Names parts{"singles", "healthy",      "pairs",       "triples",
                           "unknown", "leave_sensor", "leave_effect"};
  return parts;
}

std::vector<MatrixCase> PlanMatrix(const MatrixPlan& plan) { return Planner(plan).Plan(); }

hidden::HiddenOptions HiddenOptionsOf(const MatrixCase& one) {
  hidden::HiddenOptions options;
  options.effects = one.effects;
  options.drawn_effects = one.drawn;
  options.size = SizeOf(one.size);
  options.with_load = one.load;
  if (!one.left_out.empty()) options.left_out = {one.left_out};
  options.scene.family = FamilyOf(one.family);
  options.scene.duration_s = one.duration_s;
  options.noise_correlation = one.noise_correlation;
  return options;
}

std::string MakeHiddenCall(const MatrixCase& one) {
  std::string call = fmt::format("flextip_make_hidden --seed {}", one.seed);
  if (one.drawn > 0) call += fmt::format(" --effects draw{}", one.drawn);
  if (!one.effects.empty()) call += fmt::format(" --effects {}", fmt::join(one.effects, ","));
  if (one.size != "any") call += " --size " + one.size;
  if (!one.load) call += " --no-load";
  if (!one.left_out.empty()) call += " --leave-out " + one.left_out;
  call += " --family " + one.family;
  if (one.noise_correlation != 0.0)
    call += fmt::format(" --noise-correlation {}", one.noise_correlation);
  if (one.duration_s != 20.0) call += fmt::format(" --duration {}", one.duration_s);
  return call;
}

}  // namespace flextip::bench
