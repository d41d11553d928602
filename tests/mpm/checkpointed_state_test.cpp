/// What a run hands out so that it can go on.

#include "talus/mpm/checkpointed_state.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <span>

#include "mpm/saved_state.hpp"
#include "mpm/small_model.hpp"

namespace talus::checkpointed_state_test {

/// A model of three particles on a floor that rubs, which has been through something.
struct Used {
  SmallModel<> small;
  Ledger ledger;
  StepTally tally;
  Carried carried;

  Used() : small(floor(), {{9.5, 1}, {1.5, 1.5}, {1.75, 1.5}}) { arrange(small.model); }

  static Domain<2> floor() {
    Domain<2> domain = unit_cells<2>(16);
    domain.walls[2] = Wall(WallKind::friction, 0.5, true);
    return domain;
  }
  SavedState save() const {
    const std::vector<StateArray> arrays = talus::save(small.model, ledger, tally, carried);
    SavedState all = in_memory(arrays);
    EXPECT_EQ(all.size(), arrays.size()) << "a name twice";
    return all;
  }
  void restore(const SavedState& saved) { talus::restore(small.model, ledger, tally, carried, reader_of(saved)); }
};

TEST(CheckpointedState, IsEveryColumnOfEveryBodyTheTilesAndTheLedger) {
  Used run;
  run.ledger.step = 7;
  run.carried.drift = 0.05;
  const SavedState saved = run.save();
  EXPECT_EQ(saved.at("ledger"), image_of(run.ledger));
  EXPECT_EQ(saved.at("carried")[0], 0.05);
  EXPECT_EQ(saved.at("tiles"), (std::vector<double>{0, 0, 1, 1, 1, 1, 2, 0, 1, 1, 1, 1}))
      << "place, first and last cell";
  EXPECT_EQ(saved.at("body 0: first particles of tiles"), (std::vector<double>{0, 2, 3})) << "and their number";
  std::vector<double> ids;
  for (const double number : saved.at("body 0: ids 0")) ids.push_back(std::bit_cast<ParticleIds>(number).id);
  EXPECT_EQ(ids, (std::vector<double>{1, 2, 0})) << "in the order they lie in";
  EXPECT_EQ(saved.at("body 0: position 0"), (std::vector<double>{1.5, 1.75, 9.5}));
  EXPECT_TRUE(saved.at("closed contacts").empty());
  const int n_columns = run.small.particles().layout().n_columns();
  EXPECT_EQ(int(saved.size()), 5 + 1 + n_columns);
}

TEST(CheckpointedState, ARunOfTheSameCaseGoesOnFromIt) {
  Used run, other;
  run.ledger.kinetic = 3;
  run.tally.longest = 2;
  run.carried.last_dt = 0.25;
  run.small.particles().velocity(0)[2] = 4;
  run.small.model.contacts[1].push_back(closed_contact(6, 2, true));
  const SavedState saved = run.save();
  EXPECT_EQ(saved.at("closed contacts"), (std::vector<double>{1, 6, 2, 1}));
  other.restore(saved);
  EXPECT_EQ(other.ledger.kinetic, 3);
  EXPECT_EQ(other.tally.longest, 2);
  EXPECT_EQ(other.carried.last_dt, 0.25);
  EXPECT_EQ(other.small.particles().velocity(0)[2], 4);
  ASSERT_EQ(other.small.model.contacts[1].size(), 1u);
  EXPECT_TRUE(other.small.model.contacts[1][0].sticks);
  EXPECT_EQ(other.save(), saved);
}

TEST(CheckpointedState, OfAnotherRunIsRefused) {
  Used run;
  SavedState saved = run.save();
  saved.at("body 0: mass 0").pop_back();
  EXPECT_THROW(run.restore(saved), std::runtime_error);
  saved = run.save();
  saved.at("ledger").pop_back();
  EXPECT_THROW(run.restore(saved), std::runtime_error);
  saved = run.save();
  for (auto& [name, values] : saved)
    if (name.starts_with("body 0: ") && values.size() == 3) values.resize(4);
  EXPECT_THROW(run.restore(saved), std::runtime_error) << "more particles than the case has";
  saved = run.save();
  saved.at("closed contacts") = {1e6, 0, 0, 0};
  EXPECT_THROW(run.restore(saved), std::runtime_error) << "of a tile that is not there";
}

}  // namespace talus::checkpointed_state_test
