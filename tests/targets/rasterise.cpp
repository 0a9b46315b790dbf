#include "tests/targets/rasterise.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "tests/scratch_folder.h"

namespace flextip {

bool CanRasterise() { return std::filesystem::exists(FLEXTIP_PDFTOPPM); }

Image Rasterise(const std::filesystem::path& pdf, double px_per_mm,
                const Eigen::AlignedBox2d& part_mm) {
  const auto out = Scratch("page");
  const Eigen::Vector2d corner = px_per_mm * part_mm.min(), size = px_per_mm * part_mm.sizes();
  const std::string command = fmt::format(
      "'{}' -gray -singlefile -r {:.4f} -x {:.0f} -y {:.0f} -W {:.0f} -H {:.0f} '{}' '{}'",
      FLEXTIP_PDFTOPPM, 25.4 * px_per_mm, corner.x(), corner.y(), size.x(), size.y(), pdf.string(),
      out.string());
  if (std::system(command.c_str()) != 0) throw std::runtime_error(command);
  const cv::Mat_<std::uint8_t> page = cv::imread(out.string() + ".pgm", cv::IMREAD_GRAYSCALE);
  if (page.empty()) throw std::runtime_error("no picture from " + command);
  Image image(page.cols, page.rows, 1);
  std::copy(page.begin(), page.end(), image.data.begin());
  return image;
}

std::filesystem::path Scratch(const std::string& name) {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  auto folder = test_support::ScratchFolder() / test->test_suite_name() / test->name();
  std::filesystem::create_directories(folder);
  return folder / name;
}

}  // namespace flextip
