// The state of an object as one line of text, from which it goes on exactly where it was.
#pragma once

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>

#include "core/error.h"
#include "core/pose.h"

namespace flextip {

/// Writes values one after another, or reads them back in the same order: a class has one function
/// `VisitState(StateText&)` for both. Numbers read back bit for bit.
class StateText {
 public:
  StateText() = default;                                                            ///< to write
  explicit StateText(std::string text) : reading_(true), text_(std::move(text)) {}  ///< to read

  bool Reading() const { return reading_; }
  const std::string& Text() const { return text_; }

  /// Visits a value. Throws InputError where the text does not go on with such a value.
  void operator()(double& value) { Number(value); }
  void operator()(std::int64_t& value) { Number(value); }
  void operator()(int& value) { Number(value); }
  void operator()(bool& value) {
    int number = value ? 1 : 0;
    Number(number);
    value = number != 0;
  }
  template <typename T>
  requires std::is_enum_v<T> || std::is_unsigned_v<T>
  void operator()(T& value) {
    auto number = static_cast<std::int64_t>(value);
    (*this)(number);
    value = static_cast<T>(number);
  }
  template <int kRows, int kColumns>
  void operator()(Eigen::Matrix<double, kRows, kColumns>& matrix) {
    for (double& value : matrix.reshaped()) (*this)(value);
  }
  template <typename T, std::size_t kSize>
  void operator()(std::array<T, kSize>& values) {
    for (T& value : values) (*this)(value);
  }
  void operator()(Pose& pose) {
    (*this)(pose.R);
    (*this)(pose.p);
  }
  template <typename T>
  requires requires(T& object, StateText& state) { object.VisitState(state); }
  void operator()(T& object) { object.VisitState(*this); }
  /// A type without such a function may have a free one, `VisitState(T&, StateText&)`.
  template <typename T>
  requires requires(T& object, StateText& state) { VisitState(object, state); }
  void operator()(T& object) { VisitState(object, *this); }
  template <typename T>
  void operator()(std::optional<T>& value) {
    if (IsThere(value.has_value())) {
      if (!value) value.emplace(T{});
      (*this)(*value);
    } else {
      value.reset();
    }
  }
  /// Writes `there`, or reads whether an object follows.
  bool IsThere(bool there) {
    (*this)(there);
    return there;
  }
  /// Ends after the last value. Throws InputError where more text follows.
  void Finish() const {
    if (!reading_ || at_ == text_.size()) return;
    throw InputError("saved state: more than expected; it may be of other options");
  }

 private:
  template <typename T>
  void Number(T& value) {
    if (!reading_) {
      text_ += fmt::format("{} ", value);
      return;
    }
    const std::size_t end = std::min(text_.find(' ', at_), text_.size());
    const char* first = text_.data() + at_;
    const char* last = text_.data() + end;
    const auto result = std::from_chars(first, last, value);
    if (result.ec != std::errc() || result.ptr != last) {
      throw InputError(fmt::format("saved state: found \"{}\", expected a number",
                                   text_.substr(at_, end - at_)));
    }
    at_ = std::min(end + 1, text_.size());
  }

  bool reading_ = false;
  std::string text_;
  std::size_t at_ = 0;
};

}  // namespace flextip
