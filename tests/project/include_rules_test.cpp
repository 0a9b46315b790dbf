#include "tests/project/include_rules.h"

#include <gmock/gmock.h>

namespace flextip {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(IncludeRules, HoldInThisTree) {
  const SourceTree tree = ReadSourceTree(FLEXTIP_SOURCE_DIR);
  ASSERT_TRUE(tree.contains("core/pose.h"));
  EXPECT_THAT(IncludeViolations(tree), IsEmpty());
}

TEST(IncludeRules, SeeAnIncludeAgainstAnArrow) {
  const SourceTree tree{{"vision/a.h", "#pragma once\n\n#include \"control/controller.h\"\n"},
                        {"control/controller.h", "#include \"kinematics/rod.h\"\n"}};
  EXPECT_THAT(IncludeViolations(tree), ElementsAre(HasSubstr("vision/a.h:3: includes control/")));
}

TEST(IncludeRules, LetAnArrowBeUsed) {
  const SourceTree tree{{"control/a.cpp", "#include \"kinematics/rod.h\"\n#include <vector>\n"},
                        {"kinematics/rod.h", "#include <Eigen/Dense>\n#include \"core/pose.h\"\n"}};
  EXPECT_THAT(IncludeViolations(tree), IsEmpty());
}

TEST(IncludeRules, KeepTheModelsOutOfThePlant) {
  EXPECT_THAT(IncludeViolations({{"simulation/plant.cpp", "#include \"kinematics/rod.h\"\n"},
                                 {"kinematics/rod.h", ""}}),
              SizeIs(2));  // against an arrow, and a model within reach
  EXPECT_THAT(
      IncludeViolations({{"simulation/closed_loop/loop.cpp", "#include \"kinematics/rod.h\"\n"},
                         {"kinematics/rod.h", ""}}),
      SizeIs(1));  // against an arrow; the loop may reach the models through estimation
}

TEST(IncludeRules, KeepTheModelsOutOfThePlantThroughOtherHeaders) {
  const SourceTree tree{{"simulation/plant.cpp", "#include \"simulation/closed_loop/loop.h\"\n"},
                        {"simulation/closed_loop/loop.h", "#include \"control/controller.h\"\n"},
                        {"control/controller.h", "#include \"kinematics/rod.h\"\n"},
                        {"kinematics/rod.h", ""}};
  EXPECT_THAT(IncludeViolations(tree),
              ElementsAre(HasSubstr("which simulation may not use"),
                          HasSubstr("plant.cpp: reaches kinematics/rod.h")));
}

TEST(IncludeRules, LetOnlyTheLoopUseTheControllers) {
  EXPECT_THAT(
      IncludeViolations({{"simulation/closed_loop/loop.h", "#include \"control/controller.h\"\n"}}),
      IsEmpty());
  EXPECT_THAT(IncludeViolations({{"simulation/sensors.h", "#include \"control/controller.h\"\n"}}),
              SizeIs(1));
}

TEST(IncludeRules, KeepForeignTypesOutOfHeaders) {
  EXPECT_THAT(IncludeViolations({{"vision/a.h", "#include <opencv2/core.hpp>\n"}}), SizeIs(1));
  EXPECT_THAT(IncludeViolations({{"vision/a.cpp", "#include <opencv2/core.hpp>\n"}}), IsEmpty());
  EXPECT_THAT(IncludeViolations({{"control/a.cpp", "#  include <ceres/ceres.h>\n"}}), SizeIs(1));
  EXPECT_THAT(IncludeViolations({{"recording/a.cpp", "#include <apriltag/apriltag.h>\n"}}),
              SizeIs(1));
}

TEST(IncludeRules, KeepWhatIsHiddenToTestsAndBenchmarks) {
  const std::string include = "#include \"testdata/hidden/draw.h\"\n";
  EXPECT_THAT(IncludeViolations({{"apps/a.cpp", include}, {"testdata/hidden/draw.h", ""}}),
              SizeIs(1));
  EXPECT_THAT(IncludeViolations({{"tests/a.cpp", include}, {"bench/a.cpp", include}}), IsEmpty());
}

TEST(IncludeRules, KeepThePipelineFromThePlant) {
  EXPECT_THAT(IncludeViolations({{"pipeline/a.cpp", "#include \"simulation/plant/plant.h\"\n"},
                                 {"simulation/closed_loop/b.cpp", "#include \"pipeline/a.h\"\n"}}),
              SizeIs(1));
}

TEST(IncludeRules, NameFoldersWithoutRules) {
  EXPECT_THAT(IncludeViolations({{"elsewhere/a.cpp", ""}}), SizeIs(1));
}

TEST(IncludeRules, KeepTheReportToResultFiles) {
  EXPECT_THAT(IncludeViolations({{"report/a.cpp", "#include \"diagnosis/diagnose.h\"\n"}}),
              SizeIs(1));
}

}  // namespace
}  // namespace flextip
