// The model with the label's parameters: what it names and what not.
#include "bench/matrix_true_model.h"

#include <gtest/gtest.h>

namespace flextip {
namespace {

HiddenRecording Hidden(const std::string& effect, EffectSize size, bool with_load = true) {
  HiddenOptions options;
  options.effects = {effect};
  options.size = size;
  options.exact = true;
  options.with_load = with_load;
  options.scene.load = LoadKind::kVarying;
  options.scene.duration_s = 8.0;
  options.links_per_side = 30;
  return MakeHidden(options, 31);
}

TEST(TrueModel, KnowsWhatTheLabelNamesAndWhatNot) {
  const HiddenRecording hidden = Hidden("port_motion", EffectSize::kPlain, false);
  const TrueModel truth(hidden.recording, hidden);
  const auto unnamed_of = [&](const std::string& effect) {
    const auto& block = truth.layout.Blocks()[truth.layout.Find(effect)];
    int count = 0;
    for (const int j : truth.parameters.unnamed)
      count += j >= block.first && j < block.first + block.size ? 1 : 0;
    return count;
  };
  EXPECT_EQ(unnamed_of("port_motion"), 6);    // overtones
  EXPECT_EQ(unnamed_of("em_distortion"), 3);  // where it is zero
  EXPECT_EQ(unnamed_of("backlash"), 3);       // where in the play it began
  EXPECT_EQ(unnamed_of("port_moment"), 0);
  EXPECT_EQ(unnamed_of("stiffness"), 0);
  int nuisance = 0;
  for (const auto& block : truth.layout.Blocks()) nuisance += block.nuisance ? block.size : 0;
  EXPECT_EQ(int(truth.parameters.unnamed.size()), 6 + 3 + 3 + nuisance);
  EXPECT_GT(nuisance, 0);
  ASSERT_EQ(truth.present.size(), 1u);
  EXPECT_EQ(truth.layout.Blocks()[truth.present[0]].effect->Name(), "port_motion");
}

}  // namespace
}  // namespace flextip
