#include "talus/output/outflow_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace talus {

namespace {

constexpr const char* directions_of_sides[] = {"west", "east", "south", "north"};

/// Of a side by its number, or of a gap by its place in `Outflow::places`.
void name_place(std::size_t place, const Outflow& outflow, OutflowOnMap& on_map) {
  if (place < unknown_ground) {
    on_map.side = side_choices[place].word;
    on_map.name = place < std::size(directions_of_sides)
                      ? fmt::format("{} side ({})", directions_of_sides[place], on_map.side)
                      : fmt::format("{} of the domain ({})", place == 5 ? "top" : "bottom", on_map.side);
  } else {
    on_map.name =
        place + 1 == outflow.places.size() ? "further gaps" : fmt::format("gap {}", place - unknown_ground + 1);
  }
}

}  // namespace

double OutflowOnMap::length() const { return std::max(high[0] - low[0], high[1] - low[1]); }

std::vector<OutflowOnMap> outflow_on_map(const Case& case_, const Outflow& outflow) {
  std::vector<OutflowOnMap> all;
  if (!case_.map) return all;
  const Vec<2> origin = case_.map->frame.origin;
  for (std::size_t i = 0; i < outflow.places.size(); ++i) {
    const OutflowPlace& place = outflow.places[i];
    if (!(place.mass > 0)) continue;
    OutflowOnMap on_map;
    name_place(i, outflow, on_map);
    on_map.mass = place.mass;
    on_map.share = place.mass / outflow.mass;
    on_map.middle = place.middle() + origin;
    on_map.low = place.low + origin;
    on_map.high = place.high + origin;
    // Particles are found up to a tenth of a cell beyond a side; the place is on it.
    if (const std::size_t axis = i / 2; axis < 2 && i < unknown_ground) {
      const auto a = int(axis);
      const double edge = (i % 2 == 0 ? case_.domain.min : case_.domain.max)[a] + origin[a];
      on_map.middle[a] = on_map.low[a] = on_map.high[a] = edge;
    }
    all.push_back(std::move(on_map));
  }
  std::ranges::stable_sort(all, std::greater(), &OutflowOnMap::mass);
  return all;
}

std::string in_words(const OutflowOnMap& place) {
  const std::string middle =
      fmt::format("({:.10g}, {:.10g})", std::round(place.middle[0]), std::round(place.middle[1]));
  if (place.side.empty())
    return fmt::format("{:.3g} % over ground without heights ({}), around {}, within {:.3g} m x {:.3g} m",
                       100 * place.share, place.name, middle, place.high[0] - place.low[0],
                       place.high[1] - place.low[1]);
  return fmt::format("{:.3g} % over the {}, around {}, along {:.3g} m of it", 100 * place.share, place.name, middle,
                     place.length());
}

}  // namespace talus
