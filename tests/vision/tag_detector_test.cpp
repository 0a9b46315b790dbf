// The AprilTag adapter: the library's own corners on photographs, and corners known exactly.
#include "vision/tags/detector.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "core/draw_vector.h"
#include "core/error.h"
#include "core/rotation.h"
#include "tests/vision/synthetic_tag.h"

namespace flextip {
namespace {

Image ReadGrey(const std::filesystem::path& file) {
  const cv::Mat_<std::uint8_t> picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  Image image(picture.cols, picture.rows, 1);
  std::copy(picture.begin(), picture.end(), image.data.begin());
  return image;
}

using Corners = std::array<Eigen::Vector2d, 4>;

std::vector<Corners> ReadExpected(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<Corners> expected;
  for (std::string line; std::getline(in, line);) {
    int id = -1;
    double v[8];
    if (std::sscanf(line.c_str(), "%d, (%lf %lf), (%lf %lf), (%lf %lf), (%lf %lf)", &id, v, v + 1,
                    v + 2, v + 3, v + 4, v + 5, v + 6, v + 7) == 9) {
      expected.push_back({Eigen::Vector2d(v[0], v[1]), Eigen::Vector2d(v[2], v[3]),
                          Eigen::Vector2d(v[4], v[5]), Eigen::Vector2d(v[6], v[7])});
    }
  }
  return expected;
}

double WorstDistance(const Corners& a, const Corners& b) {
  double worst = 0;
  for (int i = 0; i < 4; ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

TEST(TagDetector, RawCornersAreTheLibrarysOnPhotographs) {
  const std::filesystem::path folder = FLEXTIP_SHARED_DIR "/data/apriltag_photos";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  TagDetectorOptions options;
  options.refine_edges = false;
  TagDetector detector(options);
  int expected_tags = 0;
  for (const char* name :
       {"33369213973_9d9bb4cc96_c", "34085369442_304b6bafd9_c", "34139872896_defdb2f8d9_c"}) {
    const auto tags = detector.Detect(ReadGrey(folder / (std::string(name) + ".jpg")));
    const auto expected = ReadExpected(folder / (std::string(name) + ".txt"));
    EXPECT_EQ(tags.size(), expected.size()) << name;
    expected_tags += static_cast<int>(expected.size());
    for (const Corners& corners : expected) {
      double nearest = 1e9;
      for (const TagDetection& tag : tags) {
        EXPECT_EQ(tag.id, 0);
        nearest = std::min(nearest, WorstDistance(tag.raw_corners_px, corners));
      }
      EXPECT_LT(nearest, 0.15) << name << " at " << corners[0].transpose();
    }
  }
  EXPECT_EQ(expected_tags, 47);
}

// Forty-five tags of one size, tilted and turned at random.
std::vector<PlacedTag> TagField(double side_px, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  const CameraCalibration camera = TestCamera(false);
  std::vector<PlacedTag> tags;
  for (int id = 0; id < 45; ++id) {
    const double z = 0.1, column = 140 + 125 * (id % 9), row = 75 + 140 * (id / 9);
    PlacedTag tag{id, side_px / camera.fu_px * z, {}};
    const Eigen::Vector2d across = DrawVector<2>(u, random);
    const Eigen::Vector3d tilt_axis = Eigen::Vector3d(across.x(), across.y(), 0).normalized();
    const double roll = 3.1 * u(random), tilt = 0.8 * std::abs(u(random));
    tag.T_CG.R = ExpRotation(tilt * tilt_axis) * ExpRotation({0, 0, roll});
    const Eigen::Vector2d off_px = DrawVector<2>(u, random);
    tag.T_CG.p = Eigen::Vector3d((column + off_px.x() - camera.cu_px) / camera.fu_px * z,
                                 (row + off_px.y() - camera.cv_px) / camera.fv_px * z, z);
    tags.push_back(tag);
  }
  return tags;
}

struct CornerErrors {
  Eigen::Vector2d sum{0, 0};
  double outward = 0, squared = 0;
  int count = 0;
  void Add(const Eigen::Vector2d& error, const Eigen::Vector2d& out) {
    sum += error;
    outward += error.dot(out);
    squared += error.squaredNorm();
    ++count;
  }
  double Rms() const { return std::sqrt(squared / count / 2); }  // per axis
};

struct FieldResult {
  CornerErrors raw, final;
  int tags = 0, refined = 0;
};

FieldResult MeasureField(double side_px, const TagDetectorOptions& options) {
  FieldResult result;
  const auto tags = TagField(side_px, 5);
  SyntheticOptions synthetic;
  synthetic.shading = 0.3;
  const Image image = RenderTags(TestCamera(false), tags, synthetic);
  TagDetector detector(options);
  for (const TagDetection& found : detector.Detect(image)) {
    const auto truth = TrueCorners(TestCamera(false), tags.at(found.id));
    const Eigen::Vector2d centre = (truth[0] + truth[1] + truth[2] + truth[3]) / 4;
    ++result.tags;
    result.refined += found.refined;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector2d out = (truth[i] - centre).normalized();
      const Eigen::Vector2d half(0.5, 0.5);
      result.raw.Add(found.raw_corners_px[i] - half - truth[i], out);
      result.final.Add(found.corners_px[i] - truth[i], out);
    }
  }
  return result;
}

// Also the corner order and the pixel origin: a tag turned at random by up to a half turn would be
// tens of pixels off in any other order, and half a pixel with the library's origin.
TEST(TagDetector, RefittedCornersAreUnbiasedAndMuchSharper) {
  for (const double side_px : {40.0, 60.0, 80.0}) {
    const FieldResult r = MeasureField(side_px, {});
    EXPECT_EQ(r.tags, 45) << side_px;
    EXPECT_EQ(r.refined, 45) << side_px;
    EXPECT_LT((r.final.sum / r.final.count).cwiseAbs().maxCoeff(), 0.005) << side_px;
    EXPECT_LT(std::abs(r.final.outward / r.final.count), 0.005) << side_px;
    EXPECT_LT(r.final.Rms(), side_px < 50 ? 0.024 : 0.014) << side_px;
    EXPECT_LT(r.final.Rms(), 0.5 * r.raw.Rms()) << side_px;
  }
}

TEST(TagDetector, RefittingRemovesTheLibrarysBiasWithoutItsRefinement) {
  TagDetectorOptions options;
  options.refine_edges = false;
  const FieldResult r = MeasureField(60, options);
  EXPECT_LT((r.raw.sum / r.raw.count).x(), -0.03);  // what the library does
  EXPECT_LT((r.raw.sum / r.raw.count).y(), -0.03);
  EXPECT_LT((r.final.sum / r.final.count).cwiseAbs().maxCoeff(), 0.005);
}

TEST(TagDetector, SmallTagsArePulledInwardLessThanTheLibrarys) {
  const FieldResult r = MeasureField(24, {});
  EXPECT_GE(r.tags, 43);
  EXPECT_LT(r.raw.outward / r.raw.count, -0.04);
  EXPECT_LT(std::abs(r.final.outward / r.final.count), 0.02);
  EXPECT_LT(r.final.Rms(), 0.6 * r.raw.Rms());
}

TEST(TagDetector, DecimationCostsNoAccuracyOnceRefitted) {
  TagDetectorOptions options;
  options.quad_decimate = 2;
  const FieldResult r = MeasureField(60, options);
  EXPECT_GE(r.tags, 44);
  EXPECT_LT(r.final.Rms(), 0.014);
}

TEST(TagDetector, ColourIsReadAsGrey) {
  const Image grey = RenderTags(TestCamera(false), TagField(60, 5), {});
  Image colour(grey.width_px, grey.height_px, 3);
  for (std::size_t i = 0; i < grey.data.size(); ++i) {
    for (int c = 0; c < 3; ++c) colour.data[3 * i + c] = grey.data[i];
  }
  TagDetector detector;
  const auto a = detector.Detect(grey), b = detector.Detect(colour);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].id, b[i].id);
    EXPECT_LT(WorstDistance(a[i].corners_px, b[i].corners_px), 1e-9);
  }
}

TEST(TagDetector, NothingInNoiseOrInTinyImages) {
  TagDetector detector;
  EXPECT_TRUE(detector.Detect(RenderTags(TestCamera(false), {}, {.noise = 20})).empty());
  for (const int side : {1, 2, 3, 7, 17}) {
    Image tiny(side, side, 1);
    EXPECT_TRUE(detector.Detect(tiny).empty()) << side;
    Image strip(200, side, 1);
    EXPECT_TRUE(detector.Detect(strip).empty()) << side;
  }
}

TEST(TagDetector, RejectsWhatItCannotUse) {
  TagDetector detector;
  EXPECT_THROW(detector.Detect(Image()), InputError);
  EXPECT_THROW(detector.Detect(Image(64, 64, 2)), InputError);
  TagDetectorOptions options;
  options.family = "tag99h1";
  EXPECT_THROW(TagDetector{options}, InputError);
  options = {};
  options.quad_decimate = 0.5;
  EXPECT_THROW(TagDetector{options}, InputError);
  options = {};
  options.threads = 0;
  EXPECT_THROW(TagDetector{options}, InputError);
  options = {};
  options.max_hamming = 3;
  EXPECT_THROW(TagDetector{options}, InputError);
}

}  // namespace
}  // namespace flextip
