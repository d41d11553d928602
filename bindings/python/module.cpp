/// talus._solver: the compiled part of the Python package. The files of talus/ beside this one are what users see; they have
/// the documentation. Nothing here computes: results come from libtalus and libtalus_kernels, so they have the bits of the
/// command line.

#include <errno.h>  // program_invocation_name
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "talus/app/program.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/error.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/units.hpp"
#include "talus/case/material.hpp"
#include "talus/case/start_of_law.hpp"
#include "talus/element/driver.hpp"
#include "talus/input/edited_text.hpp"
#include "talus/input/read.hpp"
#include "talus/input/read_law.hpp"
#include "talus/input/schema.hpp"
#include "talus/input/sections.hpp"
#include "talus/law/point.hpp"
#include "talus/mpm/simulation.hpp"
#include "talus/output/outline.hpp"

namespace py = pybind11;

namespace {

using std::chrono::milliseconds;

py::object class_of_errors(const char* name) { return py::module_::import("talus._errors").attr(name); }

void translate_input_error(const talus::InputError& e) {
  py::list complaints;
  for (const talus::Complaint& c : e.complaints())
    complaints.append(class_of_errors("Complaint")(c.file, c.line, c.column, c.text));
  const py::object error = class_of_errors("InputError")(e.what(), complaints);
  PyErr_SetObject(class_of_errors("InputError").ptr(), error.ptr());
}

void translate_run_error(const talus::RunError& e) {
  const py::object error = class_of_errors("RunError")(e.what(), e.particle());
  PyErr_SetObject(class_of_errors("RunError").ptr(), error.ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const talus::InputError& e) {
    translate_input_error(e);
  } catch (const talus::RunError& e) {
    translate_run_error(e);
  }
}

/// Throws what a signal handler of Python has raised, such as KeyboardInterrupt. Without the GIL.
void throw_if_interrupted() {
  const py::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

/// A read-only array of numbers that belong to `owner`: nothing is copied, and they live as long as the array.
template <class Owner>
py::array view(std::shared_ptr<Owner> owner, const double* values, const std::vector<py::ssize_t>& shape) {
  auto* kept = new std::shared_ptr<Owner>(std::move(owner));
  const py::capsule base(kept, [](void* p) { delete static_cast<std::shared_ptr<Owner>*>(p); });
  py::array_t<double> array(shape, values, base);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

// ---- particles at an instant ---------------------------------------------------------------------------------------

class Particles {
 public:
  explicit Particles(talus::Observation seen) : seen_(std::make_shared<const talus::Observation>(std::move(seen))) {}

  double time() const { return seen_->time; }
  long step() const { return seen_->step; }
  int size() const { return seen_->n_particles(); }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const talus::Field& f : seen_->fields) all.push_back(f.name);
    return all;
  }
  bool has(const std::string& name) const { return seen_->find(name) != nullptr; }
  const talus::Field& field(const std::string& name) const {
    if (const talus::Field* f = seen_->find(name)) return *f;
    throw py::key_error(name);
  }
  py::array values(const std::string& name) const {
    const talus::Field& f = field(name);
    std::vector<py::ssize_t> shape{py::ssize_t(f.values.size()) / f.components};
    if (f.components > 1) shape.push_back(f.components);
    return view(seen_, f.values.data(), shape);
  }

 private:
  std::shared_ptr<const talus::Observation> seen_;
};

// ---- a run in steps ------------------------------------------------------------------------------------------------

/// Lets one thread at a time into a simulation; while it steps, others hold the GIL.
class Entry {
 public:
  explicit Entry(std::atomic<bool>& inside) : inside_(inside) {
    if (inside_.exchange(true)) throw std::runtime_error("another thread is in this simulation");
  }
  ~Entry() { inside_ = false; }
  Entry(const Entry&) = delete;
  Entry& operator=(const Entry&) = delete;

 private:
  std::atomic<bool>& inside_;
};

class Simulation {
 public:
  Simulation(const std::string& name, const std::string& text, const std::string& folder, int threads)
      : case_(talus::read_case_text(name, text, folder).case_),
        backend_(talus::make_threads(threads)),
        simulation_(talus::make_simulation(case_, *backend_)),
        outlines_(case_, simulation_->places()) {}

  void step(std::optional<double> until) {
    if (until && !std::isfinite(*until)) throw py::value_error("until is a time in s");
    const Entry entry(inside_);
    if (is_broken_) throw talus::RunError("the run has failed; it cannot go on");
    const py::gil_scoped_release others_may_run;
    auto asked = std::chrono::steady_clock::now();
    if (until && simulation_->ledger().time >= *until) return;
    do {
      particles_.reset();
      try {
        simulation_->step();
      } catch (const talus::RunError&) {
        is_broken_ = true;
        throw;
      }
      if (const auto now = std::chrono::steady_clock::now(); now - asked > milliseconds(50)) {
        asked = now;
        throw_if_interrupted();
      }
    } while (until && simulation_->ledger().time < *until);
  }

  Particles particles() {
    const Entry entry(inside_);
    if (!particles_) {
      const py::gil_scoped_release others_may_run;
      particles_.emplace(simulation_->observe());
    }
    return *particles_;
  }

  py::dict outline() {
    const Entry entry(inside_);
    const talus::Outline o = outlines_.find(simulation_->places());
    py::dict told;
    told["front_x_min"] = o.front_min[0];
    told["front_x_max"] = o.front_max[0];
    if (case_.dim == 3) {
      told["front_y_min"] = o.front_min[1];
      told["front_y_max"] = o.front_max[1];
    }
    if (case_.dim == 3 || case_.axisymmetric) told["front_radius"] = o.front_radius;
    told["height"] = o.height;
    told["height_at_axis"] = o.height_at_axis;
    return told;
  }

  py::dict energies() {
    const Entry entry(inside_);
    const talus::Ledger& l = simulation_->ledger();
    py::dict told;
    told["kinetic"] = l.kinetic;
    told["potential"] = l.potential;
    told["elastic"] = l.elastic;
    told["plastic"] = l.plastic;
    told["collisional"] = l.collisional;
    told["averaging"] = l.averaging;
    told["viscous"] = l.viscous;
    told["numerical"] = l.numerical;
    told["wall_friction"] = l.wall_friction;
    told["work_on_solids"] = l.wall_work;
    told["error"] = l.error();
    told["turnover"] = l.turnover;
    return told;
  }

  double time() const { return simulation_->ledger().time; }
  long n_steps() const { return simulation_->ledger().step; }
  double last_dt() const { return simulation_->ledger().dt; }
  long n_particles() {
    const Entry entry(inside_);
    return simulation_->n_particles();
  }
  double end() const { return case_.end; }
  int threads() const { return backend_->n_workers(); }
  std::string title() const { return case_.title; }

 private:
  talus::Case case_;
  std::unique_ptr<talus::Backend> backend_;
  std::unique_ptr<talus::Simulation> simulation_;
  talus::OutlineFinder outlines_;
  std::optional<Particles> particles_;  ///< of the present instant, once somebody has asked
  std::atomic<bool> inside_ = false;
  bool is_broken_ = false;
};

// ---- element tests -------------------------------------------------------------------------------------------------

/// Runs a function in a thread of its own and waits without the GIL. If Python is interrupted meanwhile, the thread goes on
/// alone and its result is dropped: a test of one point has no place to stop at.
template <class F>
auto run_aside(F f) {
  std::packaged_task<decltype(f())()> task(std::move(f));
  auto result = task.get_future();
  const py::gil_scoped_release others_may_run;
  std::thread(std::move(task)).detach();
  while (result.wait_for(milliseconds(50)) != std::future_status::ready) throw_if_interrupted();
  return result.get();
}

py::dict run_element_test(const std::string& name, const std::string& text, const std::string& folder) {
  const auto result = std::make_shared<const talus::ElementResult>(
      run_aside([=] { return talus::run_element_test(talus::read_element_test_text(name, text, folder).test); }));
  py::dict columns;
  for (std::size_t c = 0; c < result->names.size(); ++c) {
    py::array_t<double> column(py::ssize_t(result->rows.size()));
    for (std::size_t r = 0; r < result->rows.size(); ++r) column.mutable_at(py::ssize_t(r)) = result->rows[r][c];
    columns[py::str(result->names[c])] = py::make_tuple(column, result->units[c], result->meanings[c]);
  }
  py::dict told;
  told["columns"] = columns;
  told["failure"] = result->failure;
  told["n_updates"] = result->n_updates;
  told["n_unconverged"] = result->n_unconverged;
  return told;
}

// ---- laws ----------------------------------------------------------------------------------------------------------

/// A law from the keys of a [material] section. Complaints have no line: there is no file.
talus::AnyLaw law_from_text(const std::string& name, const std::string& text) {
  talus::AnyLaw any_law;
  try {
    talus::Document document(name, text);
    talus::Section section = talus::Section::root(document, &talus::material_declaration());
    any_law = talus::read_law(section, talus::Preset::standard);
    if (talus::needs_density(any_law) && section.has("density")) section.number(talus::keys::density);
    section.close("law `" + std::string(talus::name_of(any_law)) + "`");
    document.finish();
  } catch (const talus::InputError& e) {
    std::vector<talus::Complaint> complaints = e.complaints();
    for (talus::Complaint& c : complaints) c.line = c.column = 0;
    throw talus::InputError(complaints);
  }
  return any_law;
}

/// Parameters and outputs of a law.
py::dict describe_law(const std::string& name, const std::string& text) {
  talus::AnyLaw any_law = law_from_text(name, text);
  py::dict parameters, quantities;
  py::dict told;
  std::visit(
      [&]<class Law>(Law& law) {
        for (const auto& p : Law::parameters())
          parameters[py::str(std::string(p.key))] =
              py::make_tuple(double(p.value(law)), std::string(p.unit), std::string(p.meaning));
        for (const auto& q : Law::quantities())
          quantities[py::str(std::string(q.name))] =
              py::make_tuple(q.components, std::string(q.unit), std::string(q.meaning));
        told["meaning"] = std::string(Law::meaning);
      },
      any_law);
  told["parameters"] = parameters;
  told["quantities"] = quantities;
  return told;
}

py::list names_of_laws() {
  py::list names;
  talus::Laws::for_each([&]<class Law>() {
    if (talus::is_named<Law>) names.append(py::make_tuple(std::string(Law::name), std::string(Law::meaning)));
  });
  return names;
}

using Numbers = py::array_t<double, py::array::c_style>;

/// A law for points whose states are arrays, as in talus/law.h: tension-positive, xx yy zz xy yz zx, tensor shear strains.
/// All arrays are C-contiguous with a row per point; _element.py checks shapes and values.
class PointLaw {
 public:
  PointLaw(const std::string& name, const std::string& text) : law_(law_from_text(name, text)) {}

  py::list state_fields() const {
    py::list fields;
    for (const talus::StateField& f : talus::state_fields_of(law_))
      fields.append(py::make_tuple(std::string(f.name), f.components, std::string(f.unit), std::string(f.meaning)));
    return fields;
  }

  /// States at rest; `kappa` is NaN for the least that carries the stress.
  Numbers initial(const Numbers& stress, const Numbers& void_ratio, const Numbers& kappa, const Numbers& background,
                  const Numbers& strain_rate, const Numbers& collisional_stress) const {
    const py::ssize_t n = void_ratio.size(), size = talus::state_size_of(law_);
    Numbers states({n, size});
    for (py::ssize_t i = 0; i < n; ++i) {
      talus::InitialState start;
      start.stress = tensor(stress.data(i, 0));
      start.void_ratio = void_ratio.data()[i];
      if (const double k = kappa.data()[i]; !std::isnan(k)) start.kappa = k;
      start.background_pressure = background.data()[i];
      start.strain_rate = tensor(strain_rate.data(i, 0));
      start.collisional_stress = tensor(collisional_stress.data(i, 0));
      const std::string where = n > 1 ? "point " + std::to_string(i) + ": " : "";
      if (const std::string why = talus::fault_of_start(law_, start); !why.empty())
        throw talus::InputError(where + why);
      const auto numbers = talus::state_at_rest(law_, start);
      if (const auto* reason = std::get_if<std::string>(&numbers))
        throw talus::InputError(where + "the initial state is impossible: " + *reason);
      const auto& values = std::get<std::vector<double>>(numbers);
      std::copy(values.begin(), values.end(), states.mutable_data(i, 0));
    }
    return states;
  }

  /// Moves states in place. Columns of the result: outcome, stiffness, viscosity, work, plastic work, collisional work.
  /// With `tangents`, (points, 36) or empty, also writes the consistent tangents.
  Numbers update(Numbers states, const Numbers& strains, std::optional<Numbers> strain_rates, double dt,
                 const std::string& integrator, double tolerance, Numbers tangents) const {
    const talus::Integration how = integration(integrator, tolerance);
    const py::ssize_t n = states.shape(0), size = states.shape(1);
    Numbers rates = strain_rates ? *strain_rates : Numbers({n, py::ssize_t(6)});
    Numbers told({n, py::ssize_t(6)});
    double* const state = states.mutable_data();
    const double* const strain = strains.data();
    double* const rate = rates.mutable_data();
    double* const tangent = tangents.size() > 0 ? tangents.mutable_data() : nullptr;
    double* const out = told.mutable_data();
    const py::gil_scoped_release others_may_run;
    if (!strain_rates) {
      for (py::ssize_t i = 0; i < 6 * n; ++i) rate[i] = dt > 0 ? strain[i] / dt : 0;
      if (!(dt > 0)) dt = talus::long_time;  // infinitely slow
    }
    std::vector<talus::Response<double>> responses{std::size_t(n)};
    if (tangent)
      for (py::ssize_t i = 0; i < n; ++i)
        responses[std::size_t(i)] = talus::update_point_with_tangent(
            law_, state + i * size, {tensor(strain + 6 * i), tensor(rate + 6 * i), dt}, how, tangent + 36 * i);
    else
      talus::update_points(law_, int(n), state, strain, rate, dt, how, responses.data());
    for (py::ssize_t i = 0; i < n; ++i) {
      const talus::Response<double>& r = responses[std::size_t(i)];
      const double row[] = {r.outcome, r.stiffness, r.viscosity, r.work, r.plastic_work, r.collisional_work};
      std::copy(row, row + 6, out + 6 * i);
    }
    return told;
  }

  Numbers stress(const Numbers& states) const {
    return for_all(states, 6, [&](const double* state, double* to) {
      const talus::SymTensor<double> s = talus::stress_of_point(law_, state);
      for (int k = 0; k < 6; ++k) to[k] = s[k];
    });
  }
  Numbers elastic_energy(const Numbers& states) const {
    return for_all(states, 1,
                   [&](const double* state, double* to) { *to = talus::elastic_energy_of_point(law_, state); });
  }
  /// The quantities of the law, one after the other.
  Numbers quantities(const Numbers& states, const Numbers& strain_rates) const {
    int size = 0;
    std::visit(
        [&]<class Law>(const Law&) {
          for (const auto& q : Law::quantities()) size += q.components;
        },
        law_);
    const double* rate = strain_rates.data();
    return for_all(states, size, [&](const double* state, double* to) {
      talus::quantities_of_point(law_, state, tensor(rate), to);
      rate += 6;
    });
  }
  void rotate(Numbers states, const Numbers& Q) const {
    for (py::ssize_t i = 0; i < states.shape(0); ++i) {
      const double* q = Q.data(i, 0);
      talus::turn_point(law_, states.mutable_data(i, 0),
                        {{{q[0], q[1], q[2]}, {q[3], q[4], q[5]}, {q[6], q[7], q[8]}}});
    }
  }

 private:
  static talus::SymTensor<double> tensor(const double* a) { return {a[0], a[1], a[2], a[3], a[4], a[5]}; }

  static talus::Integration integration(const std::string& name, double tolerance) {
    for (std::size_t i = 0; i < std::size(talus::integrator_choices); ++i)
      if (talus::integrator_choices[i].word == name) return {talus::Integrator(i), tolerance};
    throw talus::InputError("integrator = \"" + name +
                            "\" must be `modified_euler`, `return_mapping` or `forward_euler`");
  }

  template <class F>
  static Numbers for_all(const Numbers& states, int components, F f) {
    Numbers out({states.shape(0), py::ssize_t(components)});
    for (py::ssize_t i = 0; i < states.shape(0); ++i) f(states.data(i, 0), out.mutable_data(i, 0));
    return out;
  }

  talus::AnyLaw law_;
};

/// The SI value of a text with a unit.
double to_si(const std::string& key, const std::string& text, const std::string& unit) {
  const auto value = talus::to_si(text, unit);
  if (const auto* why = std::get_if<std::string>(&value)) throw talus::InputError(key + " = \"" + text + "\" " + *why);
  return std::get<double>(value);
}

// ---- texts of cases ------------------------------------------------------------------------------------------------

py::list check_case(const std::string& name, const std::string& text, const std::string& folder) {
  std::vector<talus::Understood> understood;
  {
    const py::gil_scoped_release others_may_run;
    understood = talus::read_case_text(name, text, folder).understood;
  }
  py::list settings;
  for (const talus::Understood& u : understood)
    settings.append(py::make_tuple(u.path, u.value, u.by_default, u.meaning));
  return settings;
}

std::string with_value(const std::string& name, const std::string& text, const std::vector<std::string>& path,
                       const std::string& toml_value) {
  std::string key;
  for (const std::string& part : path) key += (key.empty() || part[0] == '[' ? "" : ".") + part;
  return talus::with_overrides(name, text, {talus::Override{key + " = " + toml_value, path, toml_value}});
}

int program(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = arguments;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  static std::string name = words.at(0);
  program_invocation_name = name.data();
  const py::gil_scoped_release others_may_run;
  return talus_program(int(words.size()), argv.data());
}

}  // namespace

PYBIND11_MODULE(_solver, m) {
  m.doc() = "The compiled part of talus; use the functions of `talus`.";
  py::register_exception_translator(translate);

  m.def("version", &talus::version);
  m.def("build", &talus::build);
  m.def("program", &program, py::arg("arguments"));
  m.def("check_case", &check_case, py::arg("name"), py::arg("text"), py::arg("folder"));
  m.def("with_value", &with_value, py::arg("name"), py::arg("text"), py::arg("path"), py::arg("toml_value"));
  m.def("without_key", &talus::without_key, py::arg("name"), py::arg("text"), py::arg("path"));
  m.def("with_absolute_paths", &talus::with_absolute_paths, py::arg("name"), py::arg("text"), py::arg("folder"));
  m.def("describe_law", &describe_law, py::arg("name"), py::arg("text"));
  m.def("names_of_laws", &names_of_laws);
  m.def("run_element_test", &run_element_test, py::arg("name"), py::arg("text"), py::arg("folder"));
  m.def("schema", [] { return talus::schema_of_inputs({}); });

  m.def("to_si", &to_si, py::arg("key"), py::arg("text"), py::arg("unit"));

  py::class_<PointLaw>(m, "PointLaw")
      .def(py::init<const std::string&, const std::string&>(), py::arg("name"), py::arg("text"))
      .def("state_fields", &PointLaw::state_fields)
      .def("initial", &PointLaw::initial, py::arg("stress"), py::arg("void_ratio"), py::arg("kappa"),
           py::arg("background_pressure"), py::arg("strain_rate"), py::arg("collisional_stress"))
      .def("update", &PointLaw::update, py::arg("states").noconvert(), py::arg("strains"), py::arg("strain_rates"),
           py::arg("dt"), py::arg("integrator"), py::arg("tolerance"), py::arg("tangents").noconvert())
      .def("stress", &PointLaw::stress, py::arg("states"))
      .def("elastic_energy", &PointLaw::elastic_energy, py::arg("states"))
      .def("quantities", &PointLaw::quantities, py::arg("states"), py::arg("strain_rates"))
      .def("rotate", &PointLaw::rotate, py::arg("states").noconvert(), py::arg("Q"));

  py::class_<Particles>(m, "Particles", "Particles of a simulation at one instant, in the order of their ids.")
      .def_property_readonly("time", &Particles::time, "Time of the instant [s].")
      .def_property_readonly("step", &Particles::step, "Number of steps before the instant.")
      .def("__len__", [](const Particles& p) { return p.names().size(); })
      .def("__iter__", [](const Particles& p) { return py::iter(py::cast(p.names())); })
      .def("__contains__", &Particles::has)
      .def(
          "__getitem__", &Particles::values, py::arg("name"),
          "Read-only array of a quantity, shape (particles,), (particles, 3) for vectors or (particles, 6) for tensors "
          "xx yy zz xy yz zx. It is a view: nothing is copied. It keeps the values of this instant, also after steps.")
      .def("keys", &Particles::names, "Names of the quantities.")
      .def(
          "unit", [](const Particles& p, const std::string& name) { return p.field(name).unit; }, py::arg("name"),
          "Unit of a quantity.")
      .def(
          "meaning", [](const Particles& p, const std::string& name) { return p.field(name).meaning; }, py::arg("name"),
          "Meaning of a quantity.")
      .def_property_readonly("count", &Particles::size, "Number of particles.")
      .def("__repr__", [](const Particles& p) {
        std::string names;
        for (const std::string& name : p.names()) names += (names.empty() ? "" : ", ") + name;
        return "<" + std::to_string(p.size()) + " particles at t = " + std::string(py::str(py::cast(p.time()))) +
               " s: " + names + ">";
      });

  py::class_<Simulation>(m, "Simulation")
      .def(py::init<const std::string&, const std::string&, const std::string&, int>(),
           py::call_guard<py::gil_scoped_release>(), py::arg("name"), py::arg("text"), py::arg("folder"),
           py::arg("threads"))
      .def("step", &Simulation::step, py::arg("until") = py::none())
      .def_property_readonly("particles", &Simulation::particles)
      .def_property_readonly("outline", &Simulation::outline)
      .def_property_readonly("energies", &Simulation::energies)
      .def_property_readonly("time", &Simulation::time)
      .def_property_readonly("n_steps", &Simulation::n_steps)
      .def_property_readonly("dt", &Simulation::last_dt)
      .def_property_readonly("n_particles", &Simulation::n_particles)
      .def_property_readonly("end", &Simulation::end)
      .def_property_readonly("threads", &Simulation::threads)
      .def_property_readonly("title", &Simulation::title);
}
