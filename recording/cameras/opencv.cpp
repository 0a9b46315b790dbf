// Cameras in OpenCV's FileStorage, with the keys of its own calibration program
// (samples/cpp/tutorial_code/calib3d/camera_calibration).
#include <initializer_list>
#include <opencv2/core.hpp>
#include <set>

#include "recording/cameras/format_parts.h"
#include "recording/frames/frames.h"
#include "recording/text/bounds.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

using Keys = std::initializer_list<const char*>;
constexpr int kLargestMatrix = 100;
constexpr Keys kMatrixKeys = {"camera_matrix", "cameraMatrix", "Camera_Matrix"};
constexpr Keys kTermKeys = {"distortion_coefficients", "distCoeffs", "dist_coeffs",
                            "Distortion_Coefficients"};
constexpr Keys kWidthKeys = {"image_width", "image_Width"};
constexpr Keys kHeightKeys = {"image_height", "image_Height"};

struct Reader {
  std::string file;
  cv::FileStorage storage;

  explicit Reader(const std::filesystem::path& path) : file(path.string()) {
    (void)OpenFile(path);  // throws where it is no file
    bool opened = false;
    try {
      const QuietStderr quiet;
      opened = storage.open(file, cv::FileStorage::READ);
    } catch (const std::exception&) {  // of OpenCV or the standard library; reported below
    }
    if (!opened) throw Error("cannot be read by OpenCV: it is cut off, damaged or of another kind");
  }
  InputError Error(const std::string& what) const { return InputError::At(file, 0, what); }

  cv::FileNode Find(Keys keys) const {
    for (const char* key : keys) {
      if (const auto node = storage[key]; !node.empty()) return node;
    }
    return {};
  }
  /// OpenCV asks for the memory of a matrix before it counts what is in it.
  void RefuseLarge(const std::string& name, const cv::FileNode& node) const {
    if (!node.isMap()) return;
    if (!node["sizes"].empty() || !node["rows"].isInt() || !node["cols"].isInt())
      throw Error(fmt::format("{}: expected a matrix of rows and columns", name));
    const int rows = static_cast<int>(node["rows"]), cols = static_cast<int>(node["cols"]);
    if (rows >= 0 && rows <= kLargestMatrix && cols >= 0 && cols <= kLargestMatrix) return;
    throw Error(fmt::format("{}: found {} rows and {} columns, expected at most {}", name, rows,
                            cols, kLargestMatrix));
  }
  std::vector<double> Matrix(Keys keys) const {
    const std::string name = *keys.begin();
    const auto node = Find(keys);
    if (node.empty()) throw Error(fmt::format("key \"{}\" is missing", name));
    RefuseLarge(name, node);
    cv::Mat matrix;
    try {
      node >> matrix;
      matrix.convertTo(matrix, CV_64F);
    } catch (const std::exception&) {
      throw Error(fmt::format("{}: expected a matrix", name));
    }
    const cv::Mat flat = matrix.clone().reshape(1, 1);
    std::vector<double> values(flat.begin<double>(), flat.end<double>());
    for (const double value : values) {
      const std::string expected = ExpectedWithin(BoundsOf(name), value);
      if (!expected.empty()) {
        throw Error(fmt::format("{}: found {}, expected {}", name, value, expected));
      }
    }
    return values;
  }
  int Whole(Keys keys, int fallback) const {
    const auto node = Find(keys);
    if (node.empty()) return fallback;
    if (!node.isInt()) throw Error(fmt::format("{}: expected a whole number", *keys.begin()));
    const int value = static_cast<int>(node);
    const std::string expected = ExpectedWithin(BoundsOf(*keys.begin()), value);
    if (expected.empty()) return value;
    throw Error(fmt::format("{}: found {}, expected {}", *keys.begin(), value, expected));
  }
  std::string Text(const char* key) const {
    const auto node = storage[key];
    return node.isString() ? static_cast<std::string>(node) : "";
  }
};

void ReadLens(const Reader& in, CameraCalibration& camera) {
  camera.distortion_coefficients = in.Matrix(kTermKeys);
  auto& k = camera.distortion_coefficients;
  if (in.Whole({"fisheye_model"}, 0) != 0) {
    camera.distortion = Distortion::kEquidistant;
    if (k.size() != 4) {
      throw in.Error(fmt::format(
          "distortion_coefficients: found {}, expected 4 for a fisheye_model", k.size()));
    }
    return;
  }
  if (k.empty()) k = {0, 0, 0, 0};
  if (k.size() == 14 && k[12] == 0 && k[13] == 0) k.resize(12);
  if (k.size() == 14) {
    throw in.Error(
        "distortion_coefficients: found a tilted sensor (the last two of 14), of which "
        "there is no counterpart");
  }
  if (!std::set<std::size_t>{4, 5, 8, 12}.contains(k.size())) {
    throw in.Error(
        fmt::format("distortion_coefficients: found {}, expected 4, 5, 8, 12 or 14", k.size()));
  }
  camera.distortion = k.size() == 4 ? Distortion::kRadialTangential : Distortion::kOpenCv;
}

void NoteOtherKeys(const Reader& in, CameraDescription& d) {
  std::set<std::string> known = {"fisheye_model", "comment", "camera_name", "rostopic", "rate_hz"};
  for (const Keys keys : {kMatrixKeys, kTermKeys, kWidthKeys, kHeightKeys}) {
    known.insert(keys.begin(), keys.end());
  }
  std::string others;
  for (const auto& node : in.storage.root()) {
    if (!known.contains(node.name())) others += (others.empty() ? "" : ", ") + node.name();
  }
  if (!others.empty()) d.notes.push_back(others + ": of the calibration, not of the camera");
}

}  // namespace

namespace {

CameraDescription ReadOpened(const Reader& in, const CameraFileChoice& choice) {
  CameraDescription d;
  const auto problem = TakeIntrinsics(in.Matrix(kMatrixKeys), d.calibration);
  if (!problem.empty()) throw in.Error(fmt::format("camera_matrix: {}", problem));
  ReadLens(in, d.calibration);
  d.calibration.width_px = in.Whole(kWidthKeys, choice.width_px);
  d.calibration.height_px = in.Whole(kHeightKeys, choice.height_px);
  if (d.calibration.width_px == 0 || d.calibration.height_px == 0) {
    throw in.Error("does not state image_width and image_height, and no resolution was given");
  }
  d.comment = in.Text("comment");
  d.camera_name = in.Text("camera_name");
  d.rostopic = in.Text("rostopic");
  if (const auto rate = in.storage["rate_hz"]; rate.isReal() || rate.isInt()) {
    d.calibration.rate_hz = static_cast<double>(rate);
    d.has_rate = true;
    const std::string expected = ExpectedAbove(BoundsOf("rate_hz"), d.calibration.rate_hz, false);
    if (!expected.empty()) {
      throw in.Error(
          fmt::format("rate_hz: found {}, expected {}", d.calibration.rate_hz, expected));
    }
  }
  NoteOtherKeys(in, d);
  return d;
}

}  // namespace

CameraDescription ReadOpenCvCamera(const std::filesystem::path& file,
                                   const CameraFileChoice& choice) {
  const Reader in(file);
  try {
    return ReadOpened(in, choice);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception&) {
    throw in.Error("holds something else than a camera of OpenCV's");
  }
}

void WriteOpenCvCamera(const std::filesystem::path& file, const CameraDescription& d) {
  const CameraCalibration& c = d.calibration;
  const bool fisheye = c.distortion == Distortion::kEquidistant;
  const cv::Matx33d K(c.fu_px, 0, c.cu_px, 0, c.fv_px, c.cv_px, 0, 0, 1);
  const cv::Mat terms = cv::Mat(c.distortion_coefficients, true).reshape(1, 1);
  std::string text;
  try {  // in memory, its format by the file's name
    cv::FileStorage out(file.string(), cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    if (!out.isOpened()) throw WorkError(fmt::format("{}: cannot be written", file.string()));
    out << "image_width" << c.width_px << "image_height" << c.height_px;
    if (fisheye) out << "fisheye_model" << 1;
    out << "camera_matrix" << cv::Mat(K) << "distortion_coefficients" << terms;
    if (d.has_rate) out << "rate_hz" << c.rate_hz;
    if (!d.comment.empty()) out << "comment" << d.comment;
    if (!d.camera_name.empty()) out << "camera_name" << d.camera_name;
    if (!d.rostopic.empty()) out << "rostopic" << d.rostopic;
    text = out.releaseAndGetString();
  } catch (const cv::Exception&) {
    throw WorkError(fmt::format("{}: cannot be written", file.string()));
  }
  WriteTextFile(file, text);
}

}  // namespace flextip
