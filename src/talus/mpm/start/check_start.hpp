#pragma once
/// What is wrong with a case that shows only with its particles.

#include "talus/case/case.hpp"
#include "talus/case/mistake.hpp"

namespace talus {

/// Of a case that is right otherwise and resolved: bodies without particles, that cannot rest, that overlap or stand in
/// solids, loads that act on nothing, steps that are too long or too many. Of bodies with more than ten million particles
/// the solver says it when it makes them.
std::vector<Mistake> check_start(const Case& case_);

}  // namespace talus
