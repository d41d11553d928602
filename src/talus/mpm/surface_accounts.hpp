#pragma once
/// What each surface has given to the material: every solid, every side of the domain, every zone of a terrain.

#include <vector>

#include "talus/geometry/solid.hpp"

namespace talus {

/// Of one surface. In plane strain per metre of thickness, axisymmetric per radian.
struct SurfaceAccount {
  Vec<3> impulse{};      ///< given to the material [N s]
  Vec<3> across{};       ///< the part of it along the normals of the surface [N s]
  Vec<3> moment{};       ///< of the impulses of a solid about the origin of coordinates [N m s]
  double friction = 0;   ///< heat of friction [J]
  double turbulent = 0;  ///< the part of it that turbulent friction has made [J]

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

/// Numbers of the accounts of a run: solids in their order, then the sides of the domain, then the zones of solids. A
/// zone has an account of its own, which that of its solid does not contain.
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
  /// Of a zone of a solid; of the solid outside its zones, -1.
  int of_zone(int solid, int zone) const { return zone < 0 ? solid : first_zone_[std::size_t(solid)] + zone; }

 private:
  int n_solids_, n_sides_, size_ = 0;
  std::vector<int> first_zone_;
};

/// What a surface has given to the material in a tile, in one step.
struct TileAccount {
  int number;
  SurfaceAccount sums{};
};

/// The accounts that surfaces have in a tile; few meet one.
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

}  // namespace talus
