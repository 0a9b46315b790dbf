// Between numpy's arrays and the libraries' series: shapes, times, strings, pictures.
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <Eigen/Dense>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"
#include "core/pose.h"
#include "core/time_series.h"

namespace flextip::python {

namespace py = pybind11;

using Paths = std::vector<std::filesystem::path>;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Returns the array (N, shape...) of the items of `range`; write(item, row) fills a row of zeros.
template <class T = double, class Range, class Write>
py::array_t<T> Table(const Range& range, const std::vector<py::ssize_t>& shape, Write write) {
  std::vector<py::ssize_t> full{static_cast<py::ssize_t>(range.size())};
  full.insert(full.end(), shape.begin(), shape.end());
  py::array_t<T> table(full);
  py::ssize_t width = 1;
  for (const py::ssize_t n : shape) width *= n;
  T* row = table.mutable_data();
  for (const auto& item : range) {
    std::fill_n(row, width, T{});
    write(item, row);
    row += width;
  }
  return table;
}

/// Returns the array (N,) of get(item).
template <class T = double, class Range, class Get>
py::array_t<T> Column(const Range& range, Get get) {
  return Table<T>(range, {}, [&](const auto& item, T* place) { *place = get(item); });
}

/// Returns the times of a series, (N,) int64 (ns).
template <class T>
py::array_t<TimeNs> Times(const Series<T>& series) {
  return Column<TimeNs>(series, [](const Sample<T>& sample) { return sample.t_ns; });
}

/// Writes a vector or matrix row by row.
template <class Derived>
void Put(const Eigen::MatrixBase<Derived>& values, double* row) {
  for (Eigen::Index r = 0; r < values.rows(); ++r) {
    for (Eigen::Index c = 0; c < values.cols(); ++c) *row++ = values(r, c);
  }
}
/// Writes w, x, y, z.
inline void PutQuaternion(const Eigen::Quaterniond& q, double* row) {
  Put(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()), row);
}

/// Returns the array (N,) of texts, which compares with a text item by item.
py::array Texts(const std::vector<std::string>& texts);
template <class Range, class Get>
py::array TextColumn(const Range& range, Get get) {
  std::vector<std::string> texts;
  texts.reserve(range.size());
  for (const auto& item : range) texts.emplace_back(get(item));
  return Texts(texts);
}

/// Returns the times in an array of whole numbers (N,). Throws InputError for other types and
/// shapes and for times that do not increase. `what` is the argument's name in messages.
std::vector<TimeNs> TimesFrom(const std::string& what, const py::array& t_ns);

/// The rows of an array (N, width), or of an array (N, width, depth).
class Rows {
 public:
  /// Throws InputError for another shape and for numbers that are not finite.
  Rows(const std::string& what, const Doubles& array, std::size_t count, py::ssize_t width,
       py::ssize_t depth = 0);

  const double* operator[](std::size_t i) const { return values_.data() + i * numbers_; }
  Eigen::Vector3d Vector3(std::size_t i) const {
    return Eigen::Map<const Eigen::Vector3d>((*this)[i]);
  }
  /// Returns the unit quaternion in row `i` (w, x, y, z); empty for a row of zeros. Throws
  /// InputError where it is off unit length by more than 1e-3.
  std::optional<Eigen::Quaterniond> Quaternion(std::size_t i) const;
  /// Returns the unit vector in row `i`, likewise.
  std::optional<Eigen::Vector3d> Direction(std::size_t i) const;

 private:
  bool IsUnit(std::size_t i, double length) const;

  std::string what_;
  std::vector<double> values_;
  std::size_t numbers_;  // in a row
};

/// Returns the picture in an array uint8 (H, W) or (H, W, 3: blue, green, red). Throws InputError
/// for other types and shapes.
Image ImageFrom(const py::array& array);
/// Returns a picture as an array uint8 (H, W) or (H, W, 3).
py::array_t<std::uint8_t> ImageArray(const Image& image);

/// Returns the pose in a 4x4 matrix. Throws InputError where that is no rigid transform.
Pose PoseFrom(const std::string& what, const Eigen::Matrix4d& T);

/// Throws InputError unless `value` is above zero, or finite and not below zero.
double Positive(const std::string& what, double value);
double NotNegative(const std::string& what, double value);
/// Throws InputError unless all values are finite.
template <class Derived>
void RequireFinite(const std::string& what, const Eigen::MatrixBase<Derived>& values);
void RefuseNotFinite(const std::string& what);
template <class Derived>
void RequireFinite(const std::string& what, const Eigen::MatrixBase<Derived>& values) {
  if (!values.allFinite()) RefuseNotFinite(what);
}

}  // namespace flextip::python
