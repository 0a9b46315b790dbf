// Diagnoses a recording with an effect of one's own beside those of the catalogue: a pump beside
// the table shakes the scope.
//   own_effect RECORDING
#include <fmt/format.h>

#include <flextip/core/error.h>
#include <flextip/diagnosis/diagnose.h>
#include <flextip/diagnosis/effects/periodic.h>
#include <flextip/recording/recording_reader.h>

namespace {

using namespace flextip::diagnosis;

/// The search scans the frequency. Amplitude and phase are fitted, the report says how large they
/// are, and held-out parts of the recording say what the effect gains.
class ScopeShake : public PeriodicEffect {
 public:
  ScopeShake()
      : PeriodicEffect("scope_shake", "a pump shakes the scope",
                       {.first_input = sample_input::kCameraShift,
                        .tolerance = 0.00005,
                        .typical = 0.001,
                        .lowest_hz = 0.8,
                        .highest_hz = 4.0,
                        .start_hz = 1.0}) {}
  bool Applies(const SampleSet& samples) const override {
    return samples.has_tip && samples.resolved_in_time && samples.Duration() > 4.0;
  }
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) throw flextip::InputError("usage: own_effect RECORDING");
  const auto read = flextip::ReadRecording(argv[1], {.check_frames = false});
  DiagnoseOptions options;
  options.own_effects.push_back([] { return std::make_unique<ScopeShake>(); });
  const DiagnosisResult result = Diagnose(read.recording, argv[1], options);
  fmt::print("verdict: {}\n", Joined(result.verdict));
  const auto found = result.presence.find("scope_shake");
  fmt::print("scope_shake is present with {:.1f} %\n",
             found == result.presence.end() ? 0.0 : 100 * found->second);
} catch (const flextip::InputError& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 2;
}
