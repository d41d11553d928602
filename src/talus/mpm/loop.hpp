#pragma once
/// Where a loop over tiles runs. The physics calls it; the back ends implement it.

#include <functional>
#include <vector>

namespace talus {

/// How the numbers from 0 on are dealt out: worker w begins with those from shares[w] up to shares[w + 1]. So it meets
/// from loop to loop what it has in its cache. A worker that is done helps the others.
using Shares = std::vector<int>;

class Loop {
 public:
  virtual ~Loop() = default;
  /// How many workers may run at the same time.
  virtual int n_workers() const = 0;
  /// Calls body(i, worker) once for every i in [0, shares.back()), in any order, 0 <= worker < n_workers(). An exception
  /// leaves the loop.
  virtual void for_each(const Shares& shares, const std::function<void(int i, int worker)>& body) = 0;

  /// The same for i in [0, n), in equal shares.
  void for_each(int n, const std::function<void(int i, int worker)>& body) {
    Shares shares(n_workers() + 1);
    for (int w = 0; w <= n_workers(); ++w) shares[w] = int(long(n) * w / n_workers());
    for_each(shares, body);
  }
};

}  // namespace talus
