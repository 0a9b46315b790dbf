// Diagnoses a recording: which effects the base simulation lacks, how large, how sure.
//   diagnose_folder RECORDING [model.yaml]
#include <cstdio>

#include <flextip/core/error.h>
#include <flextip/diagnosis/diagnose.h>
#include <flextip/diagnosis/model/extended_model.h>
#include <flextip/recording/recording_reader.h>

namespace {

void Print(const flextip::diagnosis::DiagnosisResult& result) {
  for (const auto& hypothesis : result.probabilities) {  // the most likely first
    if (hypothesis.probability < 0.01) break;
    std::printf("%5.1f %%  %s\n", 100 * hypothesis.probability,
                flextip::diagnosis::Joined(hypothesis.verdict).c_str());
  }
  for (const auto& fit : result.parameters) {
    for (const auto& parameter : fit.parameters) {
      std::printf("%s %s:", fit.effect.c_str(), parameter.name.c_str());
      for (std::size_t i = 0; i < parameter.value.size(); ++i) {
        std::printf("  %.4g +- %.2g", parameter.value[i], parameter.sd[i]);
      }
      std::printf("  (SI)\n");
    }
  }
  if (result.gain.measured) {
    std::printf("error on parts that were not fitted: %.2f of the base simulation's\n",
                result.gain.heldout_error_ratio);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: diagnose_folder RECORDING [model.yaml]\n");
    return 2;
  }
  try {
    const auto read = flextip::ReadRecording(argv[1], {.check_frames = false});
    for (const auto& warning : read.warnings) std::printf("beware: %s\n", warning.c_str());
    const auto result = flextip::diagnosis::Diagnose(read.recording, argv[1]);
    Print(result);
    if (argc > 2) WriteModel(argv[2], flextip::diagnosis::FromResult(result));
  } catch (const flextip::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
