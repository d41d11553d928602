#include "talus/mpm/simulation.hpp"

#include <stdexcept>

#include "talus/mpm/make_stepper.hpp"
#include "talus/mpm/start/body.hpp"

namespace talus {

namespace {

template <int Dim>
Domain<Dim> domain_of(const Case& case_) {
  Domain<Dim> domain;
  domain.h = case_.cell;
  domain.axisymmetric = case_.axisymmetric;
  for (int a = 0; a < Dim; ++a) {
    domain.origin[a] = case_.domain.min[a];
    domain.n_cells[a] = case_.n_cells[a];
    domain.walls[2 * a] = case_.walls[2 * a];
    domain.walls[2 * a + 1] = case_.walls[2 * a + 1];
  }
  return domain;
}

template <int Dim>
std::vector<Body<Dim>> make_bodies(const Case& case_) {
  std::vector<Body<Dim>> bodies;
  const Overburden overburden(case_);
  long n = 0;
  for (std::size_t b = 0; b < case_.bodies.size(); ++b) {
    bodies.push_back(make_body<Dim>(case_, int(b), overburden, n));
    n += bodies.back().particles.size();
  }
  return bodies;
}

template <int Dim>
std::unique_ptr<Simulation> make(const Case& case_, Backend& backend) {
  std::vector<Body<Dim>> bodies = make_bodies<Dim>(case_);
  Vec<Dim> gravity;
  for (int a = 0; a < Dim; ++a) gravity[a] = case_.gravity[a];
  const auto with = [&]<class Shape>(std::vector<Shape> shapes) {
    return make_stepper<Dim, Shape>(domain_of<Dim>(case_), std::move(bodies), std::move(shapes), gravity,
                                    case_.numerics, backend, case_.solids);
  };
  switch (case_.numerics.shape_function) {
    case ShapeFunction::quadratic: return with(std::vector<Quadratic>(bodies.size()));
    case ShapeFunction::linear: return with(std::vector<Linear>(bodies.size()));
    case ShapeFunction::cubic: return with(std::vector<Cubic>(bodies.size()));
    case ShapeFunction::ugimp: {
      std::vector<Ugimp> shapes;
      for (const Body<Dim>& body : bodies) shapes.emplace_back(0.5 * body.spacing / case_.cell);
      return with(std::move(shapes));
    }
  }
  throw std::logic_error("unknown shape function");
}

}  // namespace

std::unique_ptr<Simulation> make_simulation(const Case& case_, Backend& backend) {
  return case_.dim == 3 ? make<3>(case_, backend) : make<2>(case_, backend);
}

}  // namespace talus
