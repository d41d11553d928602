#include "talus/case/estimate.hpp"

#include <cmath>

namespace talus {

double estimated_particles(const BodySpec& body, int dim) {
  if (const auto* list = std::get_if<PointList>(&body.region)) return double(list->places.size());
  if (const auto* layer = std::get_if<SurfaceLayer>(&body.region)) return points_in(*layer);
  return body.spacing > 0 ? volume(body.region, dim) / std::pow(body.spacing, dim) : 0;
}

double estimated_particles(const Case& case_) {
  double n = 0;
  for (const BodySpec& b : case_.bodies) n += estimated_particles(b, case_.dim);
  return n;
}

}  // namespace talus
