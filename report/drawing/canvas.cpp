#include "report/drawing/canvas.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <fmt/format.h>

#include <cstdlib>
#include <numbers>

#include "core/check.h"
#include "core/error.h"

namespace flextip::report {
namespace {

constexpr double kPngScale = 2.0;  // picture elements a px: sharp on today's screens

cairo_surface_t* NewSurface(const std::filesystem::path& file, double width, double height) {
  const std::string ending = file.extension().string();
  if (ending == ".svg") return cairo_svg_surface_create(file.c_str(), width, height);
  if (ending == ".pdf") return cairo_pdf_surface_create(file.c_str(), width, height);
  if (ending != ".png") {
    throw InputError(fmt::format("{}: a picture's name ends in .png, .svg or .pdf", file.string()));
  }
  auto* surface =
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(kPngScale * width),
                                 static_cast<int>(kPngScale * height));
  cairo_surface_set_device_scale(surface, kPngScale, kPngScale);
  return surface;
}

[[noreturn]] void Refuse(const std::filesystem::path& file, cairo_status_t status) {
  throw WorkError(
      fmt::format("{}: cannot be written: {}", file.string(), cairo_status_to_string(status)));
}

}  // namespace

Canvas::Canvas(std::filesystem::path file, double width_px, double height_px)
    : file_(std::move(file)),
      surface_(NewSurface(file_, width_px, height_px), &cairo_surface_destroy),
      context_(cairo_create(surface_.get()), &cairo_destroy) {
  if (const auto status = cairo_surface_status(surface_.get()); status != CAIRO_STATUS_SUCCESS) {
    Refuse(file_, status);
  }
  Color("#ffffff");
  cairo_paint(context_.get());
  cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_ROUND);
}

void Canvas::Color(const std::string& css, double opacity) {
  FLEXTIP_CHECK(css.size() == 7 && css.front() == '#', "a color as #rrggbb");
  const long rgb = std::strtol(css.c_str() + 1, nullptr, 16);
  const auto part = [&](int shift) { return static_cast<double>((rgb >> shift) & 0xff) / 255.0; };
  cairo_set_source_rgba(context_.get(), part(16), part(8), part(0), opacity);
}

void Canvas::Path(const std::vector<Place>& places) {
  cairo_new_path(context_.get());
  for (const Place& p : places) cairo_line_to(context_.get(), p.x, p.y);
}

void Canvas::Line(const std::vector<Place>& places, const std::string& color, double width,
                  bool dashed) {
  Color(color);
  Path(places);
  cairo_set_line_width(context_.get(), width);
  const double dash = 5.0;
  cairo_set_dash(context_.get(), &dash, dashed ? 1 : 0, 0.0);
  cairo_stroke(context_.get());
}

void Canvas::Fill(const std::vector<Place>& corners, const std::string& color, double opacity) {
  Color(color, opacity);
  Path(corners);
  cairo_fill(context_.get());
}

void Canvas::FillTogether(const std::vector<std::pair<Place, Place>>& rectangles,
                          const std::string& color) {
  Color(color);
  cairo_new_path(context_.get());
  for (const auto& [a, b] : rectangles) {
    cairo_rectangle(context_.get(), a.x, a.y, b.x - a.x, b.y - a.y);
  }
  cairo_fill(context_.get());
}

void Canvas::Disc(Place middle, double radius, const std::string& color, bool filled) {
  Color(color);
  cairo_new_path(context_.get());
  cairo_arc(context_.get(), middle.x, middle.y, radius, 0.0, 2.0 * std::numbers::pi);
  if (filled) {
    cairo_fill(context_.get());
    return;
  }
  cairo_set_dash(context_.get(), nullptr, 0, 0.0);
  cairo_set_line_width(context_.get(), 1.5);
  cairo_stroke(context_.get());
}

void Canvas::Font(const TextStyle& style) {
  cairo_select_font_face(context_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context_.get(), style.size);
}

double Canvas::Width(const std::string& text, const TextStyle& style) {
  Font(style);
  cairo_text_extents_t extents;
  cairo_text_extents(context_.get(), text.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::Text(const std::string& text, Place at, const TextStyle& style) {
  const double width = Width(text, style);
  const double capital = 0.72 * style.size;
  Color(style.color);
  cairo_save(context_.get());
  cairo_translate(context_.get(), at.x, at.y);
  if (style.upward) cairo_rotate(context_.get(), -0.5 * std::numbers::pi);
  cairo_move_to(context_.get(), -style.align_x * width, (1.0 - style.align_y) * capital);
  cairo_show_text(context_.get(), text.c_str());
  cairo_restore(context_.get());
}

void Canvas::Shift(double x_px, double y_px) { cairo_translate(context_.get(), x_px, y_px); }

void Canvas::Clip(Place corner, double width, double height) {
  cairo_save(context_.get());
  cairo_rectangle(context_.get(), corner.x, corner.y, width, height);
  cairo_clip(context_.get());
}

void Canvas::Unclip() { cairo_restore(context_.get()); }

void Canvas::Finish() {
  cairo_status_t status = cairo_status(context_.get());
  if (status == CAIRO_STATUS_SUCCESS && file_.extension() == ".png") {
    status = cairo_surface_write_to_png(surface_.get(), file_.c_str());
  }
  cairo_surface_finish(surface_.get());
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface_.get());
  if (status != CAIRO_STATUS_SUCCESS) Refuse(file_, status);
}

}  // namespace flextip::report
