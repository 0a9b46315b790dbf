// Forms outside the catalogue: apart from it where they show, not where nothing bends the shaft.
#include "bench/matrix_form.h"

#include <gtest/gtest.h>

namespace flextip {
namespace {

Separation OfTaper(LoadKind load) {
  HiddenOptions options{.effects = {"taper"}};
  options.scene.duration_s = 4.0;
  options.scene.load = load;
  options.scene.motion = MotionKind::kSines;
  return MeasureForm(MakeHidden(options, 5).recording, options, 5);
}

TEST(MatrixForm, ATaperShowsUnderALoadOnly) {
  const Separation loaded = OfTaper(LoadKind::kVarying), unloaded = OfTaper(LoadKind::kNone);
  EXPECT_GT(loaded.value, kSeparable) << loaded.rival;
  EXPECT_LT(unloaded.value, kSeparable);
  EXPECT_EQ(unloaded.rival, "none");
}

TEST(MatrixForm, NothingChangedIsNothingToTell) {
  HiddenOptions options;
  options.scene.duration_s = 4.0;
  const Separation same = MeasureForm(MakeHidden(options, 6).recording, options, 6);
  EXPECT_EQ(same.value, 0.0);
  EXPECT_EQ(same.rival, "none");
}

}  // namespace
}  // namespace flextip
