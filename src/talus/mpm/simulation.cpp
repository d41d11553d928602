#include "talus/mpm/simulation.hpp"

#include <algorithm>
#include <stdexcept>

#include "talus/base/error.hpp"
#include "talus/mpm/inspect.hpp"
#include "talus/mpm/make_stepper.hpp"
#include "talus/mpm/start/overburden.hpp"
#include "talus/mpm/start/surface_load.hpp"

namespace talus {

namespace {

template <int Dim>
Body<Dim> make_body(const Case& what, int number, const Overburden& overburden, long first_id) {
  const BodySpec& spec = what.bodies[number];
  const Material& material = what.materials[spec.material];
  const Filling filling = fill(what, spec);
  const std::vector<Vec<3>>& points = filling.points;
  const std::vector<double>& volumes = filling.volumes;
  if (points.empty())
    throw InputError("body `" + spec.name + "` has no particles: its spacing is larger than the body");
  std::vector<SurfaceLoad> loads;
  for (const SurfaceLoad& load : what.loads)
    if (load.body == number) loads.push_back(load);
  // The start is made by the law that the run goes on with, so that its elastic strains fit its stress.
  const AnyLaw scaled = with_scaled_stiffness(material.law, what.numerics.stiffness_factor);
  return std::visit(
      [&]<class Law>(const Law& law) {
        const int n = int(points.size());
        const Numerics& numerics = what.numerics;
        const ParticleExtras extras{numerics.transfer == Transfer::apic, numerics.transfer == Transfer::tpic,
                                    numerics.order == Order::musl, int(loads.size())};
        Body<Dim> body{spec.name, spec.spacing, scaled, Particles<Dim>(state_size<Law>, extras), {}, loads};
        Particles<Dim>& p = body.particles;
        p.resize(n);
        const double density = bulk_density(material, spec);
        Vec<3> middle{};
        double whole = 0;
        for (int i = 0; i < n; ++i) {
          middle = middle + volumes[i] * points[i];
          whole += volumes[i];
        }
        middle = (1 / whole) * middle;
        for (int i = 0; i < n; ++i) {
          const Vec<3> velocity = spec.velocity + cross(spec.angular_velocity, points[i] - middle);
          const auto state = law.at_rest(
              initial_state(what, spec, overburden.on(points[i], width_at_start(spec, volumes[i], Dim)).stress));
          if (const auto* reason = std::get_if<std::string>(&state))
            throw InputError("body `" + spec.name + "` cannot rest under its initial stress: " + *reason);
          const auto& at_rest = std::get<typename Law::template State<double>>(state);
          for (int a = 0; a < Dim; ++a) {
            p.position(a)[i] = points[i][a];
            p.velocity(a)[i] = velocity[a];
          }
          p.mass()[i] = density * volumes[i];
          p.reference_volume()[i] = volumes[i] / law.specific_volume(at_rest);
          p.id()[i] = double(first_id + i);
          set_state<Law>(p, i, at_rest);
          if (extras.modulus) p.wave_modulus()[i] = volumes[i] * stiffness_at_rest(law, at_rest, numerics.integration);
        }
        for (std::size_t k = 0; k < loads.size(); ++k) {
          const std::vector<double> areas = loaded_areas(what, loads[k], filling);
          if (std::ranges::none_of(areas, [](double area) { return area > 0; }))
            throw InputError("load `" + loads[k].name + "` finds nothing of its side of body `" + spec.name + "`");
          std::ranges::copy(areas, p.loaded_area(int(k)));
        }
        return body;
      },
      scaled);
}

template <int Dim>
std::unique_ptr<Simulation> make(const Case& what, Loop& loop) {
  Domain<Dim> domain;
  Vec<Dim> gravity;
  domain.h = what.cell;
  domain.axisymmetric = what.axisymmetric;
  for (int a = 0; a < Dim; ++a) {
    domain.origin[a] = what.domain.min[a];
    domain.n_cells[a] = what.n_cells[a];
    domain.walls[2 * a] = what.walls[2 * a];
    domain.walls[2 * a + 1] = what.walls[2 * a + 1];
    gravity[a] = what.gravity[a];
  }
  domain.solids = what.solids;
  std::vector<Body<Dim>> bodies;
  const Overburden overburden(what);
  long n = 0;
  for (std::size_t b = 0; b < what.bodies.size(); ++b) {
    bodies.push_back(make_body<Dim>(what, int(b), overburden, n));
    n += bodies.back().particles.size();
  }
  const auto with = [&]<class Shape>(std::vector<Shape> shapes) {
    return make_stepper<Dim, Shape>(domain, std::move(bodies), std::move(shapes), gravity, what.numerics, loop);
  };
  switch (what.numerics.shape_function) {
    case ShapeFunction::quadratic: return with(std::vector<Quadratic>(bodies.size()));
    case ShapeFunction::linear: return with(std::vector<Linear>(bodies.size()));
    case ShapeFunction::cubic: return with(std::vector<Cubic>(bodies.size()));
    case ShapeFunction::ugimp: {
      std::vector<Ugimp> shapes;
      for (const Body<Dim>& body : bodies) shapes.emplace_back(0.5 * body.spacing / what.cell);
      return with(std::move(shapes));
    }
  }
  throw std::logic_error("unknown shape function");
}

}  // namespace

std::unique_ptr<Simulation> make_simulation(const Case& what, Loop& loop) {
  return what.dim == 3 ? make<3>(what, loop) : make<2>(what, loop);
}

}  // namespace talus
