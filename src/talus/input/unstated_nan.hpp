#pragma once
/// NaN in rasters that mark places without data otherwise.

namespace talus {

/// Pixels of a raster that hold NaN, although its file marks places without data by a number, or not at all.
struct UnstatedNan {
  long n = 0;
  int column = 0, row = 0;  ///< one of them, from the west and from the south

  void add(int its_column, int its_row) {
    ++n;
    column = its_column;
    row = its_row;
  }
};

}  // namespace talus
