#pragma once
/// Where a loop over tiles runs. The physics calls it; the back ends implement it.

#include <functional>

namespace talus {

class Loop {
 public:
  virtual ~Loop() = default;
  /// How many workers may run at the same time.
  virtual int n_workers() const = 0;
  /// Calls body(i, worker) once for every i in [0, n), in any order, 0 <= worker < n_workers(). An exception leaves the
  /// loop.
  virtual void for_each(int n, const std::function<void(int i, int worker)>& body) = 0;
};

}  // namespace talus
