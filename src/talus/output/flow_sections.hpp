#pragma once
/// What the report says of the thalweg and of gauges.

#include <optional>
#include <string>
#include <vector>

#include "talus/output/gauges.hpp"
#include "talus/output/thalweg_profile.hpp"

namespace talus {

/// As HTML; empty without a thalweg.
std::string thalweg_section(const std::optional<ThalwegRunout>& runout);
/// As HTML; empty without gauges.
std::string gauges_section(const std::vector<GaugeSummary>& gauges);

}  // namespace talus
