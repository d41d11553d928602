/// The C interface of the laws, include/talus/law.h.

#include "talus/law.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "talus/base/error.hpp"
#include "talus/case/material.hpp"
#include "talus/case/start_of_law.hpp"
#include "talus/input/make_law.hpp"
#include "talus/law/point.hpp"

/// A field together with the texts that it points to.
struct FieldWithTexts {
  std::string name, unit, meaning;
  talus_field field;
};

struct talus_law {
  talus::AnyLaw law;
  talus::Integration integration{talus::Integrator::modified_euler, 1e-6};
  std::string name;
  std::vector<FieldWithTexts> state, quantities;
  size_t state_size = 0, quantities_size = 0;
};

namespace {

using namespace talus;

void write_message(const std::string& text, char* message, size_t size) {
  if (!message || size == 0) return;
  const size_t n = std::min(text.size(), size - 1);
  std::memcpy(message, text.data(), n);
  message[n] = 0;
}

/// Runs what may throw.
template <class F>
talus_status guarded(char* message, size_t size, F f) noexcept {
  try {
    write_message("", message, size);
    f();
    return TALUS_OK;
  } catch (const InputError& e) {
    write_message(e.what(), message, size);
    return TALUS_INPUT_ERROR;
  } catch (const std::exception& e) {
    write_message(e.what(), message, size);
  } catch (...) {
    write_message("unknown failure", message, size);
  }
  return TALUS_FAILURE;
}

template <class Field>
std::vector<FieldWithTexts> with_texts(const Field& fields, size_t& size) {
  std::vector<FieldWithTexts> all;
  for (const auto& f : fields) {
    all.push_back({std::string(f.name), std::string(f.unit), std::string(f.meaning), {}});
    all.back().field.components = f.components;
    size += size_t(f.components);
  }
  for (FieldWithTexts& f : all) f.field = {f.name.c_str(), f.unit.c_str(), f.meaning.c_str(), f.field.components};
  return all;
}

SymTensor<double> tensor(const double* a) { return {a[0], a[1], a[2], a[3], a[4], a[5]}; }
void write(const SymTensor<double>& a, double* to) {
  for (int i = 0; i < 6; ++i) to[i] = a[i];
}

/// The motion of a step whose strain rate may be left out.
Motion<double> motion_of(const double* strain, const double* strain_rate, double dt) {
  Motion<double> motion{tensor(strain), SymTensor<double>::zero(), dt};
  if (strain_rate)
    motion.strain_rate = tensor(strain_rate);
  else if (dt > 0)
    for (int i = 0; i < 6; ++i) motion.strain_rate[i] = strain[i] / dt;
  else
    motion.dt = long_time;
  return motion;
}

void write_response(const talus_law* law, const double* state, const Response<double>& r, talus_response* response) {
  if (!response) return;
  write(stress_of_point(law->law, state), response->stress);
  response->elastic_energy = elastic_energy_of_point(law->law, state);
  response->work = r.work;
  response->plastic_work = r.plastic_work;
  response->collisional_work = r.collisional_work;
  response->stiffness = r.stiffness;
  response->viscosity = r.viscosity;
  response->outcome = int(r.outcome);
  response->reserved = 0;
}

const talus_field* field_at(const std::vector<FieldWithTexts>& fields, size_t i) {
  return i < fields.size() ? &fields[i].field : nullptr;
}

}  // namespace

const char* talus_law_version(void) { return TALUS_LAW_VERSION; }

talus_status talus_law_make(const char* name, const talus_setting* settings, size_t n_settings, talus_law** law,
                            char* message, size_t message_size) {
  if (law) *law = nullptr;
  return guarded(message, message_size, [&] {
    if (!name || !law || (n_settings > 0 && !settings))
      throw InputError("talus_law_make: name, settings or law is null");
    std::vector<LawSetting> list;
    for (size_t i = 0; i < n_settings; ++i) {
      if (!settings[i].key) throw InputError("talus_law_make: a setting has no key");
      list.push_back({settings[i].key, settings[i].number});
      if (settings[i].text) list.back().value = std::string(settings[i].text);
    }
    auto made = std::make_unique<talus_law>();
    made->law = make_law(name, list);
    made->name = name_of(made->law);
    made->state = with_texts(state_fields_of(made->law), made->state_size);
    made->quantities = with_texts(quantities_of(made->law), made->quantities_size);
    *law = made.release();
  });
}

void talus_law_free(talus_law* law) { delete law; }

talus_status talus_law_set_integrator(talus_law* law, talus_integrator integrator, double tolerance, char* message,
                                      size_t message_size) {
  return guarded(message, message_size, [&] {
    const int scheme = int(integrator);
    if (scheme < 0 || scheme > int(TALUS_FORWARD_EULER)) throw InputError("integrator must be 0, 1 or 2");
    if (!(tolerance >= 1e-12 && tolerance <= 0.1)) throw InputError("tolerance must be between 1e-12 and 0.1");
    law->integration = {Integrator(scheme), tolerance};
  });
}

const char* talus_law_name(const talus_law* law) { return law->name.c_str(); }

size_t talus_law_state_size(const talus_law* law) { return law->state_size; }
size_t talus_law_state_fields(const talus_law* law) { return law->state.size(); }
const talus_field* talus_law_state_field(const talus_law* law, size_t field) { return field_at(law->state, field); }

size_t talus_law_quantities_size(const talus_law* law) { return law->quantities_size; }
size_t talus_law_quantities(const talus_law* law) { return law->quantities.size(); }
const talus_field* talus_law_quantity(const talus_law* law, size_t quantity) {
  return field_at(law->quantities, quantity);
}
void talus_law_evaluate(const talus_law* law, const double* state, const double* strain_rate, double* values) {
  quantities_of_point(law->law, state, strain_rate ? tensor(strain_rate) : SymTensor<double>::zero(), values);
}

void talus_initial_defaults(talus_initial* initial) {
  *initial = {};
  initial->kappa = std::numeric_limits<double>::quiet_NaN();
}

talus_status talus_law_initial_state(const talus_law* law, const talus_initial* initial, double* state, char* message,
                                     size_t message_size) {
  return guarded(message, message_size, [&] {
    InitialState at_start;
    at_start.stress = tensor(initial->stress);
    at_start.void_ratio = initial->void_ratio;
    if (!std::isnan(initial->kappa)) at_start.kappa = initial->kappa;
    at_start.background_pressure = initial->background_pressure;
    at_start.strain_rate = tensor(initial->strain_rate);
    at_start.collisional_stress = tensor(initial->collisional_stress);
    if (const std::string why = fault_of_start(law->law, at_start); !why.empty()) throw InputError(why);
    const auto numbers = state_at_rest(law->law, at_start);
    if (const auto* reason = std::get_if<std::string>(&numbers))
      throw InputError("the initial state is impossible: " + *reason);
    const auto& values = std::get<std::vector<double>>(numbers);
    std::copy(values.begin(), values.end(), state);
  });
}

void talus_law_update(const talus_law* law, double* state, const double* strain, const double* strain_rate, double dt,
                      talus_response* response) {
  const Response<double> r = update_point(law->law, state, motion_of(strain, strain_rate, dt), law->integration);
  write_response(law, state, r, response);
}

void talus_law_update_many(const talus_law* law, size_t n, double* states, const double* strains,
                           const double* strain_rates, double dt, talus_response* responses) {
  constexpr size_t at_a_time = 64;
  Response<double> r[at_a_time];
  double rates[6 * at_a_time];
  for (size_t first = 0; first < n; first += at_a_time) {
    const size_t count = std::min(at_a_time, n - first);
    double dt_of_law = dt;
    for (size_t i = 0; i < count; ++i) {
      const Motion<double> m =
          motion_of(strains + 6 * (first + i), strain_rates ? strain_rates + 6 * (first + i) : nullptr, dt);
      write(m.strain_rate, rates + 6 * i);
      dt_of_law = m.dt;
    }
    double* some = states + first * law->state_size;
    update_points(law->law, int(count), some, strains + 6 * first, rates, dt_of_law, law->integration, r);
    for (size_t i = 0; responses && i < count; ++i)
      write_response(law, some + i * law->state_size, r[i], responses + first + i);
  }
}

void talus_law_update_with_tangent(const talus_law* law, double* state, const double* strain, const double* strain_rate,
                                   double dt, talus_response* response, double* tangent) {
  const Response<double> r =
      update_point_with_tangent(law->law, state, motion_of(strain, strain_rate, dt), law->integration, tangent);
  write_response(law, state, r, response);
}

void talus_law_stress(const talus_law* law, const double* state, double* stress) {
  write(stress_of_point(law->law, state), stress);
}
double talus_law_elastic_energy(const talus_law* law, const double* state) {
  return elastic_energy_of_point(law->law, state);
}
double talus_law_specific_volume(const talus_law* law, const double* state) {
  return specific_volume_of_point(law->law, state);
}

void talus_law_rotate(const talus_law* law, double* state, const double* Q) {
  turn_point(law->law, state, {{{Q[0], Q[1], Q[2]}, {Q[3], Q[4], Q[5]}, {Q[6], Q[7], Q[8]}}});
}
