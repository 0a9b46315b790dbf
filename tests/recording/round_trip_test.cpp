#include <gmock/gmock.h>

#include <bit>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "recording/cameras/camera_file.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "tests/recording/sample_recording.h"

namespace flextip {
namespace {

using flextip::test_support::kSamples;
using flextip::test_support::MakeRecording;
using flextip::test_support::MakeTruth;
using flextip::test_support::ReadText;
using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteSample;

std::uint64_t Bits(double value) { return std::bit_cast<std::uint64_t>(value); }

template <class A, class B>
void ExpectSameBits(const A& a, const B& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    EXPECT_EQ(Bits(a.data()[i]), Bits(b.data()[i])) << what << " " << i;
  }
}
void ExpectSameBits(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, const char* what) {
  ExpectSameBits(a.coeffs(), b.coeffs(), what);
}
void ExpectSameBits(const Pose& a, const Pose& b, const char* what) {
  ExpectSameBits(a.R, b.R, what);
  ExpectSameBits(a.p, b.p, what);
}

template <class T, class Compare>
void ExpectSameSeries(const Series<T>& a, const Series<T>& b, Compare compare) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_EQ(a.size(), static_cast<std::size_t>(kSamples));
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].t_ns, b[i].t_ns);
    compare(a[i].value, b[i].value);
  }
}

struct RoundTrip : public ::testing::Test {
  void SetUp() override {
    WriteSample(folder.path());
    result = ReadRecording(folder.path());
  }
  TemporaryFolder folder;
  Recording wrote = MakeRecording();
  ReadResult result;
  const Recording& read = result.recording;
};

TEST_F(RoundTrip, ReadsWithoutWarnings) {
  EXPECT_THAT(result.warnings, ::testing::IsEmpty());
  EXPECT_EQ(result.torn_lines, 0);
  EXPECT_EQ(result.dropped_frames, 0);
}

TEST_F(RoundTrip, InstrumentPortAndTolerances) {
  EXPECT_EQ(Bits(read.instrument.length_m), Bits(wrote.instrument.length_m));
  EXPECT_EQ(Bits(read.instrument.outer_diameter_m), Bits(wrote.instrument.outer_diameter_m));
  EXPECT_EQ(Bits(read.instrument.bending_stiffness_Nm2),
            Bits(wrote.instrument.bending_stiffness_Nm2));
  EXPECT_EQ(Bits(read.instrument.mass_per_length_kg_m),
            Bits(wrote.instrument.mass_per_length_kg_m));
  EXPECT_EQ(Bits(read.instrument.stiffness_taper), Bits(wrote.instrument.stiffness_taper));
  ExpectSameBits(read.p_RP, wrote.p_RP, "port");
  ExpectSameBits(read.gravity_m_s2, wrote.gravity_m_s2, "gravity");
  EXPECT_EQ(read.tolerances, wrote.tolerances);
}

TEST_F(RoundTrip, WristAndCommand) {
  EXPECT_EQ(read.wrist0->comment, wrote.wrist0->comment);
  EXPECT_EQ(read.wrist0->rate_hz, wrote.wrist0->rate_hz);
  EXPECT_EQ(read.wrist0->position_noise_m, wrote.wrist0->position_noise_m);
  EXPECT_EQ(read.wrist0->orientation_noise_rad, wrote.wrist0->orientation_noise_rad);
  ExpectSameSeries(read.wrist0->samples, wrote.wrist0->samples,
                   [](const WristSample& a, const WristSample& b) {
                     ExpectSameBits(a.p_RW, b.p_RW, "wrist");
                     ASSERT_EQ(a.q_RW.has_value(), b.q_RW.has_value());
                     if (a.q_RW) ExpectSameBits(*a.q_RW, *b.q_RW, "wrist");
                   });
  ExpectSameSeries(read.command0->p_RW, wrote.command0->p_RW,
                   [](const auto& a, const auto& b) { ExpectSameBits(a, b, "command"); });
}

TEST_F(RoundTrip, EmStrainAndLoad) {
  for (const auto& [a, b] : {std::pair(&read.em0, &wrote.em0), std::pair(&read.em1, &wrote.em1)}) {
    EXPECT_EQ((*a)->comment, (*b)->comment);
    EXPECT_EQ((*a)->rate_hz, (*b)->rate_hz);
    EXPECT_EQ((*a)->distance_from_tip_m, (*b)->distance_from_tip_m);
    EXPECT_EQ((*a)->position_noise_m, (*b)->position_noise_m);
    EXPECT_EQ((*a)->orientation_noise_rad, (*b)->orientation_noise_rad);
    EXPECT_EQ((*a)->noise_distribution, (*b)->noise_distribution);
    EXPECT_EQ((*a)->registration_noise_rad, (*b)->registration_noise_rad);
    EXPECT_EQ((*a)->registration_noise_m, (*b)->registration_noise_m);
    ExpectSameSeries((*a)->samples, (*b)->samples, [](const EmSample& x, const EmSample& y) {
      ExpectSameBits(x.p_RS, y.p_RS, "em");
      ExpectSameBits(x.q_RS, y.q_RS, "em");
    });
  }
  EXPECT_EQ(read.strain0->station_from_wrist_m[0], wrote.strain0->station_from_wrist_m[0]);
  EXPECT_EQ(read.strain0->station_from_wrist_m[1], wrote.strain0->station_from_wrist_m[1]);
  EXPECT_EQ(read.strain0->moment_noise_Nm, wrote.strain0->moment_noise_Nm);
  ExpectSameSeries(read.strain0->moments_Nm, wrote.strain0->moments_Nm,
                   [](const auto& a, const auto& b) { ExpectSameBits(a, b, "strain"); });
  EXPECT_EQ(read.load0->force_noise_N, wrote.load0->force_noise_N);
  ExpectSameSeries(read.load0->f_tip_N, wrote.load0->f_tip_N,
                   [](const auto& a, const auto& b) { ExpectSameBits(a, b, "load"); });
}

void ExpectSameCamera(const CameraCalibration& a, const CameraCalibration& b) {
  EXPECT_EQ(a.width_px, b.width_px);
  EXPECT_EQ(a.height_px, b.height_px);
  EXPECT_EQ(Bits(a.fu_px), Bits(b.fu_px));
  EXPECT_EQ(Bits(a.fv_px), Bits(b.fv_px));
  EXPECT_EQ(Bits(a.cu_px), Bits(b.cu_px));
  EXPECT_EQ(Bits(a.cv_px), Bits(b.cv_px));
  EXPECT_EQ(a.distortion, b.distortion);
  EXPECT_EQ(a.distortion_coefficients, b.distortion_coefficients);
  EXPECT_EQ(a.gamma, b.gamma);
  EXPECT_EQ(a.rate_hz, b.rate_hz);
  ExpectSameBits(a.T_RC, b.T_RC, "T_RC");
}

TEST_F(RoundTrip, CameraAndTags) {
  EXPECT_EQ(read.cam0->comment, wrote.cam0->comment);
  EXPECT_EQ(read.cam0->video, "");
  ExpectSameCamera(read.cam0->calibration, wrote.cam0->calibration);
  EXPECT_EQ(read.cam0->filenames, wrote.cam0->filenames);
  ASSERT_TRUE(read.cam1);
  EXPECT_EQ(read.cam1->comment, "right");
  ExpectSameCamera(read.cam1->calibration, wrote.cam1->calibration);
  EXPECT_EQ(read.cam1->filenames, wrote.cam1->filenames);
  ASSERT_EQ(read.tags0->tags.size(), wrote.tags0->tags.size());
  EXPECT_EQ(read.tags0->family, wrote.tags0->family);
  for (std::size_t i = 0; i < read.tags0->tags.size(); ++i) {
    EXPECT_EQ(read.tags0->tags[i].id, wrote.tags0->tags[i].id);
    EXPECT_EQ(read.tags0->tags[i].size_m, wrote.tags0->tags[i].size_m);
    ExpectSameBits(read.tags0->tags[i].T_EG, wrote.tags0->tags[i].T_EG, "tag");
  }
}

TEST_F(RoundTrip, Vision) {
  EXPECT_EQ(read.vision0->camera, wrote.vision0->camera);
  EXPECT_EQ(read.vision0->direction_noise_rad, wrote.vision0->direction_noise_rad);
  EXPECT_EQ(read.vision0->registration_noise_rad, wrote.vision0->registration_noise_rad);
  EXPECT_EQ(read.vision0->registration_noise_m, wrote.vision0->registration_noise_m);
  ExpectSameSeries(read.vision0->tips, wrote.vision0->tips,
                   [](const TipObservation& a, const TipObservation& b) {
                     EXPECT_EQ(a.status, b.status);
                     ExpectSameBits(a.p_RE, b.p_RE, "tip");
                     ExpectSameBits(a.covariance_m2, b.covariance_m2, "covariance");
                     ASSERT_EQ(a.d_RE.has_value(), b.d_RE.has_value());
                     if (a.d_RE) ExpectSameBits(*a.d_RE, *b.d_RE, "direction");
                   });
}

TEST_F(RoundTrip, Truth) {
  const auto truth = ReadTruth(folder.path());
  ASSERT_TRUE(truth.has_value());
  ExpectSameSeries(*truth, MakeTruth(), [](const TruthSample& a, const TruthSample& b) {
    ExpectSameBits(a.p_RE, b.p_RE, "truth");
    ExpectSameBits(a.q_RE, b.q_RE, "truth");
    ExpectSameBits(a.p_RW, b.p_RW, "truth");
  });
  std::filesystem::remove_all(folder / "truth0");
  EXPECT_FALSE(ReadTruth(folder.path()).has_value());
}

TEST_F(RoundTrip, WritingWhatWasReadGivesTheSameBytes) {
  WriteRecording(folder / "again", read);
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "again")) {
    if (!entry.is_regular_file()) continue;
    const auto relative = std::filesystem::relative(entry.path(), folder / "again");
    EXPECT_EQ(ReadText(entry.path()), ReadText(folder.path() / relative)) << relative;
    ++files;
  }
  EXPECT_EQ(files, 20);  // recording.yaml, tags0/sensor.yaml, two for each of the nine others
}

TEST(Writer, RefusesWhatTheReaderWouldReject) {
  const TemporaryFolder folder;
  const auto refuses = [&](auto change) {
    Recording recording = MakeRecording();
    change(recording);
    EXPECT_THROW(WriteRecording(folder.path(), recording), WorkError);
  };
  refuses([](Recording& r) { r.wrist0->samples[1].value.p_RW.x() = std::nan(""); });
  refuses([](Recording& r) { r.load0->f_tip_N[1].t_ns = r.load0->f_tip_N[0].t_ns; });
  refuses([](Recording& r) { r.em0->samples[3].value.q_RS.coeffs() *= 1.01; });
  refuses([](Recording& r) { r.strain0->moments_Nm.clear(); });
  refuses([](Recording& r) { r.instrument.length_m = HUGE_VAL; });
  // recording.yaml comes last: what was left by a failure does not read as a recording.
  EXPECT_THROW(ReadRecording(folder.path()), InputError);
}

TEST(CameraFile, EveryModelComesBackAlone) {
  const TemporaryFolder folder;
  for (const auto& [model, count] : {std::pair(Distortion::kRadialTangential, 4),
                                     {Distortion::kOpenCv, 5},
                                     {Distortion::kOpenCv, 8},
                                     {Distortion::kOpenCv, 12},
                                     {Distortion::kEquidistant, 4}}) {
    auto camera = MakeRecording().cam0->calibration;
    camera.distortion = model;
    camera.distortion_coefficients.assign(static_cast<std::size_t>(count), 0.1 / 3.0);
    camera.gamma.reset();
    WriteCameraCalibration(folder / "camera.yaml", camera, "bench");
    ReadLog log;
    ExpectSameCamera(ReadCameraCalibration(folder / "camera.yaml", &log), camera);
    EXPECT_THAT(log.warnings, ::testing::IsEmpty());
  }
}

TEST(CameraFile, MayLackItsRegistration) {
  const TemporaryFolder folder;
  flextip::test_support::WriteText(
      folder / "camera.yaml",
      "camera_model: pinhole\nresolution: [640, 480]\n"
      "intrinsics: [500, 501, 320, 240]\ndistortion_model: equidistant\n"
      "distortion_coefficients: [0, 0, 0, 0]\nT_BS: 3\n");
  ReadLog log;
  const auto camera = ReadCameraCalibration(folder / "camera.yaml", &log);
  EXPECT_TRUE(camera.T_RC.Matrix().isIdentity(0.0));
  EXPECT_EQ(camera.fv_px, 501);
  EXPECT_THAT(
      log.warnings,
      ::testing::ElementsAre(::testing::HasSubstr("camera.yaml:6: unknown key \"T_BS\" ignored")));
}

}  // namespace
TEST(CameraPose, MayBeUnknownWhereTheFileSaysSo) {
  const TemporaryFolder folder;
  WriteSample(folder.path());
  Recording recording = MakeRecording();
  recording.cam0->has_T_RC = false;
  WriteRecording(folder.path(), recording);
  EXPECT_THAT(ReadText(folder / "cam0/sensor.yaml"), ::testing::HasSubstr("T_RC: unknown\n"));
  const Recording read = ReadRecording(folder.path()).recording;
  EXPECT_FALSE(read.cam0->has_T_RC);
  EXPECT_TRUE(read.cam0->calibration.T_RC.Matrix().isIdentity(0.0));
  EXPECT_TRUE(read.cam1->has_T_RC);
}

}  // namespace flextip
