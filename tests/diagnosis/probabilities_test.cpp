// How the whole recording and its parts are brought together.
#include "diagnosis/evidence/probabilities.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

using Shares = std::map<Verdict, double>;
const Verdict kNone{"none"}, kUnknown{"unknown"}, kLength{"length"};

void ExpectNear(const Shares& found, const Shares& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [verdict, p] : expected) EXPECT_NEAR(found.at(verdict), p, 1e-12) << verdict[0];
}

TEST(Agreed, IsTheMeanWhereBothSayUnknownOrNeither) {
  ExpectNear(Agreed({{kNone, 0.0}, {kUnknown, 1.0}}, {{kNone, 0.8}, {kUnknown, 0.2}}),
             {{kNone, 0.4}, {kUnknown, 0.6}});
  ExpectNear(
      Agreed({{kNone, 0.9}, {kLength, 0.1}, {kUnknown, 0.0}}, {{kNone, 0.5}, {kLength, 0.5}}),
      {{kNone, 0.7}, {kLength, 0.3}, {kUnknown, 0.0}});
}

TEST(Agreed, UnknownThatNoPartShowsIsWhatThePartsSay) {
  ExpectNear(Agreed({{kNone, 0.0}, {kLength, 0.0}, {kUnknown, 1.0}},
                    {{kNone, 0.72}, {kLength, 0.24}, {kUnknown, 0.04}}),
             {{kNone, 0.72}, {kLength, 0.24}, {kUnknown, 0.04}});
}

TEST(Agreed, UnknownStaysWhereNothingElseIsPossible) {
  ExpectNear(Agreed({{kNone, 0.0}, {kUnknown, 1.0}}, {{kUnknown, 1.0}}),
             {{kNone, 0.0}, {kUnknown, 1.0}});
}

TEST(MakeProbabilities, WhereNothingKnownIsAdequateTheAnswerIsUnknown) {
  const SampleSet samples = SmallSamples(10.0, true, 61, {"tag_offset"});
  ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  Selection selection = Select(replay, layout);
  EXPECT_LT(selection.chi2_per_dof, 1.2);  // the noise counts as its data sheet at least
  const Probabilities right = MakeProbabilities(selection, layout, {});
  EXPECT_EQ(right.hypotheses.front().verdict, Verdict{"tag_offset"});
  selection.chi2_per_dof = 2.5;
  const Probabilities inadequate = MakeProbabilities(selection, layout, {});
  EXPECT_EQ(inadequate.hypotheses.front().verdict, kUnknown);
  EXPECT_NEAR(inadequate.hypotheses.front().probability, 0.95, 1e-12);
  double sum = 0.0;
  for (const auto& h : inadequate.hypotheses) sum += h.probability;
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

/// Something small in the whole recording may put all that is unknown before all that is known. The
/// parts, where it does not show, then weigh the known causes all the same.
TEST(MakeProbabilities, WhereUnknownsLeadTheKnownCauseIsNotLost) {
  const SampleSet samples = SmallSamples(10.0, true, 61, {"tag_offset"});
  ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  Selection selection = Select(replay, layout);
  for (ScoredHypothesis& s : selection.scored)
    if (s.weighed.hypothesis.unknown) s.log_posterior += 1e6;
  std::ranges::stable_sort(selection.scored, std::ranges::greater(),
                           &ScoredHypothesis::log_posterior);
  ASSERT_TRUE(selection.scored[30].weighed.hypothesis.unknown);
  const Probabilities found = MakeProbabilities(selection, layout, {});
  EXPECT_EQ(found.hypotheses.front().verdict, Verdict{"tag_offset"});
}

}  // namespace
}  // namespace flextip::diagnosis
