#include "talus/mpm/start/body.hpp"

#include <algorithm>

#include "talus/base/error.hpp"
#include "talus/case/estimate.hpp"
#include "talus/mpm/inspect.hpp"
#include "talus/mpm/refinement.hpp"
#include "talus/mpm/start/filling.hpp"
#include "talus/mpm/start/surface_load.hpp"

namespace talus {

namespace {

/// The state that a law has at rest. A layer on a slope that is too steep for it starts with as much of its deviatoric
/// stress as it can bear.
template <class Law>
auto state_at_rest(const Law& law, InitialState initial, const BodySpec& spec) {
  auto state = law.at_rest(initial);
  if (!std::holds_alternative<std::string>(state) || !std::holds_alternative<SurfaceLayer>(spec.region)) return state;
  const SymTensor<double> stress = initial.stress;
  const double mean = (stress[0] + stress[1] + stress[2]) / 3;
  double least = 0, most = 1;  // shares of the deviatoric stress that it bears, and does not
  for (int k = 0; k < 20; ++k) {
    const double share = k == 0 ? 0 : 0.5 * (least + most);
    for (int c = 0; c < 6; ++c) initial.stress[c] = c < 3 ? mean + share * (stress[c] - mean) : share * stress[c];
    auto less = law.at_rest(initial);
    if (!std::holds_alternative<std::string>(less)) {
      state = std::move(less);
      least = share;
    } else if (k > 0) {
      most = share;
    } else {
      break;  // not even the mean
    }
  }
  return state;
}

/// Places, velocities, masses and states of the particles.
template <int Dim, class Law>
void set_particles(Particles<Dim>& p, const Law& law, const Case& case_, const BodySpec& spec, const Filling& filling,
                   const Overburden& overburden, long first_id) {
  const auto& [points, volumes, first, n_of_body, centre] = filling;
  const double density = bulk_density(case_.materials[spec.material], spec);
  for (int i = 0; i < p.size(); ++i) {
    const Vec<3> velocity = spec.velocity + cross(spec.angular_velocity, points[i] - centre);
    const auto state =
        state_at_rest(law,
                      initial_state(case_, spec, overburden.on(points[i], width_at_start(spec, volumes[i], Dim)).stress,
                                    overburden.slope_above(spec, points[i])),
                      spec);
    if (const auto* reason = std::get_if<std::string>(&state))
      throw InputError("body `" + spec.name + "` cannot rest under its initial stress: " + *reason);
    const auto& at_rest = std::get<typename Law::template State<double>>(state);
    for (int a = 0; a < Dim; ++a) {
      p.position(a)[i] = points[i][a];
      p.velocity(a)[i] = velocity[a];
    }
    p.mass()[i] = density * volumes[i];
    p.reference_volume()[i] = volumes[i] / law.specific_volume(at_rest);
    p.set_id(i, first_id + first + i);
    set_state<Law>(p, i, at_rest);
    if (p.memory().extent) {
      const double edge = width_at_start(spec, volumes[i], Dim);
      set_extent(p, i, SymTensor<double>::isotropic(edge * edge));
    }
    if (p.memory().modulus)
      p.wave_modulus()[i] = volumes[i] * stiffness_at_rest(law, at_rest, case_.numerics.integration);
  }
}

/// The areas that loads act on. `first`: the number in the body of its first particle here.
template <int Dim>
void set_loaded_areas(Body<Dim>& body, const Case& case_, const Filling& whole, long first) {
  for (std::size_t k = 0; k < body.loads.size(); ++k) {
    const std::vector<double> areas = loaded_areas(case_, body.loads[k], whole);
    if (std::ranges::none_of(areas, [](double area) { return area > 0; }))
      throw InputError("load `" + body.loads[k].name + "` finds nothing of its side of body `" + body.name + "`");
    std::copy_n(areas.begin() + first, body.particles.size(), body.particles.loaded_area(int(k)));
  }
}

}  // namespace

ParticleMemory memory_of(const Numerics& numerics, int n_state, int n_loads, bool flows) {
  return {n_state,
          numerics.transfer == Transfer::apic,
          numerics.transfer == Transfer::tpic,
          numerics.order == Order::musl || numerics.rest_tolerance > 0,
          n_loads,
          numerics.particle_splitting != Splitting::none && flows};
}

double estimated_bytes(const Case& case_, double share) {
  double numbers = 0;
  for (std::size_t b = 0; b < case_.bodies.size(); ++b) {
    const BodySpec& body = case_.bodies[b];
    const auto acts_here = [&](const SurfaceLoad& load) { return load.body == int(b); };
    const int n_loads = int(std::ranges::count_if(case_.loads, acts_here));
    const double of_a_particle = std::visit(
        [&]<class Law>(const Law&) {
          const ParticleLayout layout(case_.dim,
                                      memory_of(case_.numerics, state_size<Law>, n_loads, !keeps_neighbours(Law{})));
          double n = share * layout.n_columns();
          for (const Quantity& q : common_quantities) n += q.components;  // of a snapshot
          for (const Quantity& q : Law::quantities()) n += q.components;
          return n;
        },
        case_.materials[std::size_t(body.material)].law);
    numbers += estimated_particles(body, case_.dim) * of_a_particle;
  }
  return sizeof(double) * numbers;
}

template <int Dim>
Body<Dim> make_body(const Case& case_, int number, const Overburden& overburden, long first_id, Part part) {
  const BodySpec& spec = case_.bodies[number];
  const Filling filling = fill(case_, spec, part);
  if (filling.n_of_body == 0)
    throw InputError("body `" + spec.name + "` has no particles: its spacing is larger than the body");
  std::vector<SurfaceLoad> loads;
  for (const SurfaceLoad& load : case_.loads)
    if (load.body == number) loads.push_back(load);
  // The start is made by the law that the run goes on with, so that its elastic strains fit its stress.
  const AnyLaw scaled = with_scaled_stiffness(case_.materials[spec.material].law, case_.numerics.stiffness_factor);
  return std::visit(
      [&]<class Law>(const Law& law) {
        const ParticleMemory memory =
            memory_of(case_.numerics, state_size<Law>, int(loads.size()), !keeps_neighbours(Law{}));
        Body<Dim> body{spec.name, spec.spacing, scaled, Particles<Dim>(memory), {}, loads};
        body.particles.resize(filling.points.size());
        set_particles(body.particles, law, case_, spec, filling, overburden, first_id);
        if (!body.loads.empty())
          set_loaded_areas(body, case_, part.of == 1 ? filling : fill(case_, spec), filling.first);
        return body;
      },
      scaled);
}

template Body<2> make_body(const Case&, int, const Overburden&, long, Part);
template Body<3> make_body(const Case&, int, const Overburden&, long, Part);

}  // namespace talus
