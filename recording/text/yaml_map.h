// A YAML mapping read strictly: every error names file, line, key, what was found and expected.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/pose.h"
#include "recording/read_log.h"

namespace flextip {

/// One mapping of a YAML file. Every function that takes a key throws InputError where the key is
/// missing (the ...Or functions take a fallback instead), its value is of another kind, or a number
/// is beyond the bounds of its unit (bounds.h).
class YamlMap {
 public:
  /// The file's top mapping. Throws InputError for an unreadable file or broken YAML.
  static YamlMap Load(const std::filesystem::path& file);
  /// The same of a text; messages name `file` and the text's lines.
  static YamlMap OfText(const std::filesystem::path& file, const std::string& text);

  bool Has(const std::string& key) const;
  std::vector<std::string> Keys() const;

  std::string Text(const std::string& key) const;
  std::string TextOr(const std::string& key, const std::string& fallback) const;

  double Number(const std::string& key) const;       ///< finite
  double Positive(const std::string& key) const;     ///< finite, > 0
  double NonNegative(const std::string& key) const;  ///< finite, >= 0
  double NumberOr(const std::string& key, double fallback) const;
  double PositiveOr(const std::string& key, double fallback) const;
  double NonNegativeOr(const std::string& key, double fallback) const;
  std::int64_t Integer(const std::string& key) const;

  bool IsList(const std::string& key) const;
  bool IsText(const std::string& key) const;                  ///< a single word or number
  std::vector<double> Numbers(const std::string& key) const;  ///< a list of finite numbers
  std::vector<double> Numbers(const std::string& key, std::size_t count) const;
  std::vector<std::string> Texts(const std::string& key) const;  ///< a list
  Eigen::Vector3d Vector3(const std::string& key) const;

  YamlMap Map(const std::string& key) const;
  std::vector<YamlMap> Maps(const std::string& key) const;  ///< a list of mappings

  /// A rigid transform as {rows: 4, cols: 4, data: [16, row by row]}. Its rotation must be
  /// orthonormal within 1e-3; where it is not to 1e-12 (printed with few digits), the nearest
  /// rotation is taken.
  Pose Transform(const std::string& key) const;
  /// The same as a list of four lists of four.
  Pose TransformRows(const std::string& key) const;

  /// An error at the line of `key`, or of the mapping where there is no such key.
  InputError Error(const std::string& key, const std::string& what) const;

  /// Every key that nothing above has asked for, in alphabetical order.
  std::vector<std::string> Unasked() const;

  /// Warns of every key that nothing above has asked for.
  void WarnUnknown(ReadLog& log) const;
  /// Throws InputError with file and line for the first such key: a misspelt one must not pass.
  void RefuseUnknown() const;

 private:
  struct Impl;  // keeps yaml-cpp out of this header
  explicit YamlMap(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<Impl> impl_;
};

/// `text` as a YAML scalar in double quotes.
std::string YamlText(const std::string& text);
/// "[1, 2.5]", every number exact. Throws WorkError for NaN and infinities.
std::string YamlNumbers(const std::vector<double>& values);
std::string YamlNumber(double value);
/// "{rows: 4, cols: 4, data: [...]}".
std::string YamlTransform(const Pose& T);

}  // namespace flextip
