#pragma once
/// Combines several function objects into one, for std::visit.

namespace talus {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace talus
