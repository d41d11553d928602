#include "talus/case/estimate.hpp"

#include <cmath>

namespace talus {

namespace {

double estimated_particles(const BodySpec& body, int dim) {
  if (const auto* list = std::get_if<PointList>(&body.region)) return double(list->places.size());
  return body.spacing > 0 ? volume(body.region, dim) / std::pow(body.spacing, dim) : 0;
}

}  // namespace

double estimated_particles(const Case& case_) {
  double n = 0;
  for (const BodySpec& b : case_.bodies) n += estimated_particles(b, case_.dim);
  return n;
}

double estimated_bytes(const Case& case_) {
  double numbers = 0;
  for (const BodySpec& b : case_.bodies) {
    const double of_a_particle = std::visit(
        [&]<class Law>(const Law&) {
          // stored: place, velocity, mass, volume, id, state; seen: what every law tells, and what this one does
          double n = 2 * case_.dim + 3 + state_size<Law> +
                     (is_affine(case_.numerics.transfer) ? case_.dim * case_.dim : 0) + double(case_.loads.size());
          for (const Quantity& q : common_quantities) n += q.components;
          for (const Quantity& q : Law::quantities()) n += q.components;
          return n;
        },
        case_.materials[std::size_t(b.material)].law);
    numbers += estimated_particles(b, case_.dim) * of_a_particle;
  }
  return sizeof(double) * numbers;
}

}  // namespace talus
