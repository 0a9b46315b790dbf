// Frames of two cameras by their times.
#include "recording/frames/frame_sets.h"

#include <gtest/gtest.h>

#include <string>

namespace flextip {
namespace {

std::string Spoken(const std::vector<FramePair>& pairs) {
  std::string text;
  for (const FramePair& p : pairs) {
    text += std::to_string(p.t_ns) + (p.first ? (p.second ? "+ " : "l ") : "r ");
  }
  return text;
}

TEST(PairFrames, JoinsTheNearestWithinHalfAPeriod) {
  EXPECT_EQ(Spoken(PairFrames({0, 40, 80}, {1, 41, 81}, 20)), "0+ 40+ 80+ ");
  EXPECT_EQ(Spoken(PairFrames({0, 40, 80}, {0, 80, 120}, 20)), "0+ 40l 80+ 120r ");
  EXPECT_EQ(Spoken(PairFrames({0, 40}, {21, 61}, 20)), "0l 40+ 61r ");
  EXPECT_EQ(Spoken(PairFrames({0, 10}, {9}, 20)), "0l 10+ ");  // the nearer one
  EXPECT_EQ(Spoken(PairFrames({5, 100}, {0, 6}, 20)), "0r 5+ 100l ");
  EXPECT_EQ(Spoken(PairFrames({}, {3}, 20)), "3r ");
}

/// Pictures of one pixel that hold their number; some of them cannot be had.
class Numbers : public FrameSource {
 public:
  Numbers(std::vector<TimeNs> times, std::size_t readable)
      : times_(std::move(times)), readable_(readable) {}
  std::size_t Count() const override { return times_.size(); }
  void Skip(std::size_t frames) override { next_ += frames; }
  std::optional<Frame> Next() override {
    if (next_ >= readable_) return {};
    Frame frame{times_[next_], Image(1, 1, 1)};
    frame.image.data[0] = static_cast<std::uint8_t>(next_++);
    return frame;
  }

 private:
  std::vector<TimeNs> times_;
  std::size_t readable_, next_ = 0;
};

TEST(FrameSets, SkipsInBothAndGoesOnWithOneWhereTheOtherEnds) {
  const std::vector<TimeNs> left{0, 40, 80, 120}, right{0, 80, 120, 160};
  FrameSets sets(std::make_unique<Numbers>(left, 3), std::make_unique<Numbers>(right, 4),
                 PairFrames(left, right, 20));
  EXPECT_EQ(sets.Count(), 5U);
  sets.Skip(2);  // 0 of both, 40 of the left
  const auto third = sets.Next();
  ASSERT_TRUE(third && third->images[0] && third->images[1]);
  EXPECT_EQ(third->t_ns, 80);
  EXPECT_EQ(third->images[0]->data[0], 2);
  EXPECT_EQ(third->images[1]->data[0], 1);
  const auto fourth = sets.Next();  // the left ended early
  ASSERT_TRUE(fourth && !fourth->images[0] && fourth->images[1]);
  EXPECT_EQ(fourth->images[1]->data[0], 2);
  EXPECT_EQ(sets.Next()->t_ns, 160);
  EXPECT_FALSE(sets.Next());
}

}  // namespace
}  // namespace flextip
