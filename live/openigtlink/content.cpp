#include "live/openigtlink/content.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <igtl_image.h>
#include <igtl_position.h>
#include <igtl_qtdata.h>
#include <igtl_sensor.h>
#include <igtl_string.h>
#include <igtl_tdata.h>
#include <igtl_transform.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

namespace flextip::live {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr double kMillimetre = 1e-3;
constexpr double kRotationTolerance = 1e-3;
constexpr std::size_t kStatusHead = 30;  // code, subcode, error's name

std::uint64_t Unsigned(Bytes bytes, std::size_t at, std::size_t width) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < width; ++i) value = value << 8 | bytes[at + i];
  return value;
}

std::string Text(const char* text, std::size_t most) { return {text, ::strnlen(text, most)}; }

template <class T>
T Copy(Bytes bytes, std::size_t at = 0) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

template <std::size_t N>
bool AllFinite(const float (&values)[N]) {
  return std::all_of(values, values + N, [](float v) { return std::isfinite(v); });
}

Eigen::Vector3d Metres(const float* p_mm) {
  return kMillimetre * Eigen::Vector3d(p_mm[0], p_mm[1], p_mm[2]);
}

void Add(ContentSink& sink, const std::string& device, const Pose& T, bool has_orientation) {
  sink.messages.push_back({device, sink.t_ns, WireTransform{T, has_orientation}});
}

void Refuse(ContentSink& sink, const std::string& device, const std::string& why) {
  sink.refused.push_back({device, why});
}

/// The rotation next to three columns, where they are nearly one.
std::optional<Eigen::Matrix3d> RotationOf(const float (&columns)[12]) {
  Eigen::Matrix3d R;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) R(row, column) = columns[3 * column + row];
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off < kRotationTolerance) || R.determinant() < 0.0) return {};
  return Eigen::Quaterniond(R).normalized().toRotationMatrix();
}

/// Adds the pose of `values` (three columns of the rotation, the position in mm).
void AddMatrix(ContentSink& sink, const std::string& device, const float (&values)[12],
               bool full_orientation) {
  if (!AllFinite(values)) {
    Refuse(sink, device, fmt::format("found {}, expected finite numbers", fmt::join(values, " ")));
    return;
  }
  const auto R = RotationOf(values);
  if (!R && full_orientation) {
    Refuse(sink, device,
           fmt::format("found the columns {:.6g}, expected a rotation",
                       fmt::join(values, values + 9, " ")));
    return;
  }
  Add(sink, device, {R.value_or(Eigen::Matrix3d::Identity()), Metres(values + 9)},
      full_orientation);
}

/// Adds the pose of a position (mm) and a quaternion (x, y, z, w).
void AddQuaternion(ContentSink& sink, const std::string& device, const float (&position)[3],
                   const float (&q)[4], bool full_orientation) {
  if (!AllFinite(position) || !AllFinite(q)) {
    Refuse(sink, device,
           fmt::format("found {} and {}, expected finite numbers", fmt::join(position, " "),
                       fmt::join(q, " ")));
    return;
  }
  const Eigen::Quaterniond quaternion(q[3], q[0], q[1], q[2]);
  const bool unit = std::abs(quaternion.norm() - 1.0) < kRotationTolerance;
  if (!unit && full_orientation) {
    Refuse(sink, device,
           fmt::format("found the quaternion {:.6g}, expected a unit one", fmt::join(q, " ")));
    return;
  }
  const Eigen::Quaterniond known = unit ? quaternion : Eigen::Quaterniond::Identity();
  Add(sink, device, Pose::FromQuaternion(known, Metres(position)), full_orientation);
}

void AddNumbers(ContentSink& sink, std::vector<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    Refuse(sink, "",
           fmt::format("found {} as number {} of {}, expected finite ones", values[i], i + 1,
                       values.size()));
    return;
  }
  sink.messages.push_back({sink.device, sink.t_ns, WireNumbers{std::move(values)}});
}

void ReadTransform(Bytes content, ContentSink& sink) {
  float values[12];
  std::memcpy(values, content.data(), sizeof values);
  igtl_transform_convert_byte_order(values);
  AddMatrix(sink, sink.device, values, true);
}

void ReadPosition(Bytes content, ContentSink& sink) {
  igtl_position read{};
  std::memcpy(&read, content.data(), content.size());
  if (content.size() == IGTL_POSITION_MESSAGE_POSITON_ONLY_SIZE) {
    igtl_position_convert_byte_order_position_only(&read);
  } else if (content.size() == IGTL_POSITION_MESSAGE_WITH_QUATERNION3_SIZE) {
    igtl_position_convert_byte_order_quaternion3(&read);
  } else {
    igtl_position_convert_byte_order(&read);
  }
  float position[3], q[4];
  std::memcpy(position, read.position, sizeof position);
  std::memcpy(q, read.quaternion, sizeof q);
  const bool whole = content.size() == IGTL_POSITION_MESSAGE_DEFAULT_SIZE;
  if (content.size() == IGTL_POSITION_MESSAGE_WITH_QUATERNION3_SIZE) {
    // A unit quaternion of which the scalar part, not negative, is left out.
    const float squares = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    q[3] = std::sqrt(std::max(0.0f, 1.0f - squares));
    AddQuaternion(sink, sink.device, position, q, true);
  } else {
    AddQuaternion(sink, sink.device, position, q, whole);
  }
}

bool HasFullOrientation(int tool_type) {
  return tool_type != IGTL_TDATA_TYPE_3D && tool_type != IGTL_TDATA_TYPE_5D;
}

void ReadTdata(Bytes content, ContentSink& sink) {
  for (std::size_t at = 0; at < content.size(); at += IGTL_TDATA_ELEMENT_SIZE) {
    auto tool = Copy<igtl_tdata_element>(content, at);
    igtl_tdata_convert_byte_order(&tool, 1);
    float values[12];
    std::memcpy(values, tool.transform, sizeof values);
    AddMatrix(sink, Text(tool.name, IGTL_TDATA_LEN_NAME), values, HasFullOrientation(tool.type));
  }
}

void ReadQtdata(Bytes content, ContentSink& sink) {
  for (std::size_t at = 0; at < content.size(); at += IGTL_QTDATA_ELEMENT_SIZE) {
    auto tool = Copy<igtl_qtdata_element>(content, at);
    igtl_qtdata_convert_byte_order(&tool, 1);
    float position[3], q[4];
    std::memcpy(position, tool.position, sizeof position);
    std::memcpy(q, tool.quaternion, sizeof q);
    AddQuaternion(sink, Text(tool.name, IGTL_QTDATA_LEN_NAME), position, q,
                  HasFullOrientation(tool.type));
  }
}

/// Reads a number of OpenIGTLink's scalar types at `at`.
double Scalar(Bytes bytes, std::size_t at, int type) {
  switch (type) {
    case IGTL_SCALAR_INT8:
      return static_cast<std::int8_t>(bytes[at]);
    case IGTL_SCALAR_UINT8:
      return bytes[at];
    case IGTL_SCALAR_INT16:
      return static_cast<std::int16_t>(Unsigned(bytes, at, 2));
    case IGTL_SCALAR_UINT16:
      return static_cast<double>(Unsigned(bytes, at, 2));
    case IGTL_SCALAR_INT32:
      return static_cast<std::int32_t>(Unsigned(bytes, at, 4));
    case IGTL_SCALAR_UINT32:
      return static_cast<double>(Unsigned(bytes, at, 4));
    case IGTL_SCALAR_FLOAT32:
      return std::bit_cast<float>(static_cast<std::uint32_t>(Unsigned(bytes, at, 4)));
    default:
      return std::bit_cast<double>(Unsigned(bytes, at, 8));
  }
}

/// The size of a scalar type in bytes; 0 for those that are no real numbers.
std::size_t ScalarSize(int type) {
  switch (type) {
    case IGTL_SCALAR_INT8:
    case IGTL_SCALAR_UINT8:
      return 1;
    case IGTL_SCALAR_INT16:
    case IGTL_SCALAR_UINT16:
      return 2;
    case IGTL_SCALAR_INT32:
    case IGTL_SCALAR_UINT32:
    case IGTL_SCALAR_FLOAT32:
      return 4;
    case IGTL_SCALAR_FLOAT64:
      return 8;
    default:
      return 0;
  }
}

bool NdarrayFits(Bytes content) {
  if (content.size() < 2) return false;
  const std::size_t scalar = ScalarSize(content[0]), head = 2 + 2 * std::size_t{content[1]};
  if (scalar == 0 || content[1] == 0 || content.size() < head) return false;
  std::uint64_t count = 1;
  for (std::size_t at = 2; at < head; at += 2) {
    count *= Unsigned(content, at, 2);
    if (count > content.size()) return false;
  }
  return content.size() - head == count * scalar;
}

void ReadNdarray(Bytes content, ContentSink& sink) {
  const int type = content[0];
  const std::size_t head = 2 + 2 * std::size_t{content[1]}, scalar = ScalarSize(type);
  std::vector<double> values;
  values.reserve((content.size() - head) / scalar);
  for (std::size_t at = head; at < content.size(); at += scalar)
    values.push_back(Scalar(content, at, type));
  AddNumbers(sink, std::move(values));
}

void ReadSensor(Bytes content, ContentSink& sink) {
  std::vector<double> values;
  for (std::size_t at = IGTL_SENSOR_HEADER_SIZE; at < content.size(); at += 8)
    values.push_back(Scalar(content, at, IGTL_SCALAR_FLOAT64));
  AddNumbers(sink, std::move(values));
}

void ReadString(Bytes content, ContentSink& sink) {
  const char* text = reinterpret_cast<const char*>(content.data()) + IGTL_STRING_HEADER_SIZE;
  sink.messages.push_back(
      {sink.device, sink.t_ns, WireText{Text(text, content.size() - IGTL_STRING_HEADER_SIZE)}});
}

void ReadStatus(Bytes content, ContentSink& sink) {
  const auto* text = reinterpret_cast<const char*>(content.data());
  std::string line = fmt::format("STATUS {} {}", Unsigned(content, 0, 2),
                                 static_cast<std::int64_t>(Unsigned(content, 2, 8)));
  for (const std::string& part :
       {Text(text + 10, 20), Text(text + kStatusHead, content.size() - kStatusHead)}) {
    if (!part.empty()) line += " " + part;
  }
  sink.messages.push_back({sink.device, sink.t_ns, WireText{std::move(line)}});
}

/// One slice of 8-bit pixels, whole.
bool ImageFits(Bytes content) {
  if (content.size() < IGTL_IMAGE_HEADER_SIZE) return false;
  auto header = Copy<igtl_image_header>(content);
  igtl_image_convert_byte_order(&header);
  const std::uint64_t width = header.size[0], height = header.size[1];
  const bool whole = header.subvol_size[0] == width && header.subvol_size[1] == height &&
                     header.subvol_size[2] == 1 && header.subvol_offset[0] == 0 &&
                     header.subvol_offset[1] == 0 && header.subvol_offset[2] == 0;
  const bool bytes = header.scalar_type == IGTL_IMAGE_STYPE_TYPE_UINT8 &&
                     (header.num_components == 1 || header.num_components == 3);
  return whole && bytes && header.size[2] == 1 && width > 0 && height > 0 &&
         content.size() - IGTL_IMAGE_HEADER_SIZE == width * height * header.num_components;
}

void ReadImage(Bytes content, ContentSink& sink) {
  auto header = Copy<igtl_image_header>(content);
  igtl_image_convert_byte_order(&header);
  Image image(header.size[0], header.size[1], header.num_components);
  std::memcpy(image.data.data(), content.data() + IGTL_IMAGE_HEADER_SIZE, image.data.size());
  sink.messages.push_back({sink.device, sink.t_ns, WireImage{std::move(image)}});
}

struct Type {
  std::string_view name;
  bool (*fits)(Bytes);
  void (*read)(Bytes, ContentSink&);
};

constexpr Type kTypes[] = {
    {"TRANSFORM", [](Bytes c) { return c.size() == IGTL_TRANSFORM_SIZE; }, ReadTransform},
    {"POSITION",
     [](Bytes c) {
       return c.size() == IGTL_POSITION_MESSAGE_DEFAULT_SIZE ||
              c.size() == IGTL_POSITION_MESSAGE_WITH_QUATERNION3_SIZE ||
              c.size() == IGTL_POSITION_MESSAGE_POSITON_ONLY_SIZE;
     },
     ReadPosition},
    {"TDATA", [](Bytes c) { return c.size() % IGTL_TDATA_ELEMENT_SIZE == 0; }, ReadTdata},
    {"QTDATA", [](Bytes c) { return c.size() % IGTL_QTDATA_ELEMENT_SIZE == 0; }, ReadQtdata},
    {"NDARRAY", NdarrayFits, ReadNdarray},
    {"SENSOR",
     [](Bytes c) {
       return c.size() >= IGTL_SENSOR_HEADER_SIZE &&
              c.size() == IGTL_SENSOR_HEADER_SIZE + 8 * std::size_t{c[0]};
     },
     ReadSensor},
    {"STRING",
     [](Bytes c) {
       return c.size() >= IGTL_STRING_HEADER_SIZE &&
              c.size() == IGTL_STRING_HEADER_SIZE + Unsigned(c, 2, 2);
     },
     ReadString},
    {"STATUS", [](Bytes c) { return c.size() >= kStatusHead; }, ReadStatus},
    {"IMAGE", ImageFits, ReadImage},
};

const Type* Find(std::string_view name) {
  const auto* const type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                        [&](const Type& t) { return t.name == name; });
  return type == std::end(kTypes) ? nullptr : type;
}

}  // namespace

bool IsKnownType(std::string_view type) { return Find(type) != nullptr; }

bool ContentFits(std::string_view type, Bytes content) {
  const Type* const known = Find(type);
  return known != nullptr && known->fits(content);
}

void ReadContent(std::string_view type, Bytes content, ContentSink& sink) {
  Find(type)->read(content, sink);
}

}  // namespace flextip::live
