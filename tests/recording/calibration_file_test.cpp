// calibration.yaml written, read again, and refused where it is broken.
#include "recording/calibrations/file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <tuple>

#include "core/error.h"
#include "core/rotation.h"

namespace flextip {
namespace {

Calibration SampleCalibration() {
  Calibration c;
  c.kind = "hand-eye";
  c.poses["cam0.T_RC"] = {ExpRotation({0.3, -1.2, 0.4}), {0.1, -0.05, 0.2}};
  c.poses["board.T_WB"] = {ExpRotation({0.1, 0.1, 2.0}), {0.001, 0.002, 1.0 / 3}};
  c.numbers["cam0.time_offset_s"] = {0.0123};
  c.texts["cam0.distortion_model"] = "equidistant";
  c.numbers["strain0.offset_Nm"] = {0.1, 0.2, -0.3, 1e-17};
  const int n = static_cast<int>(c.CoordinateNames().size());
  Eigen::MatrixXd root(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) root(i, j) = 1e-3 * std::sin(1.0 + i * 7 + j * 3 + i * j);
  c.covariance = root * root.transpose();
  c.unobservable = {{"board.T_WB.p[0]", "the wrist turned about one axis only"}};
  return c;
}

class CalibrationFile : public testing::Test {
 protected:
  std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("calibration_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
       ".yaml");
  std::string Text() const {
    std::ostringstream text;
    text << std::ifstream(file_).rdbuf();
    return text.str();
  }
  std::string ErrorWith(const std::string& from, const std::string& to) {
    WriteCalibration(file_, SampleCalibration());
    std::string text = Text();
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    std::ofstream(file_) << text.replace(at, from.size(), to);
    try {
      ReadCalibration(file_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(CalibrationFile, IsTheSameWhenReadAgain) {
  const Calibration c = SampleCalibration();
  WriteCalibration(file_, c);
  const Calibration read = ReadCalibration(file_);
  EXPECT_EQ(read.kind, c.kind);
  EXPECT_EQ(read.numbers, c.numbers);
  EXPECT_EQ(read.texts, c.texts);
  EXPECT_EQ(read.covariance, c.covariance);
  ASSERT_EQ(read.poses.size(), 2u);
  for (const auto& [name, pose] : c.poses) {
    EXPECT_EQ(read.poses.at(name).p, pose.p);
    EXPECT_LT((read.poses.at(name).R - pose.R).norm(), 1e-15);
  }
  ASSERT_EQ(read.unobservable.size(), 1u);
  EXPECT_EQ(read.unobservable[0].reason, c.unobservable[0].reason);
}

TEST_F(CalibrationFile, NamesEachNumber) {
  const Calibration c = SampleCalibration();
  const auto names = c.CoordinateNames();
  ASSERT_EQ(names.size(), 17u);
  EXPECT_EQ(names[0], "board.T_WB.w[0]");
  EXPECT_EQ(names[11], "cam0.T_RC.p[2]");
  EXPECT_EQ(names[12], "cam0.time_offset_s");
  EXPECT_EQ(names[16], "strain0.offset_Nm[3]");
  EXPECT_EQ(c.RangeOf("strain0.offset_Nm").first, 13);
  EXPECT_EQ(c.CovarianceOf("cam0.T_RC"), c.covariance.block(6, 6, 6, 6));
  EXPECT_THROW(c.RangeOf("em0.T_RF"), InputError);
}

TEST_F(CalibrationFile, WithoutCovariance) {
  Calibration c = SampleCalibration();
  c.covariance.resize(0, 0);
  c.unobservable.clear();
  WriteCalibration(file_, c);
  EXPECT_EQ(ReadCalibration(file_).covariance.size(), 0);
  EXPECT_EQ(ReadCalibration(file_).CovarianceOf("cam0.T_RC").size(), 0);
}

TEST_F(CalibrationFile, RefusesWhatIsBroken) {
  const std::string name = file_.filename().string();
  EXPECT_NE(ErrorWith("version: 1", "version: 2").find(name + ":2: "), std::string::npos);
  EXPECT_NE(ErrorWith("flextip-calibration", "flextip-model").find(name + ":1: "),
            std::string::npos);
  EXPECT_NE(ErrorWith("kind:", "knid:"), "");
  EXPECT_NE(ErrorWith("\"equidistant\"", "[1, 2]").find("cam0.distortion_model"),
            std::string::npos);
  EXPECT_NE(ErrorWith("0.0123", ".nan").find("cam0.time_offset_s"), std::string::npos);
  EXPECT_NE(ErrorWith("\"cam0.time_offset_s\"", "\"cam0.gamma\"").find("parameters"),
            std::string::npos);
  EXPECT_NE(ErrorWith("unobservable:", "unobservabel:"), "");
}

// It could not be read again.
TEST_F(CalibrationFile, RefusesANameThatIsNone) {
  for (const std::string name : {"cam 0.time_offset_s", "a#b", "a: b", "\xc3\xa9"}) {
    std::ofstream(file_) << "format: flextip-calibration\nversion: 1\nkind: camera\nfound:\n  \""
                         << name << "\": 1\n";
    EXPECT_THROW(ReadCalibration(file_), InputError) << name;
  }
}

TEST_F(CalibrationFile, RefusesWhatIsNoCovariance) {
  for (const auto& [row, column, value] :
       {std::tuple{0, 0, -1.0}, std::tuple{3, 4, 1.0}, std::tuple{16, 16, 1e-12}}) {
    Calibration c = SampleCalibration();
    c.covariance(row, column) = value;
    WriteCalibration(file_, c);
    EXPECT_THROW(ReadCalibration(file_), InputError) << row << " " << column;
  }
}

}  // namespace
}  // namespace flextip
