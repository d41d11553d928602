#pragma once
/// Rest of the material in a tile, for tiles that are left out of steps while nothing happens in them (stage/rest.hpp).

#include <array>
#include <vector>

#include "talus/mpm/data/node.hpp"

namespace talus {

/// What outlives a step, as plain numbers that can be sent and saved.
struct RestState {
  double quiet = 0;      ///< time for which the particles have been slow [s]
  double is_asleep = 0;  ///< 1 if the tile is left out, or 0
  double elastic = 0;    ///< elastic energy of the particles [J]
  double separated = 0;  ///< number of particles whose grains have moved apart
  /// Of a tile that is left out: fading sum of the impulses that its particles did not take [N s], and of their moments
  /// about its centre of mass [N s cells], impulse by impulse and for each axis by axis.
  std::array<double, 3> push{};
  std::array<double, 9> spread{};
};

/// Rest of a tile, and what its particles give to nodes while it is left out: the same in every step.
struct TileRest {
  RestState state;
  std::vector<MassMomentum> momentum;  ///< of its window; empty unless it is left out
  std::vector<ForceStiffness> force;   ///< the same

  bool is_left_out() const { return !momentum.empty(); }
  std::size_t bytes() const {
    return sizeof *this + momentum.capacity() * sizeof(MassMomentum) + force.capacity() * sizeof(ForceStiffness);
  }
};

}  // namespace talus
