#pragma once
/// What a user should know of a case or of a run: notices and warnings.

#include <string>
#include <vector>

#include "talus/output/run_summary.hpp"

namespace talus {

/// Share of the energy released up to which the energy balance counts as closed.
inline constexpr double most_missed = 0.01;
/// Noise of the pressure in flow, as a share of its mean, above which a run warns.
inline constexpr double most_noise = 0.5;

/// Work that collisions return to shear, as a share of the energy released, above which a run warns.
inline constexpr double most_returned = 0.01;

/// Consequences of a scaled stiffness for a run; empty if it is not scaled.
std::string notice_of_stiffness(const Numerics& numerics);

/// What the preset of a case is, and where the case departs from it; empty for the standard one.
std::string notice_of_preset(const Case& case_);

/// That planes of symmetry leave only a part of the whole to be computed; empty if there are none.
std::string notice_of_symmetry(const Case& case_);

/// What has left a run through `outflow` sides, on terrain with the places on the map; empty if nothing has.
std::string notice_of_outflow(const RunSummary& run);

/// Lengths of the steps and what bounded them, in a sentence.
std::string in_words(const StepTally& tally);

/// Warnings that the numbers of a run call for.
std::vector<std::string> warnings_of(const Case& case_, const RunSummary& run);

}  // namespace talus
