#pragma once
/// A table of doubles stored column by column.

#include <algorithm>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "talus/base/large_memory.hpp"

namespace talus {

/// Columns of equal length, each contiguous and aligned to a cache line.
class Columns {
  using Values = std::unique_ptr<double[], FreeMemory>;

 public:
  explicit Columns(int n_columns)
      : blocks_(std::size_t(n_columns + columns_a_block - 1) / columns_a_block), pointers_(std::size_t(n_columns)) {}

  int n_columns() const { return int(pointers_.size()); }
  int size() const { return size_; }
  double* column(int c) { return pointers_[std::size_t(c)]; }
  const double* column(int c) const { return pointers_[std::size_t(c)]; }
  double* const* pointers() const { return pointers_.data(); }

  /// Memory [bytes].
  std::size_t bytes() const { return pointers_.size() * std::size_t(n_that_fit_) * sizeof(double); }

  /// Changes the number of rows. Existing rows keep their values; new rows are zero. A table that grows again and again takes
  /// a 128th more memory than it needs; one that shrinks keeps its memory until it needs less than half of it.
  void resize(int n) {
    if (!keeps_memory_with(n)) {
      n_that_fit_ = size_ == 0 || n < size_ ? n : n + std::min(n / 128, std::numeric_limits<int>::max() - n);
      for (int b = 0; b < int(blocks_.size()); ++b) move_block(b, std::min(size_, n));
    } else if (n > size_) {
      for (double* column : pointers_) std::fill(column + size_, column + n, 0.0);
    }
    size_ = n;
  }

  /// Working space of `permute`.
  class Spare {
   public:
    explicit Spare(const Columns& columns) : values_(allocate(columns.stride())) {}

   private:
    friend Columns;
    Values values_;
  };

  /// Permutes one column: row i becomes the former row order[i]. Rows behind the last of `order` keep their values.
  void permute(int c, const std::vector<int>& order, Spare& spare) {
    double *values = column(c), *permuted = spare.values_.get();
    for (std::size_t i = 0; i < order.size(); ++i) permuted[i] = values[order[i]];
    std::copy(permuted, permuted + order.size(), values);
  }

 private:
  /// So many columns stand in one piece of memory, which makes it large enough for large pages.
  static constexpr int columns_a_block = 8;

  bool keeps_memory_with(int n) const { return n <= n_that_fit_ && n >= n_that_fit_ / 2; }
  /// Numbers from one column to the next.
  std::size_t stride() const {
    constexpr std::size_t line = 64 / sizeof(double);
    return (std::size_t(n_that_fit_) / line + 1) * line;
  }
  static Values allocate(std::size_t n) {
    return Values(static_cast<double*>(large_memory(n * sizeof(double)).release()));
  }
  /// Gives a block new memory; the first rows keep their values.
  void move_block(int b, int n_kept) {
    const int first = b * columns_a_block, n = std::min(n_columns() - first, columns_a_block);
    const std::size_t n_values = std::size_t(n) * stride();
    Values values = allocate(n_values);
    std::fill_n(values.get(), n_values, 0.0);
    for (int c = 0; c < n; ++c) {
      double*& column = pointers_[std::size_t(first + c)];
      double* const moved = values.get() + std::size_t(c) * stride();
      if (n_kept > 0) std::copy(column, column + n_kept, moved);
      column = moved;
    }
    blocks_[std::size_t(b)] = std::move(values);
  }

  std::vector<Values> blocks_;
  std::vector<double*> pointers_;
  int size_ = 0, n_that_fit_ = 0;
};

}  // namespace talus
