#include "recording/text/yaml_map.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/linear_algebra.h"
#include "recording/text/bounds.h"
#include "recording/text/text.h"

namespace flextip {

struct YamlMap::Impl {
  std::string file;
  std::string prefix;  // "instrument." inside instrument
  long line = 1;
  std::map<std::string, YAML::Node> entries;
  std::map<std::string, long> lines;
  std::set<std::string> asked;

  static std::shared_ptr<Impl> Make(const std::string& file, const std::string& prefix,
                                    const YAML::Node& node);

  const YAML::Node& Node(const std::string& key) {
    asked.insert(key);
    const auto found = entries.find(key);
    if (found == entries.end()) {
      throw InputError::At(file, line, fmt::format("key \"{}{}\" is missing", prefix, key));
    }
    return found->second;
  }
  long LineOf(const std::string& key) const {
    const auto found = lines.find(key);
    return found == lines.end() ? line : found->second;
  }
  InputError Error(const std::string& key, const std::string& what) const {
    return InputError::At(file, LineOf(key), fmt::format("{}{}: {}", prefix, key, what));
  }
  InputError Unknown(const std::string& key) const {
    return InputError::At(file, LineOf(key), fmt::format("unknown key \"{}{}\"", prefix, key));
  }
  /// "found X, expected Y" at the key's line.
  InputError Unexpected(const std::string& key, const YAML::Node& found,
                        const std::string& expected) const {
    const std::string text = found.IsScalar()     ? Quoted(found.Scalar())
                             : found.IsSequence() ? fmt::format("a list of {}", found.size())
                             : found.IsMap()      ? "a mapping"
                                                  : "nothing";
    return Error(key, fmt::format("found {}, expected {}", text, expected));
  }
  Bounds BoundsOf(const std::string& key) const { return flextip::BoundsOf(prefix + key); }
  /// The finite number of `item`, a part of the key's value, within the key's bounds.
  double Number(const std::string& key, const YAML::Node& item, const char* expected) const {
    const auto value = item.IsScalar() ? ParseFinite(item.Scalar()) : std::nullopt;
    if (!value) throw Unexpected(key, item, expected);
    const std::string within = ExpectedWithin(BoundsOf(key), *value);
    if (!within.empty()) throw Unexpected(key, item, within);
    return *value;
  }
};

std::shared_ptr<YamlMap::Impl> YamlMap::Impl::Make(const std::string& file,
                                                   const std::string& prefix,
                                                   const YAML::Node& node) {
  auto impl = std::make_shared<Impl>();
  impl->file = file;
  impl->prefix = prefix;
  impl->line = std::max(0, node.Mark().line) + 1;
  if (!node.IsMap()) {
    throw InputError::At(file, impl->line,
                         prefix.empty() ? "expected a mapping of keys to values"
                                        : fmt::format("{}: expected a mapping of keys to values",
                                                      prefix.substr(0, prefix.size() - 1)));
  }
  for (const auto& entry : node) {
    const long line = std::max(0, entry.first.Mark().line) + 1;
    if (!entry.first.IsScalar()) throw InputError::At(file, line, "expected a plain key");
    const std::string key = entry.first.Scalar();
    if (!impl->entries.emplace(key, entry.second).second) {
      throw InputError::At(file, line, fmt::format("key \"{}{}\" is there twice", prefix, key));
    }
    impl->lines[key] = line;
  }
  return impl;
}

YamlMap YamlMap::Load(const std::filesystem::path& file) {
  return OfText(file, ReadTextFile(file));
}

YamlMap YamlMap::OfText(const std::filesystem::path& file, const std::string& text) {
  try {
    return YamlMap(Impl::Make(file.string(), "", YAML::Load(text)));
  } catch (const YAML::Exception& error) {
    throw InputError::At(file.string(), error.mark.is_null() ? 0 : error.mark.line + 1,
                         "is not YAML from here on, expected lines of \"key: value\"");
  }
}

bool YamlMap::Has(const std::string& key) const {
  impl_->asked.insert(key);
  return impl_->entries.contains(key);
}

std::vector<std::string> YamlMap::Keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, node] : impl_->entries) keys.push_back(key);
  return keys;
}

std::string YamlMap::Text(const std::string& key) const {
  const auto& node = impl_->Node(key);
  if (!node.IsScalar()) throw impl_->Unexpected(key, node, "a text");
  return node.Scalar();
}

std::string YamlMap::TextOr(const std::string& key, const std::string& fallback) const {
  return Has(key) && !impl_->Node(key).IsNull() ? Text(key) : fallback;
}

double YamlMap::Number(const std::string& key) const {
  return impl_->Number(key, impl_->Node(key), "a finite number");
}

double YamlMap::Positive(const std::string& key) const {
  const double value = Number(key);
  if (value <= 0) throw impl_->Unexpected(key, impl_->Node(key), "a number above 0");
  const std::string expected = ExpectedAbove(impl_->BoundsOf(key), value, false);
  if (!expected.empty()) throw impl_->Unexpected(key, impl_->Node(key), expected);
  return value;
}

double YamlMap::NonNegative(const std::string& key) const {
  const double value = Number(key);
  if (value < 0) throw impl_->Unexpected(key, impl_->Node(key), "a number not below 0");
  const std::string expected = ExpectedAbove(impl_->BoundsOf(key), value, true);
  if (!expected.empty()) throw impl_->Unexpected(key, impl_->Node(key), expected);
  return value;
}

double YamlMap::NumberOr(const std::string& key, double fallback) const {
  return Has(key) ? Number(key) : fallback;
}

double YamlMap::PositiveOr(const std::string& key, double fallback) const {
  return Has(key) ? Positive(key) : fallback;
}

double YamlMap::NonNegativeOr(const std::string& key, double fallback) const {
  return Has(key) ? NonNegative(key) : fallback;
}

std::int64_t YamlMap::Integer(const std::string& key) const {
  const auto& node = impl_->Node(key);
  const auto value = node.IsScalar() ? ParseInteger(node.Scalar()) : std::nullopt;
  if (!value) throw impl_->Unexpected(key, node, "an integer");
  if (const auto bounds = KnownBoundsOf(impl_->prefix + key)) {
    const std::string within = ExpectedWithin(*bounds, static_cast<double>(*value));
    if (!within.empty()) throw impl_->Unexpected(key, node, within);
  }
  return *value;
}

bool YamlMap::IsList(const std::string& key) const { return impl_->Node(key).IsSequence(); }

bool YamlMap::IsText(const std::string& key) const { return impl_->Node(key).IsScalar(); }

std::vector<double> YamlMap::Numbers(const std::string& key) const {
  const auto& node = impl_->Node(key);
  if (!node.IsSequence()) throw impl_->Unexpected(key, node, "a list of numbers");
  std::vector<double> values;
  for (const auto& item : node) {
    values.push_back(impl_->Number(key, item, "a finite number in the list"));
  }
  return values;
}

std::vector<double> YamlMap::Numbers(const std::string& key, std::size_t count) const {
  auto values = Numbers(key);
  if (values.size() != count) {
    throw impl_->Unexpected(key, impl_->Node(key), fmt::format("{} numbers", count));
  }
  return values;
}

std::vector<std::string> YamlMap::Texts(const std::string& key) const {
  const auto& node = impl_->Node(key);
  if (!node.IsSequence()) throw impl_->Unexpected(key, node, "a list of texts");
  std::vector<std::string> values;
  for (const auto& item : node) {
    if (!item.IsScalar()) throw impl_->Unexpected(key, item, "a text in the list");
    values.push_back(item.Scalar());
  }
  return values;
}

Eigen::Vector3d YamlMap::Vector3(const std::string& key) const {
  const auto values = Numbers(key, 3);
  return {values[0], values[1], values[2]};
}

YamlMap YamlMap::Map(const std::string& key) const {
  const auto& node = impl_->Node(key);
  if (!node.IsMap()) throw impl_->Unexpected(key, node, "a mapping");
  return YamlMap(Impl::Make(impl_->file, impl_->prefix + key + ".", node));
}

std::vector<YamlMap> YamlMap::Maps(const std::string& key) const {
  const auto& node = impl_->Node(key);
  if (!node.IsSequence()) throw impl_->Unexpected(key, node, "a list of mappings");
  std::vector<YamlMap> maps;
  for (const auto& item : node) {
    const std::string prefix = fmt::format("{}{}[{}].", impl_->prefix, key, maps.size());
    maps.push_back(YamlMap(Impl::Make(impl_->file, prefix, item)));
  }
  return maps;
}

namespace {

// The pose of a 4x4 matrix, row by row; `error` makes an error of what is wrong with it.
template <class MakeError>
Pose RigidPose(const std::vector<double>& data, const MakeError& error) {
  const Eigen::Matrix4d T =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(&data[0]);
  if (T.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw error("expected 0, 0, 0, 1 as the last row");
  }
  Pose pose = Pose::FromMatrix(T);
  const double off =
      (pose.R.transpose() * pose.R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (off > 1e-3 || pose.R.determinant() < 0) {
    throw error(
        fmt::format("R'R is off the identity by {:.3g} and det R is {:.3g}, "
                    "expected a rotation (1e-3, 1)",
                    off, pose.R.determinant()));
  }
  if (off > 1e-12) {
    const Svd svd(pose.R);
    pose.R = svd.U * svd.V.transpose();
  }
  return pose;
}

}  // namespace

Pose YamlMap::Transform(const std::string& key) const {
  const YamlMap matrix = Map(key);
  if (matrix.Integer("rows") != 4 || matrix.Integer("cols") != 4) {
    throw matrix.Error("rows", "expected 4 rows and 4 cols");
  }
  return RigidPose(matrix.Numbers("data", 16),
                   [&](const std::string& what) { return matrix.Error("data", what); });
}

Pose YamlMap::TransformRows(const std::string& key) const {
  const auto& node = impl_->Node(key);
  std::vector<double> data;
  for (const auto& row : node) {
    if (!node.IsSequence() || !row.IsSequence() || row.size() != 4) break;
    for (const auto& item : row) {
      data.push_back(impl_->Number(key, item, "four lists of four finite numbers"));
    }
  }
  if (node.size() != 4 || data.size() != 16) {
    throw impl_->Unexpected(key, node, "four lists of four finite numbers");
  }
  return RigidPose(data, [&](const std::string& what) { return Error(key, what); });
}

std::vector<std::string> YamlMap::Unasked() const {
  std::vector<std::string> keys;
  for (const auto& [key, line] : impl_->lines) {
    if (!impl_->asked.contains(key)) keys.push_back(key);
  }
  return keys;
}

InputError YamlMap::Error(const std::string& key, const std::string& what) const {
  return impl_->Error(key, what);
}

void YamlMap::WarnUnknown(ReadLog& log) const {
  for (const auto& key : Unasked())
    log.warnings.push_back(impl_->Unknown(key).what() + std::string(" ignored"));
}

void YamlMap::RefuseUnknown() const {
  if (const auto unasked = Unasked(); !unasked.empty()) throw impl_->Unknown(unasked.front());
}

std::string YamlText(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      quoted += fmt::format("\\x{:02x}", static_cast<int>(c));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string YamlNumber(double value) {
  if (!std::isfinite(value)) throw WorkError("a setting to be written is NaN or infinite");
  return NumberText(value);
}

std::string YamlNumbers(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + YamlNumber(value);
  return text + "]";
}

std::string YamlTransform(const Pose& T) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> m = T.Matrix();
  return fmt::format("{{rows: 4, cols: 4, data: {}}}",
                     YamlNumbers(std::vector<double>(m.data(), m.data() + 16)));
}

}  // namespace flextip
