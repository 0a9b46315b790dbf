// Forms outside the catalogue: apart from it where they show, not where nothing bends the shaft.
#include "bench/diagnosis_matrix/form.h"

#include <gtest/gtest.h>

namespace flextip::bench {
namespace {

Separation OfTaper(hidden::LoadKind load) {
  hidden::HiddenOptions options{.effects = {"taper"}};
  options.scene.duration_s = 4.0;
  options.scene.load = load;
  options.scene.motion = hidden::MotionKind::kSines;
  const hidden::HiddenRecording hidden = hidden::MakeHidden(options, 5);
  return MeasureForm(hidden.recording, hidden.attempt, options, 5);
}

TEST(MatrixForm, ATaperShowsUnderALoadOnly) {
  const Separation loaded = OfTaper(hidden::LoadKind::kVarying),
                   unloaded = OfTaper(hidden::LoadKind::kNone);
  EXPECT_GT(loaded.value, kSeparable) << loaded.rival;
  EXPECT_LT(unloaded.value, kSeparable);
  EXPECT_EQ(unloaded.rival, "none");
}

TEST(MatrixForm, NothingChangedIsNothingToTell) {
  hidden::HiddenOptions options;
  options.scene.duration_s = 4.0;
  const hidden::HiddenRecording hidden = hidden::MakeHidden(options, 6);
  const Separation same = MeasureForm(hidden.recording, hidden.attempt, options, 6);
  EXPECT_EQ(same.value, 0.0);
  EXPECT_EQ(same.rival, "none");
}

TEST(MatrixForm, AnotherDrawIsNotCompared) {
  hidden::HiddenOptions options{.effects = {"taper"}};
  options.scene.duration_s = 4.0;
  options.scene.load = hidden::LoadKind::kVarying;
  options.scene.motion = hidden::MotionKind::kSines;
  const hidden::HiddenRecording hidden = hidden::MakeHidden(options, 5);
  EXPECT_NE(MeasureForm(hidden.recording, hidden.attempt, options, 5).rival, "");
  EXPECT_EQ(MeasureForm(hidden.recording, hidden.attempt + 1, options, 5).rival, "");
}

}  // namespace
}  // namespace flextip::bench
