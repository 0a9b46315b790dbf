#include "exports/mcap/messages.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "exports/text_files.h"
#include "report/report.h"

namespace flextip::exports {
namespace {

using Json = nlohmann::json;

constexpr TimeNs kSecond_ns = 1'000'000'000;

// Parts of schemas.
Json Object(const std::string& title, const Json& properties) {
  return {{"type", "object"}, {"title", title}, {"properties", properties}};
}
Json Number() { return {{"type", "number"}}; }
Json Integer() { return {{"type", "integer"}}; }
Json Text() { return {{"type", "string"}}; }
Json List(const Json& items) { return {{"type", "array"}, {"items", items}}; }
Json TimeType() {
  return Object("time", {{"sec", {{"type", "integer"}, {"minimum", 0}}},
                         {"nsec", {{"type", "integer"}, {"minimum", 0}, {"maximum", 999999999}}}});
}
Json Vector3Type() {
  return Object("foxglove.Vector3", {{"x", Number()}, {"y", Number()}, {"z", Number()}});
}
Json QuaternionType() {
  return Object("foxglove.Quaternion",
                {{"x", Number()}, {"y", Number()}, {"z", Number()}, {"w", Number()}});
}
Json PoseType() {
  return Object("foxglove.Pose", {{"position", Vector3Type()}, {"orientation", QuaternionType()}});
}
Json Point2Type() { return Object("foxglove.Point2", {{"x", Number()}, {"y", Number()}}); }
Json ColorType() {
  return Object("foxglove.Color",
                {{"r", Number()}, {"g", Number()}, {"b", Number()}, {"a", Number()}});
}

MessageSchema Named(const std::string& name, const Json& properties) {
  return {name, Object(name, properties).dump()};
}

// Values.
Json TimeOf(TimeNs t_ns) { return {{"sec", t_ns / kSecond_ns}, {"nsec", t_ns % kSecond_ns}}; }
Json Of(const Eigen::Vector3d& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }
Json Of(const Eigen::Vector2d& v) { return {{"x", v.x()}, {"y", v.y()}}; }
Json Of(const Eigen::Quaterniond& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}
Json Of(const TimedPose& pose) { return {{"position", Of(pose.p)}, {"orientation", Of(pose.q)}}; }
Json Color(double r, double g, double b, double a) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", a}};
}

/// A column whose cells are numbers, or empty.
bool IsNumeric(const TimedTable& table, std::size_t column) {
  const auto& numbers = table.cells.numbers[column];
  const auto& texts = table.cells.texts[column];
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (!texts[i].empty() && std::isnan(numbers[i])) return false;
  }
  return true;
}

}  // namespace

const MessageSchema& PoseSchema() {
  static const auto schema =
      Named("foxglove.PoseInFrame",
            {{"timestamp", TimeType()}, {"frame_id", Text()}, {"pose", PoseType()}});
  return schema;
}

const MessageSchema& PathSchema() {
  static const auto schema =
      Named("foxglove.PosesInFrame",
            {{"timestamp", TimeType()}, {"frame_id", Text()}, {"poses", List(PoseType())}});
  return schema;
}

const MessageSchema& ImageSchema() {
  static const auto schema = Named("foxglove.CompressedImage",
                                   {{"timestamp", TimeType()},
                                    {"frame_id", Text()},
                                    {"data", {{"type", "string"}, {"contentEncoding", "base64"}}},
                                    {"format", Text()}});
  return schema;
}

const MessageSchema& AnnotationsSchema() {
  static const auto schema = Named(
      "foxglove.ImageAnnotations",
      {{"circles", List(Object("foxglove.CircleAnnotation", {{"timestamp", TimeType()},
                                                             {"position", Point2Type()},
                                                             {"diameter", Number()},
                                                             {"thickness", Number()},
                                                             {"fill_color", ColorType()},
                                                             {"outline_color", ColorType()}}))},
       {"points", List(Object("foxglove.PointsAnnotation", {{"timestamp", TimeType()},
                                                            {"type", Integer()},
                                                            {"points", List(Point2Type())},
                                                            {"outline_color", ColorType()},
                                                            {"outline_colors", List(ColorType())},
                                                            {"fill_color", ColorType()},
                                                            {"thickness", Number()}}))},
       {"texts", List(Object("foxglove.TextAnnotation", {{"timestamp", TimeType()},
                                                         {"position", Point2Type()},
                                                         {"text", Text()},
                                                         {"font_size", Number()},
                                                         {"text_color", ColorType()},
                                                         {"background_color", ColorType()}}))}});
  return schema;
}

const MessageSchema& CameraSchema() {
  static const auto schema = Named("foxglove.CameraCalibration", {{"timestamp", TimeType()},
                                                                  {"frame_id", Text()},
                                                                  {"width", Integer()},
                                                                  {"height", Integer()},
                                                                  {"distortion_model", Text()},
                                                                  {"D", List(Number())},
                                                                  {"K", List(Number())},
                                                                  {"R", List(Number())},
                                                                  {"P", List(Number())}});
  return schema;
}

const MessageSchema& TransformSchema() {
  static const auto schema = Named("foxglove.FrameTransform", {{"timestamp", TimeType()},
                                                               {"parent_frame_id", Text()},
                                                               {"child_frame_id", Text()},
                                                               {"translation", Vector3Type()},
                                                               {"rotation", QuaternionType()}});
  return schema;
}

MessageSchema TableSchema(const TimedTable& table) {
  Json properties = Json::object();
  for (std::size_t i = 1; i < table.cells.names.size(); ++i) {
    properties[PlainColumn(table.cells.names[i])] = IsNumeric(table, i) ? Number() : Text();
  }
  return Named("flextip." + table.name, properties);
}

std::string PoseMessage(const TimedPose& pose, const std::string& frame) {
  return Json{{"timestamp", TimeOf(pose.t_ns)}, {"frame_id", frame}, {"pose", Of(pose)}}.dump();
}

std::string PathMessage(const std::vector<TimedPose>& poses, const std::string& frame) {
  Json list = Json::array();
  for (const TimedPose& pose : poses) list.push_back(Of(pose));
  return Json{{"timestamp", TimeOf(poses.front().t_ns)}, {"frame_id", frame}, {"poses", list}}
      .dump();
}

std::string ImageMessage(TimeNs t_ns, const std::string& frame, const std::string& bytes,
                         const std::string& format) {
  return Json{{"timestamp", TimeOf(t_ns)},
              {"frame_id", frame},
              {"data", report::Base64(bytes)},
              {"format", format}}
      .dump();
}

std::string CameraMessage(TimeNs t_ns, const std::string& frame, const CameraCalibration& c) {
  const char* model = c.distortion == Distortion::kEquidistant ? "kannala_brandt"
                      : c.distortion_coefficients.size() > 5   ? "rational_polynomial"
                                                               : "plumb_bob";
  std::vector<double> D = c.distortion_coefficients;
  if (c.distortion != Distortion::kEquidistant && D.size() == 4) D.push_back(0.0);
  const std::vector<double> K = {c.fu_px, 0, c.cu_px, 0, c.fv_px, c.cv_px, 0, 0, 1};
  return Json{{"timestamp", TimeOf(t_ns)},
              {"frame_id", frame},
              {"width", c.width_px},
              {"height", c.height_px},
              {"distortion_model", model},
              {"D", D},
              {"K", K},
              {"R", {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}},
              {"P", {c.fu_px, 0.0, c.cu_px, 0.0, 0.0, c.fv_px, c.cv_px, 0.0, 0.0, 0.0, 1.0, 0.0}}}
      .dump();
}

std::string TransformMessage(TimeNs t_ns, const std::string& parent, const std::string& child,
                             const Pose& pose) {
  return Json{{"timestamp", TimeOf(t_ns)},
              {"parent_frame_id", parent},
              {"child_frame_id", child},
              {"translation", Of(pose.p)},
              {"rotation", Of(pose.Quaternion())}}
      .dump();
}

std::string RowMessage(const TimedTable& table, std::size_t row) {
  Json message = Json::object();
  for (std::size_t i = 1; i < table.cells.names.size(); ++i) {
    const std::string& text = table.cells.texts[i][row];
    if (text.empty()) continue;
    const double number = table.cells.numbers[i][row];
    const std::string name = PlainColumn(table.cells.names[i]);
    if (std::isnan(number)) {
      message[name] = text;
    } else {
      message[name] = number;
    }
  }
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string AnnotationsMessage(TimeNs t_ns, const Annotations& annotations) {
  constexpr int kLoop = 2, kStrip = 3;
  const Json green = Color(0.1, 0.9, 0.3, 1.0), orange = Color(1.0, 0.55, 0.0, 1.0);
  const Json none = Color(0.0, 0.0, 0.0, 0.0), time = TimeOf(t_ns);
  Json circles = Json::array(), points = Json::array(), texts = Json::array();
  for (const auto& outline : annotations.outlines) {
    Json corners = Json::array();
    for (const Eigen::Vector2d& corner : outline.corners) corners.push_back(Of(corner));
    points.push_back({{"timestamp", time},
                      {"type", outline.closed ? kLoop : kStrip},
                      {"points", corners},
                      {"outline_color", outline.closed ? green : orange},
                      {"outline_colors", Json::array()},
                      {"fill_color", none},
                      {"thickness", 1.5}});
    if (outline.text.empty()) continue;
    texts.push_back({{"timestamp", time},
                     {"position", Of(outline.corners.front())},
                     {"text", outline.text},
                     {"font_size", 12},
                     {"text_color", green},
                     {"background_color", none}});
  }
  for (const Eigen::Vector2d& mark : annotations.marks) {
    circles.push_back({{"timestamp", time},
                       {"position", Of(mark)},
                       {"diameter", 12},
                       {"thickness", 2},
                       {"fill_color", none},
                       {"outline_color", orange}});
  }
  return Json{{"circles", circles}, {"points", points}, {"texts", texts}}.dump();
}

}  // namespace flextip::exports
