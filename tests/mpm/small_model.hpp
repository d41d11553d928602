#pragma once
/// A model of a few particles on a grid, for stages of the step that are tested without the others.

#include "mpm/by_hand.hpp"
#include "talus/backend/backend.hpp"
#include "talus/mpm/arrangement.hpp"
#include "talus/mpm/refinement.hpp"

namespace talus {

inline Numerics pure_flip(Order order = Order::usf) {
  Numerics n;
  n.transfer = Transfer::flip;
  n.order = order;
  n.average_pressure = false;
  n.particle_splitting = Splitting::none;
  return n;
}

/// A body of the given law; its particles have mass 1 and volume 1 and are at rest, without stress.
template <class Law = LinearElastic>
Body<2> small_body(const std::vector<Vec<2>>& places, const Numerics& n = pure_flip(),
                   const Law& law = Law{{1000, 0}}) {
  Particles<2> p = particles_at<2>(places, {state_size<Law>, n.transfer == Transfer::apic, n.transfer == Transfer::tpic,
                                            n.order == Order::musl, 0, n.particle_splitting != Splitting::none});
  for (int i = 0; i < p.size(); ++i)
    set_state<Law>(p, i, std::get<typename Law::template State<double>>(law.at_rest({})));
  if (p.memory().extent)
    for (int i = 0; i < p.size(); ++i) set_extent(p, i, SymTensor<double>::isotropic(1));
  return {"body", 1, law, std::move(p), {}};
}

/// A model of one such body.
template <class Shape = Quadratic, class Law = LinearElastic>
class SmallModel {
 public:
  SmallModel(const Domain<2>& domain, const std::vector<Vec<2>>& places, const Numerics& numerics = pure_flip(),
             const Vec<2>& gravity = {}, std::vector<Solid> solids = {}, const Law& law = Law{{1000, 0}},
             std::unique_ptr<Backend> where = make_serial())
      : backend(std::move(where)),
        model(domain, std::move(solids), bodies_of(places, numerics, law), gravity, numerics, *backend) {}

  Particles<2>& particles() { return model.bodies[0].particles; }
  /// The row of the particle with this number.
  int row(long id) {
    int i = 0;
    while (particles().id(i) != id) ++i;
    return i;
  }

  std::unique_ptr<Backend> backend;
  Model<2, Shape> model;

 private:
  static std::vector<ShapedBody<2, Shape>> bodies_of(const std::vector<Vec<2>>& places, const Numerics& n,
                                                     const Law& law) {
    std::vector<ShapedBody<2, Shape>> bodies;
    bodies.push_back({small_body(places, n, law), Shape()});
    return bodies;
  }
};

}  // namespace talus
