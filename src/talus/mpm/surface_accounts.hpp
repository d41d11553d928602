#pragma once
/// Impulses of surfaces on the material: solids, sides of the domain and zones of a terrain.

#include <vector>

#include "talus/geometry/solid.hpp"

namespace talus {

/// Account of one surface. In plane strain per metre of thickness, axisymmetric per radian.
struct SurfaceAccount {
  Vec<3> impulse{};      ///< on the material [N s]
  Vec<3> across{};       ///< the part of it along the normals of the surface [N s]
  Vec<3> moment{};       ///< of the impulses of a solid about the origin of coordinates [N m s]
  double friction = 0;   ///< heat of friction [J]
  double turbulent = 0;  ///< its part due to turbulent friction [J]

  void add_impulse(const Vec<3>& given, const Vec<3>& normal, const Vec<3>& place) {
    impulse = impulse + given;
    across = across + dot(given, normal) * normal;
    moment = moment + cross(place, given);
  }
  SurfaceAccount& operator+=(const SurfaceAccount& o) {
    impulse = impulse + o.impulse;
    across = across + o.across;
    moment = moment + o.moment;
    friction += o.friction;
    turbulent += o.turbulent;
    return *this;
  }
  bool operator==(const SurfaceAccount&) const = default;
};

/// Numbers of the accounts of a run: solids in their order, then the sides of the domain, then the zones of solids. The
/// account of a solid excludes its zones.
class AccountNumbers {
 public:
  AccountNumbers(const std::vector<Solid>& solids, int dim) : n_solids_(int(solids.size())), n_sides_(2 * dim) {
    int next = n_solids_ + n_sides_;
    for (const Solid& solid : solids) {
      first_zone_.push_back(next);
      next += int(solid.zones.surfaces.size());
    }
    size_ = next;
  }

  int size() const { return size_; }
  int of_solid(int solid) const { return solid; }
  int of_side(int side) const { return n_solids_ + side; }
  /// Number of the account of a zone of a solid; zone -1: the solid outside its zones.
  int of_zone(int solid, int zone) const { return zone < 0 ? solid : first_zone_[std::size_t(solid)] + zone; }

 private:
  int n_solids_, n_sides_, size_ = 0;
  std::vector<int> first_zone_;
};

/// Account of a surface in a tile, of one step.
struct TileAccount {
  int number;
  SurfaceAccount sums{};
};

/// Accounts of the surfaces in a tile; a tile has few of them.
class TileAccounts {
 public:
  SurfaceAccount& operator[](int number) {
    for (TileAccount& a : accounts_)
      if (a.number == number) return a.sums;
    accounts_.push_back({number});
    return accounts_.back().sums;
  }
  const std::vector<TileAccount>& all() const { return accounts_; }
  void clear() { accounts_.clear(); }

 private:
  std::vector<TileAccount> accounts_;
};

/// For each tile that an owner holds.
using AccountsByTile = std::vector<TileAccounts>;

/// Adds the account of a tile to accounts in the order of their numbers.
inline void add_to(std::vector<SurfaceAccount>& accounts, const TileAccount& of_tile) {
  const auto number = std::size_t(of_tile.number);
  if (number >= accounts.size()) accounts.resize(number + 1);
  accounts[number] += of_tile.sums;
}

}  // namespace talus
