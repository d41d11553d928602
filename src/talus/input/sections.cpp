#include "talus/input/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "talus/base/text.hpp"
#include "talus/base/units.hpp"

namespace talus {

Vec<3> vector_of(const std::vector<double>& values) {
  Vec<3> v{};
  for (std::size_t a = 0; a < values.size() && a < 3; ++a) v[int(a)] = values[a];
  return v;
}

void expect_absent(Section& s, std::initializer_list<const char*> keys, std::string_view with) {
  for (const char* key : keys)
    if (s.has(key)) s.complain(key, fmt::format("goes with `{}` only", with));
}

template <class T>
void expect_instants(Section& s, std::string_view values, std::string_view times, LinearInTime<T>& f) {
  if (f.times.size() != f.values.size())
    s.complain(values, fmt::format("are {} for {} `{}`", f.values.size(), f.times.size(), times));
  else if (const auto at = std::adjacent_find(f.times.begin(), f.times.end(), std::greater_equal());
           at != f.times.end())
    s.complain(times, fmt::format("must increase: {} follows {}", with_unit(at[1], "s"), with_unit(at[0], "s")));
  else if (f.times.empty() && s.is_right())
    s.complain(times, "name no instant");
  else
    return;
  f = {};
}

template void expect_instants(Section&, std::string_view, std::string_view, LinearInTime<Vec<3>>&);
template void expect_instants(Section&, std::string_view, std::string_view, LinearInTime<double>&);

}  // namespace talus
