#pragma once
/// What can be read off the particles of a body.

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "talus/mpm/data/body.hpp"
#include "talus/mpm/data/domain.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus {

/// The particles of all owners in the order of their ids: in which row of a table each stands.
class RowsOfIds {
 public:
  explicit RowsOfIds(std::vector<double> ids) : ids_(std::move(ids)) { std::sort(ids_.begin(), ids_.end()); }
  std::size_t size() const { return ids_.size(); }
  /// Of an id that is there.
  std::size_t row(double id) const {
    if (ids_.back() - ids_.front() == double(ids_.size() - 1))
      return std::size_t(id - ids_.front());  // none is missing
    return std::size_t(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
  }

 private:
  std::vector<double> ids_;
};

/// Appends a body's particles to an observation. `rates` holds their strain rates, in the order of the particles. `fields`:
/// names of fields beside the position and the id; all if empty.
template <int Dim>
void observe_body(const Body<Dim>& body, int number, const std::vector<SymTensor<double>>& rates, Backend& backend,
                  Observation& seen, const std::vector<std::string>& fields = {});

/// Divides what all owners have seen of their particles into consecutive parts in the order of ids.
ObservedPart share_out(Backend& backend, Observation own);
/// Puts together, for the first owner, what each has seen of its own particles, in the order of ids. Others have nothing then.
void gather(Backend& backend, Observation& seen);
/// The first text that is not empty, in the order of owners.
std::string gather(Backend& backend, const std::string& text);

/// Messages one after the other.
inline std::vector<double> joined(const std::vector<Message>& messages) {
  std::size_t n = 0;
  for (const Message& m : messages) n += m.size();
  std::vector<double> all;
  all.reserve(n);
  for (const Message& m : messages) all.insert(all.end(), m.begin(), m.end());
  return all;
}

/// Puts the places, sizes, masses and ancestors of some of a body's particles into those of all, from number `first` on. Volumes
/// are per radian if axisymmetric.
template <int Dim>
void put_places_of(const Body<Dim>& body, RowRange range, bool axisymmetric, ParticlePlaces& all, std::size_t first);

/// The same of what flows. What has more than `most_room` [m3/kg] is spray, whose volume is mostly gap: it has so much.
/// `room_at_start` [m3/kg]: of the body.
template <int Dim>
void put_flow_of(const Body<Dim>& body, RowRange range, double most_room, double room_at_start, FlowPoints& all,
                 std::size_t first);

/// Puts together, for the first owner, what each has of its own particles, tile by tile, in the order of tiles. `tiles`: of each own
/// tile its number in the run and how many particles it has. Others have nothing then.
void gather(Backend& backend, const std::vector<double>& tiles, ParticlePlaces& own);
void gather(Backend& backend, const std::vector<double>& tiles, FlowPoints& own);

/// What the pressure in a tile follows from: sums over the particles of each of its cells.
template <int Dim>
struct CellPressures {
  static constexpr int n = Dim == 2 ? tile_edge * tile_edge : tile_edge * tile_edge * tile_edge;
  struct Cell {
    double volume = 0;    ///< [m3]
    double pressure = 0;  ///< times volume [J]
    double squared = 0;   ///< squared pressure times volume [Pa J]
    double speed2 = 0;    ///< squared speed times volume [m5/s2]
  };
  std::array<Cell, n> cells{};

  /// Particles beside the tile count as in its nearest cell.
  void add(const Body<Dim>& body, RowRange range, const Domain<Dim>& domain, const Index<Dim>& tile);
  TilePressure sum(const Index<Dim>& tile) const;
};

/// Everything about one particle, a line a quantity.
template <int Dim>
std::string describe(const Body<Dim>& body, int particle);

/// Elastic energy stored in each of some particles of a body [J].
template <int Dim>
std::vector<double> elastic_energies(const Body<Dim>& body, RowRange range);

/// Of all particles [m3/kg].
template <int Dim>
double largest_volume_per_mass(const Body<Dim>& body);

/// What loads could give to a particle of a body at most, each at its largest [m/s2].
template <int Dim>
double largest_acceleration_by_loads(const Body<Dim>& body);

/// How the squared speed of compression waves grows in a body whose grains carry nothing and meet [m2/s2]; none where
/// stiffness does not depend on stress.
template <int Dim>
std::optional<Stiffening> contact_stiffening(const Body<Dim>& body);

/// Stiffness of a state in a step in which nothing happens, K + 4/3 G [Pa].
template <class Law>
double stiffness_at_rest(const Law& law, typename Law::template State<double> state, const Integration& how) {
  return law.update(state, Motion<double>{SymTensor<double>::zero(), SymTensor<double>::zero(), 1}, how).stiffness;
}

/// The fastest compression wave in a body.
struct FastestWave {
  double speed = 0;  ///< [m/s]
  int particle = 0;  ///< where it is
};
template <int Dim>
FastestWave fastest_wave(const Body<Dim>& body, const Integration& how);

}  // namespace talus
