#include "talus/mpm/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "talus/mpm/stress_update.hpp"

namespace talus {

namespace {

const Quantity& common(std::string_view name) {
  return *std::find_if(std::begin(common_quantities), std::end(common_quantities),
                       [&](const Quantity& q) { return q.name == name; });
}
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr Quantity place{"position", "m", 3, "place of the particle"};

/// A vector from its components along the axes; in 2D there is none along the third.
template <int Dim, class F>
Vec<3> from_components(F component) {
  Vec<3> v{};
  for (int a = 0; a < Dim; ++a) v[a] = component(a);
  return v;
}

/// What the states of some particles tell of them.
class PresentStates {
 public:
  static constexpr int most = 256;  ///< particles
  ScratchView view() {
    ScratchView s{};
    s.volume = volumes_;
    for (int c = 0; c < 6; ++c) s.flux[c] = fluxes_[c];
    s.cell = cells_;
    return s;
  }

 private:
  static constexpr int row = most + widest_pack;
  double volumes_[row], fluxes_[6][row];
  int cells_[row];
};

/// Calls f(rows) for parts of a range that `PresentStates` has room for.
template <class F>
void for_each_part(RowRange range, F f) {
  for (int begin = range.begin; begin < range.end; begin += PresentStates::most)
    f(RowRange{begin, std::min(range.end, begin + PresentStates::most)});
}

}  // namespace

template <int Dim>
void observe_body(const Body<Dim>& body, int number, const std::vector<SymTensor<double>>& rates, Backend& backend,
                  Observation& seen, const std::vector<std::string>& fields) {
  const Particles<Dim>& p = body.particles;
  const std::size_t first = seen.fields.empty() ? 0 : seen.find("id")->values.size(),
                    last = first + std::size_t(p.size());
  const auto is_wanted = [&](std::string_view name) {
    return fields.empty() || name == "position" || name == "id" ||
           std::find(fields.begin(), fields.end(), name) != fields.end();
  };
  const auto put = [&](const Quantity& q, auto evaluate) {
    if (!is_wanted(q.name)) return;
    auto field = std::find_if(seen.fields.begin(), seen.fields.end(), [&](const Field& f) { return f.name == q.name; });
    if (field == seen.fields.end()) {
      seen.fields.push_back({std::string(q.name), std::string(q.unit), std::string(q.meaning), q.components, {}});
      field = seen.fields.end() - 1;
    }
    const std::size_t n = std::size_t(q.components);
    field->values.resize(last * n, unknown);  // other bodies may not have it
    double* values = field->values.data() + first * n;
    for_each_of(backend, std::size_t(p.size()), [&](std::size_t i) { evaluate(int(i), values + i * n); });
  };
  put(place, [&](int i, double* v) {
    for (int a = 0; a < 3; ++a) v[a] = a < Dim ? p.position(a)[i] : 0;
  });
  put(common("velocity"), [&](int i, double* v) {
    for (int a = 0; a < 3; ++a) v[a] = a < Dim ? p.velocity(a)[i] : 0;
  });
  put(common("body"), [&](int, double* v) { *v = number; });
  put(common("id"), [&](int i, double* v) { *v = double(p.id(i)); });
  put(common("ancestor"), [&](int i, double* v) { *v = double(p.ancestor(i)); });
  put(common("mass"), [&](int i, double* v) { *v = p.mass()[i]; });
  put(common("shear_rate"), [&](int i, double* v) { *v = shear_rate(deviator(rates[i])); });
  if (p.memory().moment)
    put(common("spin"), [&](int i, double* v) {
      for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        v[a] = b < Dim && c < Dim ? p.mass()[i] * (p.affine(c, b)[i] - p.affine(b, c)[i]) : 0;
      }
    });
  std::visit(
      [&]<class Law>(const Law& law) {
        const auto state = [&](int i) { return state_of<Law>(p, i); };
        put(common("volume"), [&](int i, double* v) { *v = p.reference_volume()[i] * law.specific_volume(state(i)); });
        put(common("stress"), [&](int i, double* v) {
          const SymTensor<double> stress = Law::total_stress(state(i));
          for (int c = 0; c < 6; ++c) v[c] = stress[c];
        });
        put(common("p"), [&](int i, double* v) { *v = pressure(Law::total_stress(state(i))); });
        put(common("q"), [&](int i, double* v) { *v = von_mises(deviator(Law::total_stress(state(i)))); });
        for (const auto& q : Law::quantities())
          put(q, [&](int i, double* v) { q.evaluate(law, state(i), rates[i], v); });
      },
      body.law);
  for (Field& f : seen.fields) f.values.resize(last * std::size_t(f.components), unknown);
}

ObservedPart share_out(Backend& backend, Observation own) {
  const std::vector<double> ids = own.find("id")->values;
  const std::size_t n_owners = std::size_t(backend.n_owners());
  double last = 0;
  for (const double id : ids) last = std::max(last, id);
  last = largest_of_owners(backend, last);
  std::vector<std::vector<std::size_t>> rows(n_owners);  // of this owner's particles, by the owner of their part
  for (std::size_t i = 0; i < ids.size(); ++i)
    rows[std::min(n_owners - 1, std::size_t(ids[i] / (last + 1) * double(n_owners)))].push_back(i);
  const auto messages_of = [&](const std::vector<double>& values, std::size_t n) {
    std::vector<Message> messages(n_owners);
    for (std::size_t o = 0; o < n_owners; ++o) {
      messages[o].resize(rows[o].size() * n);
      double* to = messages[o].data();
      for (const std::size_t i : rows[o]) to = std::copy_n(values.data() + i * n, n, to);
    }
    return messages;
  };
  const std::vector<Message> ids_of_part = backend.exchange(messages_of(ids, 1));
  const RowsOfIds order(joined(ids_of_part));
  std::vector<std::vector<std::size_t>> places(n_owners);  // in the part, of the particles that each owner sends
  for (std::size_t o = 0; o < n_owners; ++o)
    for (const double id : ids_of_part[o]) places[o].push_back(order.row(id));
  ObservedPart part;
  int owner = 0;
  for (const Message& size : backend.gather({double(order.size())})) {
    if (owner++ < backend.owner()) part.first += std::size_t(size.front());
    part.n_all += std::size_t(size.front());
  }
  for (Field& f : own.fields) {
    const std::size_t n = std::size_t(f.components);
    std::vector<std::size_t> sizes;
    for (const Message& of_owner : ids_of_part) sizes.push_back(of_owner.size() * n);
    const std::vector<Message> all = backend.exchange_sized(messages_of(f.values, n), sizes);
    f.values.resize(order.size() * n);
    for (std::size_t o = 0; o < n_owners; ++o)
      for (std::size_t i = 0; i < places[o].size(); ++i)
        std::copy_n(all[o].data() + i * n, n, f.values.data() + places[o][i] * n);
  }
  part.seen = std::move(own);
  return part;
}

void gather(Backend& backend, Observation& seen) {
  const auto of_all = [&](std::vector<double>&& mine) {
    return backend.n_owners() == 1 ? std::move(mine) : joined(backend.gather_at_first(mine));
  };
  const std::vector<double> ids = of_all(std::vector(seen.find("id")->values));
  const RowsOfIds order(ids);
  std::vector<std::size_t> rows(ids.size());
  for_each_of(backend, rows.size(), [&](std::size_t i) { rows[i] = order.row(ids[i]); });
  for (Field& f : seen.fields) {
    const std::size_t n = std::size_t(f.components);
    const std::vector<double> all = of_all(std::move(f.values));
    f.values = std::vector<double>(all.size());
    for_each_of(backend, rows.size(), [&](std::size_t i) { std::copy_n(&all[i * n], n, &f.values[rows[i] * n]); });
  }
}

std::string gather(Backend& backend, const std::string& text) {
  if (backend.n_owners() == 1) return text;
  for (const Message& m : backend.gather(Message(text.begin(), text.end())))
    if (!m.empty()) {
      std::string first;
      for (double character : m) first += char(character);
      return first;
    }
  return "";
}

namespace {

/// Puts numbers of all owners' particles into the order of their tiles, for the first owner.
class GatheredByTiles {
 public:
  /// `tiles`: of each own tile its number in the run and how many particles it has.
  GatheredByTiles(Backend& backend, const std::vector<double>& tiles) : backend_(backend) {
    for_each_row(backend.gather_at_first(tiles), 2, [&](const double* tile) {
      const auto n = std::size_t(tile[1]);
      stretches_.push_back({tile[0], n_, n_ + n});
      n_ += n;
    });
    std::sort(stretches_.begin(), stretches_.end(), [](const auto& a, const auto& b) { return a.tile < b.tile; });
  }

  template <class T>
  void operator()(std::vector<T>& values) const {
    constexpr bool is_vector = std::is_same_v<T, Vec<3>>;
    std::vector<double> numbers;
    for (const T& value : values)
      if constexpr (is_vector)
        numbers.insert(numbers.end(), {value[0], value[1], value[2]});
      else
        numbers.push_back(double(value));
    const std::vector<double> all = joined(backend_.gather_at_first(numbers));
    values.clear();
    values.reserve(n_);
    for (const auto& [tile, begin, end] : stretches_)
      for (std::size_t i = begin; i < end; ++i)
        if constexpr (is_vector)
          values.push_back({all[3 * i], all[3 * i + 1], all[3 * i + 2]});
        else
          values.push_back(T(all[i]));
  }

 private:
  struct Stretch {
    double tile;
    std::size_t begin, end;  ///< of its particles among those of all owners, one owner after the other
  };
  Backend& backend_;
  std::vector<Stretch> stretches_;
  std::size_t n_ = 0;
};

}  // namespace

void gather(Backend& backend, const std::vector<double>& tiles, ParticlePlaces& own) {
  own.for_each_kind(GatheredByTiles(backend, tiles));
}

void gather(Backend& backend, const std::vector<double>& tiles, FlowPoints& own) {
  own.for_each_kind(GatheredByTiles(backend, tiles));
}

/// The present volume of a particle [m3].
template <class Law, int Dim>
double volume_of(const Law& law, const Particles<Dim>& p, int i) {
  return p.reference_volume()[i] * law.specific_volume(state_of<Law>(p, i));
}

template <int Dim>
void put_places_of(const Body<Dim>& body, RowRange range, bool axisymmetric, ParticlePlaces& all, std::size_t first) {
  const Particles<Dim>& p = body.particles;
  PresentStates present;
  const ScratchView s = present.view();
  for_each_part(range, [&](const RowRange& rows) {
    present_volumes(body.law, p.view(), rows, s);
    double* const size = s.volume;  // takes their place
    for (int i = 0; i < rows.size(); i += Pack::width) {
      const Pack radius = axisymmetric ? load<Pack>(p.position(0) + rows.begin + i, rows.size() - i) : Pack(1.0);
      store(size + i, size_of_particle(load<Pack>(s.volume + i), radius, Dim));
    }
    for (int i = rows.begin; i < rows.end; ++i, ++first) {
      all.places[first] = from_components<Dim>([&](int a) { return p.position(a)[i]; });
      all.sizes[first] = size[i - rows.begin];
      all.masses[first] = p.mass()[i];
      all.ancestors[first] = p.ancestor(i);
    }
  });
}

template <int Dim>
void put_flow_of(const Body<Dim>& body, RowRange range, double most_room, double room_at_start, FlowPoints& all,
                 std::size_t first) {
  const Particles<Dim>& p = body.particles;
  PresentStates present;
  const ScratchView s = present.view();
  for_each_part(range, [&](const RowRange& rows) {
    present_volumes(body.law, p.view(), rows, s);
    for (int i = rows.begin; i < rows.end; ++i, ++first) {
      const double mass = p.mass()[i];
      all.places[first] = from_components<Dim>([&](int a) { return p.position(a)[i]; });
      all.velocities[first] = from_components<Dim>([&](int a) { return p.velocity(a)[i]; });
      all.volumes[first] = std::min(s.volume[i - rows.begin], most_room * mass);
      all.masses[first] = mass;
      all.volumes_at_start[first] = room_at_start * mass;
    }
  });
}

template <int Dim>
void CellPressures<Dim>::add(const Body<Dim>& body, RowRange range, const Domain<Dim>& domain, const Index<Dim>& tile) {
  const Particles<Dim>& p = body.particles;
  const CellFinder<Dim> finder{domain.origin, 1 / domain.h, tile};
  PresentStates present;
  const ScratchView s = present.view();
  for_each_part(range, [&](const RowRange& rows) {
    present_volumes(body.law, p.view(), rows, s);
    present_stress(body.law, p.view(), rows, s);
    for (int i = 0; i < rows.size(); i += Pack::width)
      store_integers(s.cell + i, finder.at(p.view().template places<Pack>(rows.begin + i, rows.size() - i)));
    for (int i = 0; i < rows.size(); ++i) {
      const double volume = s.volume[i], energy = -(s.flux[0][i] + s.flux[1][i] + s.flux[2][i]) / 3;  // p V
      double speed2 = 0;
      for (int a = 0; a < Dim; ++a) speed2 += p.velocity(a)[rows.begin + i] * p.velocity(a)[rows.begin + i];
      Cell& cell = cells[std::size_t(s.cell[i])];
      cell.volume += volume;
      cell.pressure += energy;
      cell.squared += energy * energy / volume;
      cell.speed2 += volume * speed2;
    }
  });
}

template <int Dim>
TilePressure CellPressures<Dim>::sum(const Index<Dim>& tile) const {
  TilePressure all{{}, 0, 0, 0, 0};
  for (int a = 0; a < Dim; ++a) all.tile[a] = tile[a];
  for (const Cell& cell : cells) {
    if (!(cell.volume > 0)) continue;
    all.volume += cell.volume;
    all.pressure += cell.pressure;
    all.scatter += std::max(0.0, cell.squared - cell.pressure * cell.pressure / cell.volume);
    all.speed += cell.speed2;
  }
  if (!(all.volume > 0)) return all;
  all.pressure /= all.volume;
  all.scatter = std::sqrt(all.scatter / all.volume);
  all.speed = std::sqrt(all.speed / all.volume);
  return all;
}

template <int Dim>
std::string describe(const Body<Dim>& body, int i) {
  const Particles<Dim>& p = body.particles;
  std::string text = fmt::format("  particle {} of body `{}`\n", p.id(i), body.name);
  const auto line = [&](std::string_view name, const double* values, int n, std::string_view unit) {
    text += fmt::format("  {:<20} {:.6g} {}\n", name, fmt::join(values, values + n, ", "), unit == "1" ? "" : unit);
  };
  double x[Dim], v[Dim];
  for (int a = 0; a < Dim; ++a) {
    x[a] = p.position(a)[i];
    v[a] = p.velocity(a)[i];
  }
  line("position", x, Dim, "m");
  line("velocity", v, Dim, "m/s");
  std::visit(
      [&]<class Law>(const Law& law) {
        for (const auto& q : Law::quantities()) {
          double values[6];
          q.evaluate(law, state_of<Law>(p, i), SymTensor<double>::zero(), values);
          line(q.name, values, q.components, q.unit);
        }
      },
      body.law);
  return text;
}

template <int Dim>
std::vector<double> elastic_energies(const Body<Dim>& body, RowRange range) {
  const Particles<Dim>& p = body.particles;
  std::vector<double> energies;
  std::visit(
      [&]<class Law>(const Law& law) {
        for (int i = range.begin; i < range.end; ++i) {
          const auto state = state_of<Law>(p, i);
          energies.push_back(p.reference_volume()[i] * law.specific_volume(state) * stored_energy(law, state));
        }
      },
      body.law);
  return energies;
}

template <int Dim>
double largest_volume_per_mass(const Body<Dim>& body) {
  const Particles<Dim>& p = body.particles;
  double most = 0;
  std::visit(
      [&]<class Law>(const Law& law) {
        for (int i = 0; i < p.size(); ++i) most = std::max(most, volume_of(law, p, i) / p.mass()[i]);
      },
      body.law);
  return most;
}

template <int Dim>
double largest_acceleration_by_loads(const Body<Dim>& body) {
  double most = 0;
  for (std::size_t k = 0; k < body.loads.size(); ++k) {
    const SurfaceLoad& load = body.loads[k];
    double factor = load.factor.empty() ? 1 : 0;
    for (double f : load.factor.values) factor = std::max(factor, std::abs(f));
    const double stress = factor * std::sqrt(dot(load.traction, load.traction));
    for (int i = 0; i < body.particles.size(); ++i)
      most = std::max(most, stress * body.particles.loaded_area(int(k))[i] / body.particles.mass()[i]);
  }
  return most;
}

template <int Dim>
std::optional<Stiffening> contact_stiffening(const Body<Dim>& body) {
  const Particles<Dim>& p = body.particles;
  std::optional<Stiffening> stiffest;
  std::visit(
      [&]<class Law>(const Law& law) {
        if constexpr (StiffensFromNothing<Law>) {
          stiffest = {0, law.stiffening(0).power};
          for (int i = 0; i < p.size(); ++i) {
            const double v = law.specific_volume(state_of<Law>(p, i));
            Stiffening c2 = law.stiffening(v - 1);
            c2.factor *= p.reference_volume()[i] * v / p.mass()[i];
            if (c2.factor > stiffest->factor) stiffest = c2;
          }
        }
      },
      body.law);
  return stiffest;
}

template <int Dim>
FastestWave fastest_wave(const Body<Dim>& body, const Integration& how) {
  const Particles<Dim>& p = body.particles;
  double fastest2 = 0;
  int fastest = 0;
  std::visit(
      [&]<class Law>(const Law& law) {
        for (int i = 0; i < p.size(); ++i) {
          const auto state = state_of<Law>(p, i);
          const double volume = p.reference_volume()[i] * law.specific_volume(state);
          const double speed2 = stiffness_at_rest(law, state, how) * volume / p.mass()[i];
          if (speed2 <= fastest2) continue;
          fastest2 = speed2;
          fastest = i;
        }
      },
      body.law);
  return {std::sqrt(fastest2), fastest};
}

template void observe_body(const Body<2>&, int, const std::vector<SymTensor<double>>&, Backend&, Observation&,
                           const std::vector<std::string>&);
template void observe_body(const Body<3>&, int, const std::vector<SymTensor<double>>&, Backend&, Observation&,
                           const std::vector<std::string>&);
template void put_places_of(const Body<2>&, RowRange, bool, ParticlePlaces&, std::size_t);
template void put_places_of(const Body<3>&, RowRange, bool, ParticlePlaces&, std::size_t);
template void put_flow_of(const Body<2>&, RowRange, double, double, FlowPoints&, std::size_t);
template void put_flow_of(const Body<3>&, RowRange, double, double, FlowPoints&, std::size_t);
template struct CellPressures<2>;
template struct CellPressures<3>;
template std::string describe(const Body<2>&, int);
template std::string describe(const Body<3>&, int);
template std::vector<double> elastic_energies(const Body<2>&, RowRange);
template double largest_volume_per_mass(const Body<2>&);
template double largest_volume_per_mass(const Body<3>&);
template std::vector<double> elastic_energies(const Body<3>&, RowRange);
template double largest_acceleration_by_loads(const Body<2>&);
template double largest_acceleration_by_loads(const Body<3>&);
template std::optional<Stiffening> contact_stiffening(const Body<2>&);
template std::optional<Stiffening> contact_stiffening(const Body<3>&);
template FastestWave fastest_wave(const Body<2>&, const Integration&);
template FastestWave fastest_wave(const Body<3>&, const Integration&);

}  // namespace talus
