// A state comes back bit for bit, or is refused.
#include "core/state_text.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

namespace flextip {
namespace {

struct Thing {
  double a = 0;
  std::int64_t t_ns = 0;
  bool on = false;
  Eigen::Matrix<double, 2, 3> M = Eigen::Matrix<double, 2, 3>::Zero();
  std::optional<Pose> pose, none = Pose{};
  void VisitState(StateText& state) {
    state(a);
    state(t_ns);
    state(on);
    state(M);
    state(pose);
    state(none);
  }
};

Thing Awkward() {
  Thing thing;
  thing.a = 0.1 + 0.2;
  thing.t_ns = 1'700'000'000'123'456'789;
  thing.on = true;
  thing.M << 1e-310, -0.0, 1.0 / 3, std::numeric_limits<double>::max(), 2.5e-17, -7;
  thing.pose = Pose{Eigen::Matrix3d::Identity() / 7, {1, 2, 3}};
  thing.none.reset();
  return thing;
}

TEST(StateText, ComesBackBitForBit) {
  Thing wrote = Awkward(), read;
  StateText out;
  out(wrote);
  StateText in(out.Text());
  in(read);
  in.Finish();
  EXPECT_EQ(read.a, wrote.a);
  EXPECT_EQ(read.t_ns, wrote.t_ns);
  EXPECT_TRUE(read.on);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read.M(i)), std::bit_cast<std::uint64_t>(wrote.M(i)));
  }
  ASSERT_TRUE(read.pose);
  EXPECT_EQ(read.pose->R, wrote.pose->R);
  EXPECT_EQ(read.pose->p, wrote.pose->p);
  EXPECT_FALSE(read.none);
}

TEST(StateText, RefusesWhatIsDamaged) {
  Thing thing = Awkward();
  StateText out;
  out(thing);
  const std::string text = out.Text();
  const auto read = [](const std::string& damaged) {
    Thing other;
    StateText in(damaged);
    in(other);
    in.Finish();
  };
  EXPECT_NO_THROW(read(text));
  EXPECT_THROW(read(text + "1 "), InputError);
  EXPECT_THROW(read(text.substr(0, text.size() / 2)), InputError);
  EXPECT_THROW(read(""), InputError);
  EXPECT_THROW(read("x" + text), InputError);
}

}  // namespace
}  // namespace flextip
