// The source that is written for a term, compiled here, moves the inputs as the term does.
#include "diagnosis/effects/discovered/term_source.h"

#include <gmock/gmock.h>

#include "diagnosis/effects/discovered/discovered_term.h"
#include "diagnosis/model/geometry.h"
#include "tests/diagnosis/small_recording.h"
#include "tests/discovery/source_terms.h"

using EffectPointer = std::unique_ptr<flextip::diagnosis::Effect>;
EffectPointer MakeGageHum();
EffectPointer MakeGageLimit();
EffectPointer MakeWristPlay();
EffectPointer MakeGageGlue();
EffectPointer MakeLoadCreep();
EffectPointer MakeEmMetal();
EffectPointer MakePortJump();
EffectPointer MakeSoftDepth();
EffectPointer MakeSeenSlope();
EffectPointer MakeSeenBowl();
EffectPointer MakeSeenLens();
EffectPointer MakeEmLate();
EffectPointer MakeFrameJump();
EffectPointer MakeLoadPlane();
EffectPointer MakeEmConstant();

namespace flextip::diagnosis {
namespace {

SampleInputs Acted(const Effect& effect, const Eigen::VectorXd& theta, const Instant& now,
                   EffectMemory& memory) {
  SampleInputs u = SampleInputs::Zero();
  std::vector<InputChange::Column> columns;
  InputChange change(theta.data(), 0, u, columns);
  effect.Apply(theta.data(), now, memory, change);
  return u;
}

TEST(EffectSource, DoesWhatTheTermDoes) {
  const SampleSet samples = SmallSamples(3.0, true, 8);
  const EffectPointer written[] = {
      MakeGageHum(),  MakeGageLimit(), MakeWristPlay(), MakeGageGlue(),  MakeLoadCreep(),
      MakeEmMetal(),  MakePortJump(),  MakeSoftDepth(), MakeSeenSlope(), MakeSeenBowl(),
      MakeSeenLens(), MakeEmLate(),    MakeFrameJump(), MakeLoadPlane(), MakeEmConstant()};
  const auto terms = SourceTerms();
  ASSERT_EQ(std::size(written), terms.size());
  EffectRodSolver solver;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const auto& [name, term] = terms[i];
    EXPECT_EQ(written[i]->Name(), name);
    const DiscoveredTerm as_term(term, name);
    ASSERT_EQ(written[i]->Parameters(samples).size(), std::size_t(as_term.Theta().size()));
    EffectMemory one{}, other{};
    for (std::size_t k = 0; k < samples.samples.size(); k += 3) {
      const SolvedSample solved =
          SolveSample(samples, k, SampleInputs::Zero(), samples.samples[k].f_tip_N, solver);
      const Instant now{samples, k, samples.samples[k].t_s, 0.0, 0.0, &solved};
      const SampleInputs difference = Acted(*written[i], as_term.Theta(), now, one) -
                                      Acted(as_term, as_term.Theta(), now, other);
      EXPECT_LT(difference.norm(), 1e-12) << name << " " << k;
    }
  }
}

TEST(EffectSource, AStampThatIsLateIsALatency) {
  EXPECT_EQ(MakeEmLate()->DelayInput(), sample_input::kEmDelay);
  EXPECT_EQ(MakeSeenLens()->DelayInput(), -1);
}

TEST(EffectSource, ThreeInputsThatSwingAreScanned) {
  const Term swing = SourceTerm("em_hum", TermTarget::kEmPosition, TermShape::kPeriodic,
                                TermVariable::kTime, {2.5})
                         .second;
  EXPECT_EQ(EffectNameOf(swing), "em0_periodic");
  EXPECT_THAT(EffectSource(swing, "em_hum"),
              testing::HasSubstr("class EmHum : public PeriodicEffect"));
}

}  // namespace
}  // namespace flextip::diagnosis
