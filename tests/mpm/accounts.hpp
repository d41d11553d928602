#pragma once
/// What surfaces have given, against the ledger.

#include <gtest/gtest.h>

#include "mpm/cases.hpp"

namespace talus {

/// Accounts of all surfaces add up to what the ledger has of walls and solids, to rounding.
inline void expect_accounts_add_up(const Simulation& s) {
  const Ledger& l = s.ledger();
  SurfaceAccount sum;
  double impulses = 0, heat = 0;
  for (const SurfaceAccount& account : s.surfaces()) {
    sum += account;
    impulses += length(account.impulse);
    heat += std::abs(account.friction);
  }
  const double exchanged = impulses + l.mass * cases::g * l.time;
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(sum.impulse[a], l.wall_impulse[a], 1e-11 * exchanged) << "axis " << a;
  EXPECT_NEAR(sum.friction, l.wall_friction, 1e-12 * heat);
}

}  // namespace talus
