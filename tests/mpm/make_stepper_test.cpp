/// The stepper of each dimension and shape function.

#include "talus/mpm/make_stepper.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mpm/cases.hpp"
#include "mpm/small_model.hpp"

namespace talus::make_stepper_test {

/// Steps of a fixed length.
Numerics fixed(double dt) {
  Numerics n = pure_flip();
  n.dt = dt;
  return n;
}

/// A particle of 1 kg that falls by 10 m/s2 for 0.1 s: -1 m/s, 0.1 m.
template <int Dim, class Shape>
void expect_fall(const Shape& shape) {
  Vec<Dim> place, gravity{};
  for (int a = 0; a < Dim; ++a) place[a] = 5.3 + a;
  gravity[Dim - 1] = -10;
  Particles<Dim> particles = particles_at<Dim>({place}, {state_size<LinearElastic>});
  set_state<LinearElastic>(particles, 0, {SymTensor<double>::zero(), 1});
  std::vector<Body<Dim>> bodies;
  bodies.push_back({"body", 1, rubber(), std::move(particles), {}});
  const auto serial = make_serial();
  const auto s = make_stepper<Dim, Shape>(unit_cells<Dim>(16), std::move(bodies), std::vector<Shape>{shape}, gravity,
                                          fixed(0.1), *serial);
  s->step();
  const Observation seen = s->observe();
  EXPECT_NEAR(value(seen, "velocity", 0, Dim - 1), -1, 1e-13);
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(value(seen, "position", 0, a), a >= Dim ? 0 : 5.3 + a - (a == Dim - 1 ? 0.1 : 0), 1e-13) << a;
}

TEST(MakeStepper, WhateverTheShapeAndDimensionAParticleFallsByGravity) {
  const auto in_both = []<class Shape>(const Shape& shape) {
    expect_fall<2>(shape);
    expect_fall<3>(shape);
  };
  in_both(Linear());
  in_both(Quadratic());
  in_both(Cubic());
  in_both(Ugimp(0.25));
}

TEST(MakeStepper, EveryBodyHasTheShapeThatStandsAtItsPlace) {
  // Two pairs of particles at x = 0.3 and 0.7 of a cell that part at 1 m/s. Particles a fifth of a cell wide lie under
  // one hat: v_I = -0.7 + 0.3 = -0.4 and 0.4 m/s, so D_xx = 0.8/s. Those a cell wide have the weights 0.02, 0.66 and 0.32
  // of the quadratic spline with the slopes -0.2, -0.6 and 0.8: v_I = -1, -0.34/0.98 and 0.34/0.98 m/s, D_xx = 24/35/s.
  // |g| = D_xx/sqrt(3).
  std::vector<Body<2>> bodies;
  for (const double x : {2.0, 10.0}) {
    Body<2> pair = small_body({{x + 0.3, 6}, {x + 0.7, 6}});
    for (int i = 0; i < 2; ++i) {
      pair.particles.velocity(0)[i] = i == 0 ? -1 : 1;
      pair.particles.set_id(i, (x > 5 ? 2 : 0) + i);
    }
    bodies.push_back(std::move(pair));
  }
  const auto serial = make_serial();
  const auto s =
      make_stepper<2, Ugimp>(unit_cells<2>(16), std::move(bodies), {Ugimp(0.1), Ugimp(0.5)}, {}, fixed(0.01), *serial);
  const Observation seen = s->observe();
  const double rates[4] = {0.8, 0.8, 24.0 / 35, 24.0 / 35};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(value(seen, "body", i), i / 2);
    EXPECT_NEAR(value(seen, "shear_rate", i), rates[i] / std::sqrt(3.0), 1e-13);
  }
}

TEST(MakeStepper, ParticlesMeetTheSolidsThatItIsGiven) {
  // PIC at y = 6.2 and -1 m/s. On a floor at y = 6 the nodes at 5, 6 and 7 with the weights 0.045, 0.71 and 0.245 get the
  // velocities d rate nearest to that, at the distances d = -1, 0, 1: rate = -sum N d/sum N d^2 = -0.2/0.29, and the particle
  // 0.2 of it.
  Numerics pic = fixed(1e-6);
  pic.flip_share = 0;
  const std::vector<Solid> floor = {{"floor", HalfSpace{{0, 6, 0}, {0, 1, 0}}, WallKind::no_slip}};
  const auto speed = [&](const std::vector<Solid>& solids) {
    std::vector<Body<2>> bodies;
    bodies.push_back(small_body({{5, 6.2}}));
    bodies[0].particles.velocity(1)[0] = -1;
    const auto serial = make_serial();
    const auto s = make_stepper<2, Quadratic>(unit_cells<2>(16), std::move(bodies), std::vector<Quadratic>(1), {}, pic,
                                              *serial, solids);
    s->step();
    return value(s->observe(), "velocity", 0, 1);
  };
  EXPECT_NEAR(speed({}), -1, 1e-13);
  EXPECT_NEAR(speed(floor), -0.2 * 0.2 / 0.29, 1e-6);
}

}  // namespace talus::make_stepper_test
