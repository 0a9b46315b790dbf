#include "recording/calibrations/file.h"

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "recording/cameras/yaml.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip {
namespace {

constexpr const char* kFormat = "flextip-calibration";
constexpr int kVersion = 1;
constexpr double kLeastEigenvalue = -1e-9;  // of the greatest

std::string Joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : ", ") + YamlText(text);
  return all;
}

std::string CovarianceText(const Calibration& c) {
  if (c.covariance.size() == 0) return "";
  std::vector<double> data;
  for (Eigen::Index i = 0; i < c.covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < c.covariance.cols(); ++j) data.push_back(c.covariance(i, j));
  }
  return fmt::format("covariance:\n  parameters: [{}]\n  data: {}\n", Joined(c.CoordinateNames()),
                     YamlNumbers(data));
}

Eigen::MatrixXd ReadCovariance(const YamlMap& map, const std::vector<std::string>& expected) {
  const auto names = map.Texts("parameters");
  if (names != expected) {
    throw map.Error("parameters",
                    fmt::format("found [{}], expected [{}]", Joined(names), Joined(expected)));
  }
  const auto n = static_cast<Eigen::Index>(names.size());
  const std::vector<double> data = map.Numbers("data", names.size() * names.size());
  const Eigen::MatrixXd C =
      Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(data.data(), n, n);
  const Eigen::VectorXd scale = C.diagonal().cwiseMax(0).cwiseSqrt();
  if ((C.diagonal().array() < 0).any()) throw map.Error("data", "found a negative variance");
  const double asymmetry = (C - C.transpose()).cwiseAbs().maxCoeff();
  if (asymmetry > 1e-9 * C.cwiseAbs().maxCoeff()) throw map.Error("data", "not symmetric");
  const Eigen::VectorXd inverse = scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
  const Eigen::MatrixXd correlation = inverse.asDiagonal() * C * inverse.asDiagonal();
  if (n > 0 && SymmetricEigenvalues(correlation)[0] < kLeastEigenvalue * static_cast<double>(n)) {
    throw map.Error("data", "no covariance: an eigenvalue is negative");
  }
  return C;
}

/// Such a name is written as it is.
bool IsPlain(const std::string& name) {
  return std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return c < 0x80 && (std::isalnum(c) != 0 || c == '_' || c == '.' || c == '-');
  });
}

void RejectUnknown(const YamlMap& map) {
  const auto unknown = map.Unasked();
  if (!unknown.empty()) throw map.Error(unknown.front(), "unknown key");
}

}  // namespace

std::vector<std::string> Calibration::CoordinateNames() const {
  std::vector<std::string> names;
  for (const auto& [name, pose] : poses) {
    for (const char* part : {"w", "p"}) {
      for (int i = 0; i < 3; ++i) names.push_back(fmt::format("{}.{}[{}]", name, part, i));
    }
  }
  for (const auto& [name, values] : numbers) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      names.push_back(values.size() == 1 ? name : fmt::format("{}[{}]", name, i));
    }
  }
  return names;
}

Calibration::Range Calibration::RangeOf(const std::string& name) const {
  int first = 0;
  for (const auto& entry : poses) {
    if (entry.first == name) return {first, 6};
    first += 6;
  }
  for (const auto& [other, values] : numbers) {
    const int count = static_cast<int>(values.size());
    if (other == name) return {first, count};
    first += count;
  }
  throw InputError(fmt::format("the calibration has no '{}'", name));
}

Eigen::MatrixXd Calibration::CovarianceOf(const std::string& name) const {
  const Range range = RangeOf(name);
  if (covariance.size() == 0) return {};
  return covariance.block(range.first, range.first, range.count, range.count);
}

void AddLens(const std::string& camera, const CameraCalibration& lens, Calibration& c) {
  c.numbers[camera + ".intrinsics"] = {lens.fu_px, lens.fv_px, lens.cu_px, lens.cv_px};
  c.texts[camera + ".distortion_model"] = DistortionName(lens.distortion);
  c.numbers[camera + ".distortion_coefficients"] = lens.distortion_coefficients;
}

Calibration ReadCalibration(const std::filesystem::path& file) {
  const auto yaml = YamlMap::Load(file);
  if (yaml.Text("format") != kFormat) {
    throw yaml.Error("format",
                     fmt::format("found '{}', expected '{}'", yaml.Text("format"), kFormat));
  }
  if (yaml.Integer("version") != kVersion) {
    throw yaml.Error("version",
                     fmt::format("found {}, expected {}", yaml.Integer("version"), kVersion));
  }
  Calibration calibration;
  calibration.kind = yaml.Text("kind");
  const YamlMap found = yaml.Map("found");
  for (const std::string& name : found.Keys()) {
    if (!IsPlain(name)) throw found.Error(name, "expected a name of letters, digits, _, . and -");
    if (name.find(".T_") != std::string::npos) {
      calibration.poses[name] = found.Transform(name);
    } else if (name.ends_with("_model")) {
      calibration.texts[name] = found.Text(name);
    } else if (found.IsList(name)) {
      calibration.numbers[name] = found.Numbers(name);
    } else {
      calibration.numbers[name] = {found.Number(name)};
    }
  }
  if (yaml.Has("covariance")) {
    const YamlMap covariance = yaml.Map("covariance");
    calibration.covariance = ReadCovariance(covariance, calibration.CoordinateNames());
    RejectUnknown(covariance);
  }
  if (yaml.Has("unobservable")) {
    for (const YamlMap& one : yaml.Maps("unobservable")) {
      calibration.unobservable.push_back({one.Text("parameter"), one.Text("reason")});
      RejectUnknown(one);
    }
  }
  RejectUnknown(yaml);
  return calibration;
}

void WriteCalibration(const std::filesystem::path& file, const Calibration& c) {
  std::string text =
      fmt::format("format: {}\nversion: {}\nkind: {}\n", kFormat, kVersion, YamlText(c.kind));
  text += c.poses.empty() && c.numbers.empty() && c.texts.empty() ? "found: {}\n" : "found:\n";
  for (const auto& [name, pose] : c.poses) {
    text += fmt::format("  {}: {}\n", name, YamlTransform(pose));
  }
  for (const auto& [name, values] : c.numbers) {
    text += fmt::format("  {}: {}\n", name,
                        values.size() == 1 ? YamlNumber(values[0]) : YamlNumbers(values));
  }
  for (const auto& [name, value] : c.texts) {
    text += fmt::format("  {}: {}\n", name, YamlText(value));
  }
  text += CovarianceText(c);
  if (!c.unobservable.empty()) text += "unobservable:\n";
  for (const auto& [parameter, reason] : c.unobservable) {
    text +=
        fmt::format("  - {{parameter: {}, reason: {}}}\n", YamlText(parameter), YamlText(reason));
  }
  WriteTextFile(file, text);
}

}  // namespace flextip
