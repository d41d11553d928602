#include "talus/backend/backend.hpp"

namespace talus {

namespace {

class Serial final : public Backend {
 public:
  int n_workers() const override { return 1; }
  using Backend::for_each;
  void for_each(const Shares& shares, const std::function<void(int, int)>& body) override {
    for (int i = 0; i < shares.back(); ++i) body(i, 0);
  }
};

}  // namespace

std::unique_ptr<Backend> make_serial() { return std::make_unique<Serial>(); }

}  // namespace talus
