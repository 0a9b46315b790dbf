// Cameras in OpenCV's FileStorage, with the keys of its own calibration program
// (samples/cpp/tutorial_code/calib3d/camera_calibration).
#include <fmt/ranges.h>

#include <algorithm>
#include <initializer_list>
#include <opencv2/core.hpp>
#include <set>
#include <sstream>
#include <string_view>

#include "recording/cameras/format_parts.h"
#include "recording/text/text.h"
#include "recording/text/xml.h"

namespace flextip {
namespace {

using Keys = std::initializer_list<const char*>;
constexpr Keys kMatrixKeys = {"camera_matrix", "cameraMatrix", "Camera_Matrix"};
constexpr Keys kTermKeys = {"distortion_coefficients", "distCoeffs", "dist_coeffs",
                            "Distortion_Coefficients"};
constexpr Keys kWidthKeys = {"image_width", "image_Width"};
constexpr Keys kHeightKeys = {"image_height", "image_Height"};

/// A text as OpenCV writes it: in quotes where it has blanks, a quote of its own as an entity.
std::string ScalarOf(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  text.remove_suffix(text.size() - (text.find_last_not_of(kBlanks) + 1));
  const bool is_quoted = text.size() > 1 && text.front() == '"' && text.back() == '"';
  return ResolvedEntities(is_quoted ? text.substr(1, text.size() - 2) : text);
}

/// Adds an element's value in YAML's flow style, each at its own line, so that messages name it.
void AddFlow(const XmlElement& e, long& line, std::string& text) {
  for (; line < e.line; ++line) text += '\n';
  if (!e.children.empty()) {
    text += '{';
    for (const XmlElement& child : e.children) {
      for (; line < child.line; ++line) text += '\n';
      text += YamlText(child.name) + ": ";
      AddFlow(child, line, text);
      text += ", ";
    }
    text += '}';
  } else if (e.name == "data") {
    std::istringstream numbers(e.text);
    text += '[';
    for (std::string number; numbers >> number;) text += YamlText(number) + ", ";
    text += ']';
  } else {
    text += YamlText(ScalarOf(e.text));
  }
}

/// A storage's top mapping, of YAML, JSON (which YAML holds) or XML. OpenCV's own parsers end the
/// program by a crash where a file is damaged or deeply nested.
YamlMap StorageOf(const std::filesystem::path& file) {
  std::string text = ReadTextFile(file);
  if (Trim(text).starts_with('<')) {
    text.clear();
    long line = 1;
    AddFlow(ReadXml(file), line, text);
  } else if (const auto version = text.find("%YAML:1.0"); version < text.find("---")) {
    text[version] = '#';  // a version that only OpenCV writes so
  }
  return YamlMap::OfText(file, text);
}

/// The first of the keys that is there, the first one where none is.
std::string Named(const YamlMap& in, Keys keys) {
  const auto found =
      std::find_if(keys.begin(), keys.end(), [&](const char* key) { return in.Has(key); });
  return found == keys.end() ? *keys.begin() : *found;
}

std::vector<double> Matrix(const YamlMap& in, Keys keys) {
  const YamlMap matrix = in.Map(Named(in, keys));
  const auto rows = static_cast<double>(matrix.Integer("rows"));
  const auto cols = static_cast<double>(matrix.Integer("cols"));
  std::vector<double> values = matrix.Numbers("data");
  if (rows < 0 || cols < 0 || rows * cols != static_cast<double>(values.size())) {
    throw matrix.Error("data", fmt::format("found {} numbers, expected {} rows and {} columns",
                                           values.size(), rows, cols));
  }
  return values;
}

int Whole(const YamlMap& in, Keys keys, int fallback) {
  const std::string key = Named(in, keys);
  return in.Has(key) ? static_cast<int>(in.Integer(key)) : fallback;
}

void ReadLens(const YamlMap& in, CameraCalibration& camera) {
  const std::string key = Named(in, kTermKeys);
  auto& k = camera.distortion_coefficients = Matrix(in, kTermKeys);
  if (Whole(in, {"fisheye_model"}, 0) != 0) {
    camera.distortion = Distortion::kEquidistant;
    if (k.size() == 4) return;
    throw in.Error(key, fmt::format("found {}, expected 4 for a fisheye_model", k.size()));
  }
  if (k.empty()) k = {0, 0, 0, 0};
  if (k.size() == 14 && k[12] == 0 && k[13] == 0) k.resize(12);
  if (k.size() == 14) {
    throw in.Error(key,
                   "found a tilted sensor (the last two of 14), of which there is no counterpart");
  }
  if (!std::set<std::size_t>{4, 5, 8, 12}.contains(k.size()))
    throw in.Error(key, fmt::format("found {}, expected 4, 5, 8, 12 or 14", k.size()));
  camera.distortion = k.size() == 4 ? Distortion::kRadialTangential : Distortion::kOpenCv;
}

}  // namespace

CameraDescription ReadOpenCvCamera(const std::filesystem::path& file,
                                   const CameraFileChoice& choice) {
  const YamlMap in = StorageOf(file);
  CameraDescription d;
  const auto problem = TakeIntrinsics(Matrix(in, kMatrixKeys), d.calibration);
  if (!problem.empty()) throw in.Error(Named(in, kMatrixKeys), problem);
  ReadLens(in, d.calibration);
  d.calibration.width_px = Whole(in, kWidthKeys, choice.width_px);
  d.calibration.height_px = Whole(in, kHeightKeys, choice.height_px);
  if (d.calibration.width_px == 0 || d.calibration.height_px == 0) {
    throw in.Error("image_width",
                   "does not state image_width and image_height, and no resolution was given");
  }
  ReadLabels(in, d);
  const auto others = in.Unasked();
  if (!others.empty()) {
    d.notes.push_back(
        fmt::format("{}: of the calibration, not of the camera", fmt::join(others, ", ")));
  }
  return d;
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
