/// The law at work on the particles of one tile.

#include "talus/mpm/kernel/stress.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "law/parameter_sets.hpp"
#include "mpm/by_hand.hpp"
#include "talus/mpm/stress_update.hpp"

namespace talus::stress_test {

const CellFinder<2> unit_cells_of_tile{{0, 0}, 1, {0, 0}};

/// Rows for n particles and a pack more; velocity gradients are zero, all others hold rubbish.
ScratchView scratch_of(Scratch& scratch, int n) {
  const ScratchView s = scratch.view(n);
  for (int i = 0; i < n + pack_width; ++i) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) s.gradient[a][b][i] = 0;
    for (double* row : {s.stiffness, s.share, s.p, s.volume, s.mean_share, s.mean_p, s.mean_per_p, s.mean_rate})
      row[i] = rubbish;
    for (double* row : s.flux) row[i] = rubbish;
    s.cell[i] = 12345;
  }
  return s;
}

// ---- one particle ------------------------------------------------------------------------------------------------

TEST(Stress, OfAnElasticParticleThatIsStretchedByHand) {
  // E = 1000, nu = 1/4: K + 4/3 G = 1200, K - 2/3 G = 400. A strain of 1/1000 along x; volume 2 e^0.001.
  const LinearElastic law{1000, 0.25};
  auto p = particles_at<2>({{0.5, 0.5}}, {state_size<LinearElastic>});
  p.reference_volume()[0] = 2;
  p.mass()[0] = 8;
  set_state<LinearElastic>(p, 0, {SymTensor<double>::zero(), 1});
  Scratch scratch;
  const ScratchView s = scratch_of(scratch, 1);
  s.gradient[0][0][0] = 0.1;
  TileSums sums;
  update_stress<double, false>(law, p.view(), {0, 1}, unit_cells_of_tile, {0.01, {}, false, false, 0}, s, sums);
  const double volume = 2 * std::exp(1e-3), density = 0.5 * 1.2 * 1e-3;
  EXPECT_NEAR(s.flux[0][0], volume * 1.2, 1e-14);
  EXPECT_NEAR(s.flux[1][0], volume * 0.4, 1e-14);
  EXPECT_NEAR(s.flux[2][0], volume * 0.4, 1e-14) << "plane strain presses across";
  for (int c = 3; c < 6; ++c) EXPECT_EQ(s.flux[c][0], 0);
  EXPECT_NEAR(s.stiffness[0], volume * 1200, 1e-10);
  EXPECT_NEAR(sums[Sum::elastic], volume * density, 1e-15);
  EXPECT_NEAR(sums[Sum::internal_work], volume * density, 1e-5 * density) << "but for the volume that grew on the way";
  EXPECT_EQ(sums[Sum::separated], 0);
  EXPECT_EQ(sums[Sum::faulty], 0);
  EXPECT_NEAR(state_of<LinearElastic>(p, 0).volume_ratio, std::exp(1e-3), 1e-15);
}

TEST(Stress, TurnsWithTheMaterial) {
  // Turned by a right angle in 1000 steps of pure spin: what pressed along x presses along y.
  const LinearElastic law{1000, 0.25};
  auto p = particles_at<2>({{0.5, 0.5}}, {state_size<LinearElastic>});
  auto pressed = SymTensor<double>::zero();
  pressed.xx = -10;
  set_state<LinearElastic>(p, 0, {pressed, 1});
  Scratch scratch;
  const ScratchView s = scratch_of(scratch, 1);
  s.gradient[0][1][0] = -std::acos(-1) / 2;
  s.gradient[1][0][0] = std::acos(-1) / 2;
  TileSums sums;
  for (int i = 0; i < 1000; ++i)
    update_stress<double, false>(law, p.view(), {0, 1}, unit_cells_of_tile, {1e-3, {}, false, false, 0}, s, sums);
  EXPECT_NEAR(s.flux[0][0], 0, 1e-4);
  EXPECT_NEAR(s.flux[1][0], -10, 1e-4);
}

TEST(Stress, OfAFluidTheViscosityCountsOverItsDensityWhereItIsClosed) {
  // The law states 2 eta = 6 Pa s: over 8 kg in 2 m3 that is 1.5 m2/s. What has opened has none and is separated.
  const NewtonianFluid law{1000, 3};
  for (const double compression : {1e-12, -1e-3}) {
    auto p = particles_at<2>({{0.5, 0.5}}, {state_size<NewtonianFluid>});
    p.reference_volume()[0] = 2;
    p.mass()[0] = 8;
    set_state<NewtonianFluid>(p, 0, {SymTensor<double>::zero(), compression});
    Scratch scratch;
    const ScratchView s = scratch_of(scratch, 1);
    TileSums sums;
    update_stress<double, false>(law, p.view(), {0, 1}, unit_cells_of_tile, {0.01, {}, false, false, 0}, s, sums);
    EXPECT_NEAR(sums[Most::viscosity], compression > 0 ? 1.5 : 0, 1e-11);
    EXPECT_EQ(sums[Sum::separated], compression > 0 ? 0 : 1);
  }
}

TEST(Stress, WhatIsNotFiniteIsAFinding) {
  auto p = particles_at<2>({{0.5, 0.5}}, {state_size<LinearElastic>});
  set_state<LinearElastic>(p, 0, {SymTensor<double>::zero(), 1});
  Scratch scratch;
  const ScratchView s = scratch_of(scratch, 1);
  s.gradient[0][0][0] = std::nan("");
  TileSums sums;
  update_stress<double, false>(LinearElastic{1000, 0.25}, p.view(), {0, 1}, unit_cells_of_tile,
                               {1, {}, false, false, 0}, s, sums);
  EXPECT_EQ(sums[Sum::faulty], 1);
}

TEST(Stress, AsItIsIsVolumeTimesStressOfTheState) {
  const LinearElastic law{1000, 0.25};
  auto p = particles_at<2>({{0.5, 0.5}}, {state_size<LinearElastic>});
  p.reference_volume()[0] = 2;
  set_state<LinearElastic>(p, 0, {{1, 2, 3, 4, 5, 6}, 1.5});
  Scratch scratch;
  const ScratchView s = scratch_of(scratch, 1);
  present_stress<double>(law, p.view(), {0, 1}, s);
  for (int c = 0; c < 6; ++c) EXPECT_EQ(s.flux[c][0], 3.0 * (c + 1)) << c;
  present_volumes<double>(law, p.view(), {0, 1}, s);
  EXPECT_EQ(s.volume[0], 3);
}

// ---- work that collisions return ---------------------------------------------------------------------------------

/// What one step takes from collisions of a particle of 2 m3 of the paper's sand, whose velocity gradient is diag(xx, yy, 0).
struct Returned {
  double work;                    ///< counted [J]
  Granular::State<double> state;  ///< after the step
  double volume;                  ///< after it [m3]
};
Returned returned(const Granular& law, double xx, double yy) {
  auto p = particles_at<2>({{0.5, 0.5}}, {state_size<Granular>});
  const auto before = isotropic_state(law, 1e4, 0.8);
  p.reference_volume()[0] = 2 / law.specific_volume(before);
  set_state<Granular>(p, 0, before);
  Scratch scratch;
  const ScratchView s = scratch_of(scratch, 1);
  s.gradient[0][0][0] = xx;
  s.gradient[1][1][0] = yy;
  TileSums sums;
  update_stress<double, false>(law, p.view(), {0, 1}, unit_cells_of_tile, {1e-7, {}, false, false, 0}, s, sums);
  const auto after = state_of<Granular>(p, 0);
  return {sums[Sum::returned_work], after, p.reference_volume()[0] * law.specific_volume(after)};
}

TEST(ReturnedWork, IsWhatDDGivesBackInAxisymmetricExtension) {
  // Stretched at r along x: D = (r/3) diag(2, -1, -1), |g| = r/sqrt 3, tr D^3 = 2 r^3/9. Shear gets back, per volume and
  // second, f (tr D^3 - 2 mu |g|^3) = (2/9) f r^3 (1 - sqrt 3 mu), positive for mu < 0.577: mu_s = 0.38 at small I.
  const Granular law = case_1();
  const double r = 2;
  const Returned found = returned(law, r, 0);
  const MuI& c = law.collisional;
  const double g = r / std::sqrt(3.0), f = c.momentum_exchange(1 / law.specific_volume(found.state));
  const double mu = c.friction(g, pressure(found.state.frictional.stress) + 2.0 / 3 * f * g * g);
  const double expected = found.volume * 1e-7 * 2 / 9 * f * r * r * r * (1 - std::sqrt(3.0) * mu);
  EXPECT_GT(expected, 0);
  EXPECT_NEAR(found.work, expected, 1e-12 * expected);
}

TEST(ReturnedWork, IsNoneInCompressionInPlaneShearAndOfAnIsotropicPressure) {
  Granular law = case_1();
  EXPECT_EQ(returned(law, -2, 0).work, 0) << "tr D^3 < 0";
  EXPECT_EQ(returned(law, 2, -2).work, 0) << "tr D^3 = 0";
  law.collisional.dispersive = Dispersive::isotropic;
  EXPECT_EQ(returned(law, 2, 0).work, 0) << "2 mu f |g|^3 is spent";
}

// ---- bulk viscosity ----------------------------------------------------------------------------------------------

/// A particle of sand at a pressure in a cell of half a metre, whose volume grows at a rate [1/s], with b = 0.4 and without.
struct Damped {
  double without = 0, with = 0;  ///< pressure times volume [J]
  TileSums sums;
  double stiffness = 0;  ///< times volume [J]
};
Damped damped(double p0, double rate) {
  const Simsand law = case_1_sand();
  const CellFinder<2> cells{{0, 0}, 2, {0, 0}};
  Damped found;
  for (const double b : {0.0, 0.4}) {
    auto p = particles_at<2>({{0.2, 0.2}}, {state_size<Simsand>});
    p.reference_volume()[0] = 2;
    p.mass()[0] = 3000;
    set_state<Simsand>(p, 0, isotropic_state(law, p0, 0.8));
    Scratch scratch;
    const ScratchView s = scratch_of(scratch, 1);
    s.gradient[0][0][0] = s.gradient[1][1][0] = rate / 2;
    TileSums sums;
    update_stress<double, false>(law, p.view(), {0, 1}, cells, {1e-6, {}, true, false, b}, s, sums);
    (b > 0 ? found.with : found.without) = -(s.flux[0][0] + s.flux[1][0] + s.flux[2][0]) / 3;
    if (b > 0) found.sums = sums;
    found.stiffness = s.stiffness[0];
  }
  return found;
}

TEST(BulkViscosity, PressesOnWhatClosesWithItsImpedanceTimesAShareOfTheCell) {
  // q V = 0.4 h sqrt(M m V) 0.1/s with h = 0.5 m, the stiffness M V and the mass 3000 kg
  const Damped d = damped(1e4, -0.1);
  const double damping = 0.4 * 0.5 * std::sqrt(d.stiffness * 3000);
  EXPECT_NEAR(d.with - d.without, damping * 0.1, 1e-9 * damping);
  EXPECT_NEAR(d.sums[Sum::viscous_work], 1e-6 * damping * 0.1 * 0.1, 1e-9 * 1e-6 * damping);
  EXPECT_EQ(d.sums[Most::viscosity], 0) << "the step knows it from the waves at nodes";
}

TEST(BulkViscosity, HoldsBackWhatOpensAndNeverPulls) {
  const Damped slow = damped(1e4, 0.1);
  const double damping = 0.4 * 0.5 * std::sqrt(slow.stiffness * 3000);
  EXPECT_NEAR(slow.with - slow.without, -damping * 0.1, 1e-9 * damping);
  EXPECT_GT(slow.sums[Sum::viscous_work], 0);
  const Damped fast = damped(1e4, 50);
  EXPECT_GT(fast.without, 0);
  EXPECT_NEAR(fast.with, 0, 1e-9 * fast.without) << "as much as there is, no more";
  EXPECT_GT(fast.sums[Sum::viscous_work], 0);
}

TEST(BulkViscosity, IsNotWhereGrainsAreApartNorInMaterialOfGivenStiffness) {
  const Simsand law = case_1_sand();
  for (const bool elastic : {false, true}) {
    auto p = particles_at<2>({{0.5, 0.5}}, {std::max(state_size<Simsand>, state_size<LinearElastic>)});
    p.reference_volume()[0] = 2;
    p.mass()[0] = 3000;
    auto apart = isotropic_state(law, 1, 0.8);
    Simsand::impose_compression(apart, -0.1, 0.0);
    set_state<Simsand>(p, 0, apart);
    if (elastic) set_state<LinearElastic>(p, 0, {SymTensor<double>::zero(), 1});
    Scratch scratch;
    const ScratchView s = scratch_of(scratch, 1);
    s.gradient[0][0][0] = -0.1;
    TileSums sums;
    const StressUpdate how{1e-6, {}, true, false, 0.4};
    if (elastic)
      update_stress<double, false>(LinearElastic{1e6, 0.25}, p.view(), {0, 1}, unit_cells_of_tile, how, s, sums);
    else
      update_stress<double, false>(law, p.view(), {0, 1}, unit_cells_of_tile, how, s, sums);
    EXPECT_EQ(sums[Sum::viscous_work], 0) << elastic;
    EXPECT_EQ(sums[Most::viscosity], 0) << elastic;
    if (!elastic) {
      EXPECT_EQ(s.flux[0][0], 0);
    }
  }
}

// ---- gaps at rest ------------------------------------------------------------------------------------------------

/// A particle whose grains are apart by a volumetric strain `gap`, moving at `speed`, after so many steps of 1 ms in which
/// nothing is strained; things fall by half a cell in 1/`closing`.
struct Apart {
  Simsand law = case_1_sand();
  Particles<2> p = particles_at<2>({{0.5, 0.5}}, {state_size<Simsand>});
  TileSums sums;

  double gap() const { return -state_of<Simsand>(p, 0).x / law.growth_in_gap(); }
  void step(int n, double speed, double closing) {
    p.velocity(1)[0] = -speed;
    for (int k = 0; k < n; ++k) {
      Scratch scratch;
      sums = {};
      const StressUpdate how{1e-3, {}, true, false, 0.4, 0.1, closing};
      update_stress<double, false>(law, p.view(), {0, 1}, unit_cells_of_tile, how, scratch_of(scratch, 1), sums);
    }
  }
  explicit Apart(double strain) {
    auto state = isotropic_state(law, 1, 0.8);
    Simsand::impose_compression(state, -law.growth_in_gap() * strain, 0.0);
    set_state<Simsand>(p, 0, state);
  }
};

/// Soil of a cohesion c [Pa].
MohrCoulomb soil(double c) {
  MohrCoulomb law{};
  law.E = 1e6;
  law.nu = 0.25;
  law.c = c;
  law.phi = 0.5;
  law.psi = 0;
  law.prepare();
  return law;
}

TEST(GapsAtRest, CloseAsGrainsFallThroughThemAndThenTouch) {
  // s' = -c sqrt(s): from 0.04 after a time t it is (0.2 - c t/2)^2, and nothing after 2 0.2/c: 20 ms with c = 20/s.
  Apart material(0.04);
  material.step(10, 0.05, 20);
  EXPECT_NEAR(material.gap(), 0.01, 1e-12);
  EXPECT_EQ(material.sums[Sum::separated], 1);
  material.step(11, 0.05, 20);
  EXPECT_EQ(material.gap(), 0);
  EXPECT_EQ(material.sums[Sum::separated], 0);
  EXPECT_NEAR(material.law.void_ratio(state_of<Simsand>(material.p, 0)), 0.8, 1e-12) << "the skeleton is as it was";
  material.step(1, 0.05, 20);
  EXPECT_EQ(material.sums[Sum::separated], 0);
}

TEST(GapsAtRest, StayInWhatMovesAndWhereNothingFalls) {
  Apart flies(0.04), floats(0.04);
  flies.step(50, 0.15, 20);
  EXPECT_NEAR(flies.gap(), 0.04, 1e-12);
  floats.step(50, 0, 0);
  EXPECT_NEAR(floats.gap(), 0.04, 1e-12);
}

TEST(GapsAtRest, StayWhereCohesionSpansThem) {
  for (const double c : {0.0, 1e3}) {
    const MohrCoulomb law = soil(c);
    auto p = particles_at<2>({{0.5, 0.5}}, {state_size<MohrCoulomb>});
    const double open = law.closed() - 0.01;
    set_state<MohrCoulomb>(p, 0, {SymTensor<double>::isotropic(c > 0 ? -law.apex : 0), open, 0, std::exp(0.01)});
    for (int k = 0; k < 30; ++k) {
      Scratch scratch;
      TileSums sums;
      const StressUpdate how{1e-3, {}, true, false, 0.4, 0.1, 20};
      update_stress<double, false>(law, p.view(), {0, 1}, unit_cells_of_tile, how, scratch_of(scratch, 1), sums);
    }
    const auto after = state_of<MohrCoulomb>(p, 0);
    EXPECT_NEAR(after.compression, c > 0 ? open : 0, 1e-9) << c;
    EXPECT_NEAR(after.volume_ratio, c > 0 ? std::exp(0.01) : 1, 1e-9) << c << ": the volume goes with the gap";
  }
}

TEST(GapsAtRest, CloseByTheSameBitsInAPack) {
  const Granular law = case_1();
  const auto eleven = [&]<class R>(R) {
    auto p = particles_at<2>(std::vector<Vec<2>>(11), {state_size<Granular>});
    for (int i = 0; i < 11; ++i) {
      p.position(0)[i] = 0.3 * i;
      p.position(1)[i] = 0.5;
      p.velocity(0)[i] = 0.03 * i;
      auto state = isotropic_state(law, 10, 0.8);
      if (i % 3 != 0) Simsand::impose_compression(state.frictional, -0.3 * i, 0.0);
      set_state<Granular>(p, i, state);
    }
    Scratch scratch;
    TileSums sums;
    const StressUpdate how{1e-3, {}, true, false, 0.4, 0.1, 20};
    update_stress<R, false>(law, p.view(), {0, 11}, unit_cells_of_tile, how, scratch_of(scratch, 11), sums);
    std::vector<double> numbers{sums[Sum::separated]};
    for (int i = 0; i < 11; ++i)
      for (int k = 0; k < state_size<Granular>; ++k) numbers.push_back(p.state(k)[i]);
    return numbers;
  };
  EXPECT_EQ(eleven(0.0), eleven(Pack(0.0)));
}

// ---- sparse material ---------------------------------------------------------------------------------------------

TEST(SparseMaterial, HasToCloseToATenthOfTheRoomAroundItBeforeItCarries) {
  // Of four particles one fills 0.08 of the room: in 0.8 of that it would touch, after the strain -ln 0.8. One fills a fifth,
  // one has opened farther already, and one fills a fortieth: it gets the gap 0.3, not ln 4.
  const Granular law = case_1();
  auto p = particles_at<2>(std::vector<Vec<2>>(4, {0.5, 0.5}), {state_size<Granular>});
  const auto pressed = isotropic_state(law, 1e3, 0.8);
  auto wide = pressed;
  Simsand::impose_compression(wide.frictional, -5 * law.frictional.growth_in_gap(), 0.0);
  for (int i = 0; i < 4; ++i) {
    p.reference_volume()[i] = 2;
    set_state<Granular>(p, i, i == 2 ? wide : pressed);
  }
  Scratch scratch;
  const ScratchView s = scratch_of(scratch, 4);
  std::copy_n(std::array{0.08, 0.2, 0.025, 0.025}.begin(), 4, s.filling);
  const double lost = open_sparse(law, p.view(), {0, 4}, s);
  const auto volume = [&](int i) { return law.specific_volume(state_of<Granular>(p, i)); };
  EXPECT_NEAR(volume(0), law.specific_volume(pressed) / 0.8, 1e-12);
  EXPECT_NEAR(volume(3), law.specific_volume(pressed) * std::exp(0.3), 1e-12);
  EXPECT_EQ(pressure(law.total_stress(state_of<Granular>(p, 0))), 0);
  EXPECT_EQ(state_of<Granular>(p, 1).frictional.x, pressed.frictional.x);
  EXPECT_EQ(state_of<Granular>(p, 2).frictional.x, wide.frictional.x);
  EXPECT_NEAR(lost, 2 * 2 * law.specific_volume(pressed) * law.elastic_energy(pressed), 1e-14) << "of two, 2 m3 each";
  EXPECT_GT(lost, 0);
}

TEST(SparseMaterial, OfCohesiveSoilStaysTogether) {
  for (const double c : {0.0, 1e3}) {
    const MohrCoulomb law = soil(c);
    auto p = particles_at<2>({{0.5, 0.5}}, {state_size<MohrCoulomb>});
    set_state<MohrCoulomb>(p, 0, {SymTensor<double>::zero(), 0, 0, 1});
    Scratch scratch;
    const ScratchView s = scratch_of(scratch, 1);
    s.filling[0] = 0.08;
    open_sparse(law, p.view(), {0, 1}, s);
    EXPECT_NEAR(state_of<MohrCoulomb>(p, 0).compression, c > 0 ? 0 : std::log(0.8), 1e-15) << c;
    EXPECT_NEAR(state_of<MohrCoulomb>(p, 0).volume_ratio, c > 0 ? 1 : 1.25, 1e-15) << c << ": it takes its room";
  }
}

// ---- packs -------------------------------------------------------------------------------------------------------

/// Particles of a law in a row, in a motion of their own each.
template <class Law>
struct RowOfParticles {
  Particles<2> p;
  Scratch scratch;
  ScratchView s;
  TileSums sums;

  RowOfParticles(const Law& law, double p0, int n)
      : p(particles_at<2>(std::vector<Vec<2>>(std::size_t(n)), {state_size<Law>})), s(scratch_of(scratch, n)) {
    for (int i = 0; i < n; ++i) {
      p.position(0)[i] = 0.3 * i;
      p.position(1)[i] = 0.5;
      p.reference_volume()[i] = 1 + 0.1 * i;
      auto state = isotropic_state(law, p0 * (1 + 0.2 * i), 0.8);
      if constexpr (AveragesPressure<Law>)
        if (i % 4 == 1) contacts(law).impose_compression(contacts(state), -0.01 * i, 0.0);
      set_state<Law>(p, i, state);
      for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b) s.gradient[a][b][i] = 0.01 * std::sin(1 + i + 3 * a + 7 * b);
    }
  }
};

template <class Law>
void expect_packs_have_the_bits_of_one(const Law& law, double p0, int n) {
  for (const bool average : {false, true})
    for (const bool f_bar : {false, true}) {
      RowOfParticles<Law> one(law, p0, n), pack(law, p0, n);
      const StressUpdate how{1e-3, {}, average, f_bar, 0.4};
      if (f_bar) {
        update_stress<double, true>(law, one.p.view(), {0, n}, unit_cells_of_tile, how, one.s, one.sums);
        update_stress<Pack, true>(law, pack.p.view(), {0, n}, unit_cells_of_tile, how, pack.s, pack.sums);
      } else {
        update_stress<double, false>(law, one.p.view(), {0, n}, unit_cells_of_tile, how, one.s, one.sums);
        update_stress<Pack, false>(law, pack.p.view(), {0, n}, unit_cells_of_tile, how, pack.s, pack.sums);
      }
      for (int i = 0; i < n; ++i) {
        for (int k = 0; k < state_size<Law>; ++k)
          EXPECT_EQ(one.p.state(k)[i], pack.p.state(k)[i]) << Law::name << " state " << k;
        for (int c = 0; c < 6; ++c) EXPECT_EQ(one.s.flux[c][i], pack.s.flux[c][i]) << Law::name;
        EXPECT_EQ(one.s.stiffness[i], pack.s.stiffness[i]) << Law::name;
      }
      for (const Sum sum : {Sum::elastic, Sum::averaging, Sum::internal_work, Sum::viscous_work, Sum::plastic_work,
                            Sum::returned_work, Sum::separated, Sum::unconverged, Sum::faulty})
        EXPECT_NEAR(one.sums[sum], pack.sums[sum], 1e-12 * std::abs(one.sums[sum])) << Law::name << int(sum);
      EXPECT_EQ(one.sums[Most::viscosity], pack.sums[Most::viscosity]);
    }
}

TEST(Stress, APackHasTheBitsOfItsParticlesOneByOne) {
  // 11 particles are not whole packs, 139 are more than go through a part of the step at a time
  for (const int n : {11, 139}) {
    expect_packs_have_the_bits_of_one(case_1(), 1e4, n);
    expect_packs_have_the_bits_of_one(case_1_sand(), 1e4, n);
    expect_packs_have_the_bits_of_one(LinearElastic{1e6, 0.3}, 1e4, n);
    expect_packs_have_the_bits_of_one(NewtonianFluid{1e6, 3}, 1e4, n);
  }
}

// ---- means over a cell -------------------------------------------------------------------------------------------

TEST(MeansOverCells, CellsAreCountedInTheTileAndPlacesBesideItAreInItsNearest) {
  const CellFinder<2> cells{{1, 1}, 2, {1, 0}};  // cells of half a metre from (1, 1): the tile spans x 3 to 5, y 1 to 3
  FourPlaces<2> x;
  const double at[4][2] = {{3.1, 1.1}, {4.9, 2.6}, {2.95, 1.6}, {5.1, 3.05}};
  for (int lane = 0; lane < 4; ++lane)
    for (int a = 0; a < 2; ++a) x[a].set(lane, at[lane][a]);
  const Quad cell = cells.at(x);
  EXPECT_EQ(cell[0], 0);
  EXPECT_EQ(cell[1], 3 + 4 * 3);
  EXPECT_EQ(cell[2], 0 + 4 * 1);
  EXPECT_EQ(cell[3], 3 + 4 * 3);
}

TEST(MeansOverCells, ParticlesOfACellHaveTheMeanPressureWeightedWithTheirVolumesAndKeepTheirCompression) {
  // Two at 10 and 40 kPa in one cell, volumes 1 and 3, one at 90 kPa alone. Nothing moves. x is a root of p: the energy of
  // compression is not that of the mean pressure, and stays.
  const Simsand law = case_1_sand();
  auto p = particles_at<2>({{0.2, 0.5}, {0.7, 0.5}, {1.5, 0.5}}, {state_size<Simsand>});
  const double pressures[3] = {1e4, 4e4, 9e4}, volumes[3] = {1, 3, 2};
  double x[3], energy = 0;
  for (int i = 0; i < 3; ++i) {
    const auto state = isotropic_state(law, pressures[i], 0.8);
    p.reference_volume()[i] = volumes[i] / law.specific_volume(state);
    x[i] = Simsand::compression(state);
    energy += volumes[i] * law.elastic_energy(state);
    set_state<Simsand>(p, i, state);
  }
  Scratch scratch;
  const ScratchView s = scratch_of(scratch, 3);
  TileSums sums;
  update_stress<double, false>(law, p.view(), {0, 3}, unit_cells_of_tile, {1e-3, {}, true, false, 0}, s, sums);
  const double law_accuracy = 2e-8;  // of the return mapping
  const double means[3] = {(1e4 + 3 * 4e4) / 4, (1e4 + 3 * 4e4) / 4, 9e4};
  for (int i = 0; i < 3; ++i) {
    const auto state = state_of<Simsand>(p, i);
    EXPECT_NEAR(pressure(state.stress), means[i], law_accuracy * means[i]) << i;
    EXPECT_NEAR(state.x, x[i], law_accuracy * x[i]) << i;
    EXPECT_NEAR(s.flux[0][i], -volumes[i] * means[i], law_accuracy * volumes[i] * means[i]) << i;
  }
  EXPECT_NEAR(sums[Sum::elastic], energy, law_accuracy * energy);
  EXPECT_NEAR(sums[Sum::averaging], 0, law_accuracy * energy);
}

/// Two particles of one cell of unit volume, one under 10 kPa and one opened by a volumetric strain of 0.02, after so many steps
/// of 1 ms at a rate of volume change of both, gaps spreading at the rate `closing`.
struct PressedAndOpen {
  Simsand law = case_1_sand();
  Particles<2> p = particles_at<2>({{0.2, 0.5}, {0.7, 0.5}}, {state_size<Simsand>});
  TileSums sums;  ///< of the last step
  double averaging = 0;

  PressedAndOpen() {
    for (const bool open : {false, true}) {
      auto state = isotropic_state(law, 1e4, 0.8);
      if (open) Simsand::impose_compression(state, -0.02 * law.growth_in_gap(), 0.0);
      p.reference_volume()[open] = 1 / law.specific_volume(state);
      p.velocity(0)[open] = 1;
      set_state<Simsand>(p, open, state);
    }
  }
  void step(int n, double rate, double closing = 0) {
    for (int k = 0; k < n; ++k) {
      Scratch scratch;
      const ScratchView s = scratch_of(scratch, 2);
      for (int i = 0; i < 2; ++i)
        for (int a = 0; a < 3; ++a) s.gradient[a][a][i] = rate / 3;
      sums = {};
      update_stress<double, false>(law, p.view(), {0, 2}, unit_cells_of_tile, {1e-3, {}, true, false, 0, 0.1, closing},
                                   s, sums);
      averaging += sums[Sum::averaging];
    }
  }
  Simsand::State<double> state(bool open) const { return state_of<Simsand>(p, open); }
  double volume(bool open) const { return p.reference_volume()[open] * law.specific_volume(state(open)); }
  double gap() const { return -state(true).x / law.growth_in_gap(); }
};

TEST(MeansOverCells, WhatHasOpenedCarriesItsShareOfThePressureAndKeepsItsGap) {
  PressedAndOpen cell;
  cell.step(1, 0);
  for (const bool open : {false, true}) EXPECT_NEAR(pressure(cell.state(open).stress), 5e3, 1e-3) << open;
  EXPECT_NEAR(cell.gap(), 0.02, 1e-9);
  EXPECT_EQ(cell.sums[Sum::separated], 0) << "both carry";
}

TEST(MeansOverCells, TheVolumeOfEachFollowsTheStrainWhateverItsGap) {
  PressedAndOpen cell;
  cell.step(30, -1);  // by 0.03: closes the gap of 0.02, if nothing else gives way
  for (const bool open : {false, true}) EXPECT_NEAR(cell.volume(open), std::exp(-0.03), 1e-12) << open;
  EXPECT_GT(cell.state(true).x, 0);
  cell.step(60, 1);
  for (const bool open : {false, true}) EXPECT_NEAR(cell.volume(open), std::exp(0.03), 1e-12) << open;
  for (const bool open : {false, true}) EXPECT_EQ(pressure(cell.state(open).stress), 0) << open;
}

TEST(MeansOverCells, CompressionAndExpansionGiveBackWhatTheyStored) {
  // In small steps: what a step errs by falls with its length.
  PressedAndOpen cell;
  cell.step(1, 0);
  const double before = cell.sums[Sum::elastic];
  cell.step(1000, -1e-3);
  const double stored = cell.sums[Sum::elastic] - before;
  cell.averaging = 0;
  cell.step(1000, 1e-3);
  EXPECT_GT(stored, 0);
  EXPECT_NEAR(cell.sums[Sum::elastic], before, 2e-3 * stored);
  EXPECT_NEAR(cell.averaging, 0, 5e-3 * stored);
}

TEST(MeansOverCells, GapsSpreadOverACellInTheTimeInWhichGrainsFallThroughIt) {
  // At the rate 50/s, the room of both shares stays: V a (e^(x/a) - 1) or V x.
  PressedAndOpen cell;
  const double a = cell.law.growth_in_gap();
  const auto share = [&](bool open) { return detail::share_of_mean(cell.law, cell.state(open).x); };
  const double first[2] = {share(false), share(true)}, mean = 0.5 * (first[0] + first[1]);
  cell.step(1, 0, 50);
  for (const bool open : {false, true})
    EXPECT_NEAR(share(open), first[open] + 0.05 * (mean - first[open]), 1e-9 * a) << open;
  EXPECT_GT(cell.averaging, 0) << "it costs elastic energy";
}

TEST(MeansOverCells, AStoredEnergyIsThatOfTheOwnCompressionAndOfTheShearOfTheStress) {
  const Simsand law = case_1_sand();
  auto state = isotropic_state(law, 1e4, 0.8);
  state.stress.xy = 2e3;
  EXPECT_NEAR(stored_energy(law, state), law.elastic_energy(state), 1e-13 * law.elastic_energy(state));
  const double shear =
      law.energy_factor(state) * law.stored_in_shear(law.squared_shear(state), law.compression_per_pressure(1e4));
  auto open = state;
  open.x = -0.1;
  EXPECT_NEAR(stored_energy(law, open), shear, 1e-13 * shear);
}

TEST(MeansOverCells, WhatHasOpenedCountsByTheRoomThatClosesIt) {
  // a (e^(x/a) - 1) where it has opened, and back; what is pressed counts as it is
  const Simsand law = case_1_sand();
  const double a = law.growth_in_gap();
  EXPECT_EQ(detail::share_of_mean(law, 0.3), 0.3);
  EXPECT_NEAR(detail::share_of_mean(law, -0.5 * a), a * (std::exp(-0.5) - 1), 1e-15);
  for (const double x : {0.2, 0.0, -0.1 * a, -2 * a})
    EXPECT_NEAR(detail::compression_of_mean(law, detail::share_of_mean(law, x)), x, 1e-14);
  EXPECT_LT(detail::compression_of_mean(law, -1.5 * a), -100 * a) << "more than there is room for: wide open, finite";
}

TEST(FBar, ParticlesOfACellShareTheirRateOfVolumeChangeAndKeepTheirShear) {
  // Two particles in one cell, volumes 1 and 3, with tr L = 1 and 5: both are compressed as (1 + 3*5)/4 = 4 says. A
  // third one in the next cell is left alone.
  const LinearElastic law{1000, 0.25};
  Particles<2> p = particles_at<2>({{0.2, 0.5}, {0.7, 0.5}, {1.5, 0.5}}, {state_size<LinearElastic>});
  const double volumes[3] = {1, 3, 2}, rates[3] = {1, 5, 7};
  Scratch scratch;
  const ScratchView s = scratch_of(scratch, 3);
  for (int i = 0; i < 3; ++i) {
    p.reference_volume()[i] = volumes[i];
    set_state<LinearElastic>(p, i, {SymTensor<double>::zero(), 1});
    s.gradient[0][0][i] = rates[i];
    s.gradient[0][1][i] = 0.5 * i;
  }
  const double dt = 1e-3, K = law.bulk_modulus(), G = law.shear_modulus();
  TileSums sums;
  update_stress<2>(AnyLaw(law), p.view(), {0, 3}, unit_cells_of_tile, {dt, {}, false, true, 0}, s, sums);
  const double mean[3] = {4, 4, 7};
  for (int i = 0; i < 3; ++i) {
    const auto stress = state_of<LinearElastic>(p, i).stress;
    EXPECT_NEAR(pressure(stress), -K * dt * mean[i], 1e-12) << i;
    EXPECT_NEAR(stress.xx - stress.yy, 2 * G * dt * rates[i], 1e-9) << i;
  }
  // all the work that the law saw is stored
  EXPECT_NEAR(sums[Sum::internal_work], sums[Sum::elastic],
              0.03 * sums[Sum::elastic]);  // volumes grow by up to 1 % in the step
}

}  // namespace talus::stress_test
