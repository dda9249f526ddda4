// Units of a picture's bias: each pixel of a crop is in one row of units, the rows follow each
// other, and a row has the pixels of its units.
#include "render/bias/unit_grid.hpp"

#include <gtest/gtest.h>

namespace dapple {
namespace {

TEST(UnitGrid, RowsHaveThePixelsOfTheirUnitsInAnyCrop) {
  for (const PixelRect& crop : {PixelRect{0, 0, 63, 39}, PixelRect{5, 7, 30, 8},
                                PixelRect{16, 16, 16, 16}, PixelRect{1, 15, 9, 38}}) {
    View view;
    view.width = 64;
    view.height = 40;
    view.crop = crop;
    const UnitGrid grid(view);
    std::uint32_t next = 0;
    for (std::uint32_t row = 0; row < grid.row_count(); ++row) {
      const PixelRange pixels = grid.pixels_of_row(row);
      EXPECT_EQ(pixels.begin, next);
      next = pixels.end;
      for (std::uint32_t pixel = pixels.begin; pixel < pixels.end; ++pixel)
        ASSERT_EQ(grid.row(grid.unit(pixel)), grid.row(0) + row) << pixel;
    }
    EXPECT_EQ(next, static_cast<std::uint32_t>(crop.width() * crop.height()));
  }
}

}  // namespace
}  // namespace dapple
