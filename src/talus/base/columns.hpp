#pragma once
/// A table of doubles stored column by column.

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace talus {

/// Columns of equal length, each contiguous and aligned to a cache line.
class Columns {
  struct Free {
    void operator()(double* p) const { std::free(p); }
  };
  using Storage = std::unique_ptr<double[], Free>;

 public:
  explicit Columns(int n_columns) : data_(n_columns), pointers_(n_columns) {}

  int n_columns() const { return int(data_.size()); }
  int size() const { return size_; }
  double* column(int c) { return data_[c].get(); }
  const double* column(int c) const { return data_[c].get(); }
  /// Rows that fit into all columns without new memory.
  double* const* pointers() const { return pointers_.data(); }

  /// Memory [bytes].
  std::size_t bytes() const { return data_.size() * std::size_t(n_that_fit_) * sizeof(double); }

  /// Changes the number of rows. Existing rows keep their values; new rows are zero. A table that grows again and again takes
  /// a 64th more memory than it needs; one that shrinks keeps its memory until it needs less than half of it.
  void resize(int n) {
    if (!keeps_memory_with(n)) {
      n_that_fit_ = size_ == 0 || n < size_ ? n : n + std::min(n / 64, std::numeric_limits<int>::max() - n);
      for (std::size_t c = 0; c < data_.size(); ++c) {
        Storage other = allocate(n_that_fit_);
        std::copy(data_[c].get(), data_[c].get() + std::min(size_, n), other.get());
        data_[c] = std::move(other);
        pointers_[c] = data_[c].get();
      }
    } else if (n > size_) {
      for (const Storage& column : data_) std::fill(column.get() + size_, column.get() + n, 0.0);
    }
    size_ = n;
  }

  /// Memory of a column without values, for `permute`.
  class Spare {
   public:
    explicit Spare(const Columns& columns) : storage_(allocate(columns.n_that_fit_)) {}

   private:
    friend Columns;
    Storage storage_;
  };

  /// Permutes one column: row i becomes the former row order[i]. Rows behind the last of `order` have any values. The column
  /// changes its memory with the spare one.
  void permute(int c, const std::vector<int>& order, Spare& spare) {
    const double* values = data_[c].get();
    double* permuted = spare.storage_.get();
    for (std::size_t i = 0; i < order.size(); ++i) permuted[i] = values[order[i]];
    std::swap(data_[c], spare.storage_);
    pointers_[c] = permuted;
  }

 private:
  bool keeps_memory_with(int n) const { return n <= n_that_fit_ && n >= n_that_fit_ / 2; }

  static Storage allocate(int n) {
    constexpr std::size_t line = 64;
    const std::size_t bytes = (std::size_t(n) * sizeof(double) / line + 1) * line;
    double* p = static_cast<double*>(std::aligned_alloc(line, bytes));
    if (!p) throw std::bad_alloc();
    std::fill(p, p + bytes / sizeof(double), 0.0);
    return Storage(p);
  }

  std::vector<Storage> data_;
  std::vector<double*> pointers_;
  int size_ = 0, n_that_fit_ = 0;
};

}  // namespace talus
