#include "talus/mpm/simulation.hpp"

#include <optional>
#include <stdexcept>

#include "talus/base/error.hpp"
#include "talus/mpm/inspect.hpp"
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

/// What `make` makes, if all owners succeed; else all throw what the first one found that did not.
template <class Make>
auto made_by_all(Backend& backend, Make make) {
  std::optional<decltype(make())> made;
  std::string mistake;
  try {
    made.emplace(make());
  } catch (const InputError& e) {
    mistake = e.what();
  }
  mistake = gather(backend, mistake);
  if (!mistake.empty()) throw InputError(mistake);
  return *std::move(made);
}

/// Of every body the part that this owner makes, until all are dealt out by place.
template <int Dim>
std::vector<Body<Dim>> make_bodies(const Case& case_, Backend& backend) {
  std::vector<Body<Dim>> bodies;
  const Overburden overburden(case_);
  const Part part{backend.owner(), backend.n_owners()};
  long n = 0;
  for (std::size_t b = 0; b < case_.bodies.size(); ++b) {
    bodies.push_back(made_by_all(backend, [&] { return make_body<Dim>(case_, int(b), overburden, n, part); }));
    n += sum_over_owners(backend, bodies.back().particles.size());
  }
  return bodies;
}

template <int Dim>
std::unique_ptr<Simulation> make(const Case& case_, Backend& backend) {
  std::vector<Body<Dim>> bodies = make_bodies<Dim>(case_, backend);
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
