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
  explicit Columns(int n_columns) : pointers_(std::size_t(n_columns)) {}

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
      move(std::min(size_, n));
    } else if (n > size_) {
      for (double* column : pointers_) std::fill(column + size_, column + n, 0.0);
    }
    size_ = n;
  }

  /// Permutes all columns: row i becomes the former row order[i]. Rows behind the last of `order` are undefined.
  /// `for_each_stretch(f)` calls f(begin, end) for stretches that make up [0, order.size()), by several threads if it likes: each
  /// row is read and written by the thread that has its place in the order. Needs working space for two blocks of columns, if
  /// there are as many, and changes nothing without it (std::bad_alloc).
  template <class Stretches>
  void permute(const std::vector<int>& order, Stretches for_each_stretch) {
    if (blocks_.empty()) return;
    const int last = int(blocks_.size()) - 1;
    Values of_all = allocate(values_of_block(0)), of_last = last > 0 ? allocate(values_of_block(last)) : nullptr;
    for (int b = 0; b <= last; ++b) {
      Values& block = b == 0 || b < last ? of_all : of_last;
      const int first = b * columns_a_block_, end = first + columns_of_block(b);
      const auto permuted = [&](int c) { return block.get() + std::size_t(c - first) * stride(); };
      for_each_stretch([&](std::size_t from, std::size_t to) {
        for (int c = first; c < end; ++c) {
          const double* const values = column(c);
          double* const moved = permuted(c);
          for (std::size_t i = from; i < to; ++i) moved[i] = values[order[i]];
        }
      });
      for (int c = first; c < end; ++c) pointers_[std::size_t(c)] = permuted(c);
      std::swap(blocks_[std::size_t(b)], block);
    }
  }

 private:
  bool keeps_memory_with(int n) const { return n <= n_that_fit_ && n >= n_that_fit_ / 2; }
  /// Numbers from one column to the next.
  std::size_t stride() const {
    constexpr std::size_t line = 64 / sizeof(double);
    return (std::size_t(n_that_fit_) / line + 1) * line;
  }
  static Values allocate(std::size_t n) {
    return Values(static_cast<double*>(large_memory(n * sizeof(double)).release()));
  }
  int columns_of_block(int b) const { return std::min(n_columns() - b * columns_a_block_, columns_a_block_); }
  std::size_t values_of_block(int b) const { return std::size_t(columns_of_block(b)) * stride(); }
  /// Gives all columns new memory; the first rows keep their values, also if memory runs out (std::bad_alloc).
  void move(int n_kept) {
    const std::size_t n_old = blocks_.size();
    const int columns_an_old_block = columns_a_block_;
    const std::size_t that_fit = block_bytes / (stride() * sizeof(double));
    columns_a_block_ = int(std::clamp(that_fit, std::size_t(1), std::size_t(most_columns_a_block)));
    for (int first = 0, b = 0; first < n_columns(); first += columns_a_block_, ++b) {
      const std::size_t n_values = values_of_block(b);
      blocks_.push_back(allocate(n_values));
      double* moved = blocks_.back().get();
      std::fill_n(moved, n_values, 0.0);
      for (int c = first; c < first + columns_of_block(b); ++c, moved += stride()) {
        double*& column = pointers_[std::size_t(c)];
        if (n_kept > 0) std::copy(column, column + n_kept, moved);
        column = moved;
        if (n_old > 0 && (c + 1) % columns_an_old_block == 0) blocks_[std::size_t(c / columns_an_old_block)].reset();
      }
    }
    blocks_.erase(blocks_.begin(), blocks_.begin() + long(n_old));
  }

  /// Columns stand side by side in blocks of this size, or of this many columns: large enough for large pages, and small enough
  /// for working space.
  static constexpr std::size_t block_bytes = std::size_t(8) << 20;
  static constexpr int most_columns_a_block = 8;

  std::vector<Values> blocks_;
  std::vector<double*> pointers_;
  int size_ = 0, n_that_fit_ = 0, columns_a_block_ = 1;
};

}  // namespace talus
