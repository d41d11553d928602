#pragma once
/// Where material has left a run on terrain, on the map.

#include <string>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/mpm/ledger.hpp"

namespace talus {

/// A side of the domain or a gap of the ground (pixels without a height that touch) where material has left.
struct OutflowOnMap {
  std::string side;      ///< the word of the side, such as "x_max"; empty for a gap
  std::string name;      ///< "east side (x_max)"; "gap 1" is the largest; "further gaps"
  double mass = 0;       ///< that has left here [kg]
  double share = 0;      ///< of all that has left
  Vec<2> middle{};       ///< centre of mass of the places where it left, in the coordinates of the map [m]
  Vec<2> low{}, high{};  ///< the rectangle around them [m]

  /// Length of the side over which material has left; of a gap the longer edge of the rectangle [m].
  double length() const;
};

/// The places, the one with most mass first; none without terrain.
std::vector<OutflowOnMap> outflow_on_map(const Case& case_, const Outflow& outflow);

/// "80 % over the east side (x_max), around (640595, 5190203), along 45 m of it", in the coordinates of the map.
std::string in_words(const OutflowOnMap& place);

}  // namespace talus
