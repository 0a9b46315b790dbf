#include "python/bindings/arrays.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstring>

#include "core/error.h"

namespace flextip::python {
namespace {

std::string ShapeText(const py::array& array) {
  const std::vector<py::ssize_t> shape(array.shape(), array.shape() + array.ndim());
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

std::string TypeText(const py::array& array) { return py::str(array.dtype()); }

}  // namespace

py::array Texts(const std::vector<std::string>& texts) {
  const py::module_ numpy = py::module_::import("numpy");
  return numpy.attr("array")(texts, py::arg("dtype") = "str");
}

std::vector<TimeNs> TimesFrom(const std::string& what, const py::array& t_ns) {
  const char kind = t_ns.dtype().kind();
  if ((kind != 'i' && kind != 'u') || t_ns.ndim() != 1) {
    throw InputError(fmt::format("{}: found {} {}, expected whole nanoseconds, int64 (N,)", what,
                                 TypeText(t_ns), ShapeText(t_ns)));
  }
  const auto values = py::array_t<TimeNs, py::array::c_style | py::array::forcecast>::ensure(t_ns);
  std::vector<TimeNs> times(values.data(), values.data() + values.size());
  if (times.empty()) throw InputError(what + ": no samples, expected at least one");
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) continue;
    throw InputError(fmt::format("{}[{}]: found {} after {}, expected times that increase", what, i,
                                 times[i], times[i - 1]));
  }
  return times;
}

Rows::Rows(const std::string& what, const Doubles& array, std::size_t count, py::ssize_t width,
           py::ssize_t depth)
    : what_(what), numbers_(static_cast<std::size_t>(width * std::max<py::ssize_t>(depth, 1))) {
  std::vector<py::ssize_t> expected{static_cast<py::ssize_t>(count), width};
  if (depth > 0) expected.push_back(depth);
  if (!std::equal(expected.begin(), expected.end(), array.shape(), array.shape() + array.ndim())) {
    throw InputError(fmt::format("{}: found the shape {}, expected ({})", what, ShapeText(array),
                                 fmt::join(expected, ", ")));
  }
  values_.assign(array.data(), array.data() + array.size());
  if (!std::all_of(values_.begin(), values_.end(), [](double v) { return std::isfinite(v); })) {
    RefuseNotFinite(what);
  }
}

/// Returns false for zero. Throws InputError where the length is neither zero nor one.
bool Rows::IsUnit(std::size_t i, double length) const {
  if (length == 0.0) return false;
  if (std::abs(length - 1.0) <= 1e-3) return true;
  throw InputError(fmt::format("{}[{}]: found the length {:.6g}, expected 1", what_, i, length));
}

std::optional<Eigen::Quaterniond> Rows::Quaternion(std::size_t i) const {
  const double* q = (*this)[i];
  const Eigen::Quaterniond quaternion(q[0], q[1], q[2], q[3]);
  if (!IsUnit(i, quaternion.norm())) return {};
  return quaternion;
}

std::optional<Eigen::Vector3d> Rows::Direction(std::size_t i) const {
  if (!IsUnit(i, Vector3(i).norm())) return {};
  return Vector3(i);
}

Image ImageFrom(const py::array& array) {
  const bool bytes = array.dtype().kind() == 'u' && array.itemsize() == 1;
  const bool grey = array.ndim() == 2, colour = array.ndim() == 3 && array.shape(2) == 3;
  if (!bytes || !(grey || colour) || array.size() == 0) {
    throw InputError(fmt::format("picture: found {} {}, expected uint8 (H, W) or (H, W, 3)",
                                 TypeText(array), ShapeText(array)));
  }
  const auto values =
      py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>::ensure(array);
  Image image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)), grey ? 1 : 3);
  std::memcpy(image.data.data(), values.data(), image.data.size());
  return image;
}

py::array_t<std::uint8_t> ImageArray(const Image& image) {
  std::vector<py::ssize_t> shape{image.height_px, image.width_px};
  if (image.channels > 1) shape.push_back(image.channels);
  py::array_t<std::uint8_t> array(shape);
  std::memcpy(array.mutable_data(), image.data.data(), image.data.size());
  return array;
}

Pose PoseFrom(const std::string& what, const Eigen::Matrix4d& T) {
  RequireFinite(what, T);
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const bool rigid = (R * R.transpose()).isIdentity(1e-6) && R.determinant() > 0 &&
                     T.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-9);
  if (!rigid) throw InputError(what + ": found no rigid transform, expected one as a 4x4 matrix");
  return Pose::FromMatrix(T);
}

double Positive(const std::string& what, double value) {
  if (std::isfinite(value) && value > 0) return value;
  throw InputError(fmt::format("{}: found {:g}, expected a number above 0", what, value));
}

double NotNegative(const std::string& what, double value) {
  if (std::isfinite(value) && value >= 0) return value;
  throw InputError(fmt::format("{}: found {:g}, expected a number not below 0", what, value));
}

void RefuseNotFinite(const std::string& what) {
  throw InputError(what + ": found NaN or an infinite number, expected finite ones");
}

}  // namespace flextip::python
