#pragma once
/// One function object made of several, for std::visit.

namespace talus {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace talus
