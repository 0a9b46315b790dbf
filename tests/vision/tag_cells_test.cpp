// Every family's cells against the AprilTag library's own picture.
#include "vision/tags/cells.h"

#include <apriltag/common/image_u8.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

#include <apriltag/apriltag.h>
#include "core/error.h"

#include "vision/tags/families.h"

namespace flextip {
namespace {

// The library's own way to free a picture is not exported.
void Free(image_u8_t* picture) {
  std::free(picture->buf);
  std::free(picture);
}
using Picture = std::unique_ptr<image_u8_t, void (*)(image_u8_t*)>;

Picture DrawByLibrary(const std::string& family, int id) {
  const TagFamily library = MakeTagFamily(family);
  return {apriltag_to_image(library.get(), static_cast<std::uint32_t>(id)), Free};
}

struct FamilySize {
  const char* name;
  int cells, border_cells, last_id, unknown;
};
// As the library's papers draw them; the circular family's corners are cut off.
constexpr FamilySize kFamilies[] = {{"tag36h11", 10, 8, 586, 0},
                                    {"tag36h10", 10, 8, 2319, 0},
                                    {"tag25h9", 9, 7, 34, 0},
                                    {"tag16h5", 8, 6, 29, 0},
                                    {"tagCircle21h7", 9, 5, 37, 20},
                                    {"tagStandard41h12", 9, 5, 2114, 0},
                                    {"tagStandard52h13", 10, 6, 48713, 0}};

TEST(TagCells, AreTheLibrarysPicture) {
  for (const FamilySize& family : kFamilies) {
    for (const int id : {0, 7, family.last_id}) {
      SCOPED_TRACE(testing::Message() << family.name << " " << id);
      const TagCells tag = ReadTagCells(family.name, id);
      ASSERT_EQ(tag.cells, family.cells);
      ASSERT_EQ(tag.border_cells, family.border_cells);
      const Picture picture = DrawByLibrary(family.name, id);
      ASSERT_EQ(picture->width, tag.cells);
      int unknown = 0;
      for (int row = 0; row < tag.cells; ++row) {
        for (int column = 0; column < tag.cells; ++column) {
          const bool white = picture->buf[row * picture->stride + column] > 127;
          const TagCells::Colour colour = tag.At(column, row);
          if (colour == TagCells::kUnknown) {
            ++unknown;
          } else {
            EXPECT_EQ(colour == TagCells::kWhite, white) << column << " " << row;
          }
        }
      }
      EXPECT_EQ(unknown, family.unknown);
    }
  }
}

TEST(TagCells, TheCircularFamilyEndsRound) {
  const char* rows[] = {"xxx...xxx", "x.......x", "x.......x", ".........", ".........",
                        ".........", "x.......x", "x.......x", "xxx...xxx"};
  const TagCells tag = ReadTagCells("tagCircle21h7", 3);
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 9; ++column) {
      EXPECT_EQ(tag.At(column, row) == TagCells::kUnknown, rows[row][column] == 'x')
          << column << " " << row;
    }
  }
}

TEST(TagCells, NothingIsKnownOutside) {
  const TagCells tag = ReadTagCells("tag36h11", 0);
  for (const int at : {-1, 10}) {
    EXPECT_EQ(tag.At(at, 4), TagCells::kUnknown);
    EXPECT_EQ(tag.At(4, at), TagCells::kUnknown);
  }
}

TEST(TagCells, RefusesWhatDoesNotExist) {
  EXPECT_THROW(ReadTagCells("tag36h12", 0), InputError);
  EXPECT_THROW(ReadTagCells("", 0), InputError);
  EXPECT_THROW(ReadTagCells("tag36h11", -1), InputError);
  for (const FamilySize& family : kFamilies) {
    EXPECT_THROW(ReadTagCells(family.name, family.last_id + 1), InputError) << family.name;
  }
}

}  // namespace
}  // namespace flextip
