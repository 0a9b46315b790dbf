#include "tests/recording/sample_recording.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <sstream>

#include "recording/recording_writer.h"

namespace flextip::test_support {
namespace {

constexpr TimeNs kStart = 1'700'000'000'000'000'000;

/// Doubles that a writer with too few digits, or a locale, gets wrong.
class Awkward {
 public:
  double Next() {
    static const double kSpecial[] = {-0.0, 0.1, 5e-324, 98765.432101234567, 1.0 / 3.0, 1e-22};
    if (count_++ % 7 == 0) return kSpecial[(count_ / 7) % 6];
    return uniform_(generator_);
  }
  Eigen::Vector3d Vector() { return {Next(), Next(), Next()}; }
  Eigen::Vector3d SmallVector() { return {Small(), Small(), Small()}; }
  Eigen::Quaterniond Unit() {
    Eigen::Quaterniond q(Small(), Small(), Small(), 1.0);
    q.normalize();
    return q;
  }
  double Small() { return uniform_(generator_); }

 private:
  std::mt19937 generator_{7};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
  int count_ = 0;
};

TimeNs At(int i, TimeNs period = 20'000'000) { return kStart + i * period; }

CameraStream MakeCamera(Awkward& numbers) {
  CameraStream camera;
  camera.comment = "laparoscope \"left\": grey\\";
  auto& c = camera.calibration;
  c.width_px = kWidth;
  c.height_px = kHeight;
  c.fu_px = 95.0 / 3.0;
  c.fv_px = 97.0 / 3.0;
  c.cu_px = 15.123456789012345;
  c.cv_px = 11.9;
  c.distortion_coefficients = {-0.22, 1.0 / 7.0, 6e-4, -0.0};
  c.gamma = 2.2;
  c.rate_hz = 25.0;
  c.T_RC = Pose::FromQuaternion(numbers.Unit(), numbers.SmallVector());
  for (int i = 0; i < kSamples; ++i) {
    camera.filenames.push_back({At(i, 40'000'000), std::to_string(i) + ".png"});
  }
  return camera;
}

VisionStream MakeVision(Awkward& numbers) {
  VisionStream vision{"tip", 25.0, "cam0", 0.003, 0.01, 0.002, {}};
  for (int i = 0; i < kSamples; ++i) {
    TipObservation tip;
    tip.status = i == 2 ? TipStatus::kLost : i == 3 ? TipStatus::kPredicted : TipStatus::kOk;
    if (tip.status != TipStatus::kLost) {
      tip.p_RE = numbers.Vector();
      const Eigen::Matrix3d a = Eigen::Matrix3d::NullaryExpr([&] { return numbers.Small(); });
      const Eigen::Matrix3d product = 1e-8 * a * a.transpose();
      tip.covariance_m2 = product.selfadjointView<Eigen::Lower>();
      if (i != 4) tip.d_RE = numbers.SmallVector().normalized();
    }
    vision.tips.push_back({At(i, 40'000'000), tip});
  }
  return vision;
}

}  // namespace

Recording MakeRecording() {
  Awkward numbers;
  Recording r;
  r.instrument = {0.6, 0.00238, 0.30397301812345678, 1.0 / 300.0, -1.0 / 7.0};
  r.p_RP = numbers.SmallVector();
  r.gravity_m_s2 = {0, -0.0, -9.80665};
  r.tolerances = {{"stiffness.scale", {0.1 / 3.0}}, {"port_offset.offset_m", {1e-4, 2e-4, 1e-4}}};
  r.wrist0 = WristStream{"wrist", 50.0, 5e-5, 3e-4, {}};
  r.command0 = CommandStream{"", 50.0, {}};
  r.em0 = EmStream{"em", 50.0, 0.02, 1.3e-4, 5.6e-4, NoiseDistribution::kUniform, 1e-3, 2e-4, {}};
  r.em1 = EmStream{"port", 40.0, 0.0, 1e-4, 5e-4, NoiseDistribution::kGaussian, 0, 0, {}};
  r.strain0 = StrainStream{"gages", 50.0, {0.12, 0.5}, 8e-4, {}};
  r.load0 = LoadStream{"cell", 50.0, 0.005, {}};
  for (int i = 0; i < kSamples; ++i) {
    r.wrist0->samples.push_back({At(i), {numbers.Vector(), {}}});
    if (i != 1) r.wrist0->samples.back().value.q_RW = numbers.Unit();
    r.command0->p_RW.push_back({At(i), numbers.Vector()});
    r.em0->samples.push_back({At(i), {numbers.Vector(), numbers.Unit()}});
    r.em1->samples.push_back({At(i) + 1, {numbers.Vector(), numbers.Unit()}});
    r.strain0->moments_Nm.push_back({At(i), {numbers.Next(), numbers.Next(), 0.0, 1.0}});
    r.load0->f_tip_N.push_back({At(i), numbers.Vector()});
  }
  r.cam0 = MakeCamera(numbers);
  r.vision0 = MakeVision(numbers);
  r.cam1 = r.cam0;  // the other eye
  r.cam1->comment = "right";
  r.cam1->calibration.cu_px = 17.25;
  for (auto& frame : r.cam1->filenames) frame.value = "right" + frame.value;
  r.tags0 = TagCollar{};
  for (int id : {3, 0}) {
    r.tags0->tags.push_back(
        {id, 0.005, Pose::FromQuaternion(numbers.Unit(), numbers.SmallVector())});
  }
  return r;
}

Series<TruthSample> MakeTruth() {
  Awkward numbers;
  Series<TruthSample> truth;
  for (int i = 0; i < kSamples; ++i) {
    truth.push_back({At(i), {numbers.Vector(), numbers.Unit(), numbers.Vector()}});
  }
  return truth;
}

void WriteSample(const std::filesystem::path& folder) {
  const Recording recording = MakeRecording();
  WriteRecording(folder, recording);
  WriteTruth(folder, MakeTruth());
  const cv::Mat image(kHeight, kWidth, CV_8UC1, cv::Scalar(80));
  for (const auto& [name, camera] :
       {std::pair("cam0/data", &recording.cam0), std::pair("cam1/data", &recording.cam1)}) {
    std::filesystem::create_directories(folder / name);
    for (const auto& frame : (*camera)->filenames) {
      ASSERT_TRUE(cv::imwrite((folder / name / frame.value).string(), image));
    }
  }
}

TemporaryFolder::TemporaryFolder() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string("flextip_") + test->test_suite_name() + "_" + test->name();
  std::replace(name.begin(), name.end(), '/', '_');
  path_ = std::filesystem::temp_directory_path() / (name + "_" + std::to_string(getpid()));
  std::filesystem::remove_all(path_);
  std::filesystem::create_directories(path_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string ReadText(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  EXPECT_TRUE(in) << file;
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void WriteText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

void ReplaceLine(const std::filesystem::path& file, int line, const std::string& text) {
  std::istringstream in(ReadText(file));
  std::string out, each;
  for (int i = 1; std::getline(in, each); ++i) out += (i == line ? text : each) + "\n";
  WriteText(file, out);
}

std::string Line(const std::filesystem::path& file, int line) {
  std::istringstream in(ReadText(file));
  std::string each;
  for (int i = 0; i < line; ++i) std::getline(in, each);
  return each;
}

int Replace(const std::filesystem::path& file, const std::string& from, const std::string& to) {
  std::string text = ReadText(file);
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from << " is not in " << file;
  if (at == std::string::npos) return 0;
  const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  WriteText(file, text.replace(at, from.size(), to));
  return static_cast<int>(line) + 1;
}

}  // namespace flextip::test_support
