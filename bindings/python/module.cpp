/// talus._solver: the compiled part of the Python package. The files of talus/ beside this one are what users see; they have
/// the documentation. Nothing here computes: results come from libtalus and libtalus_kernels, so they have the bits of the
/// command line.

#include <errno.h>  // program_invocation_name
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

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
#include "talus/case/material.hpp"
#include "talus/element/driver.hpp"
#include "talus/input/edited_text.hpp"
#include "talus/input/read.hpp"
#include "talus/input/read_law.hpp"
#include "talus/input/schema.hpp"
#include "talus/input/sections.hpp"
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
        backend_(talus::make_openmp(threads)),
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

/// Name, parameters and outputs of a law, from the keys of a [material] section. Complaints have no line: there is no file.
py::dict describe_law(const std::string& name, const std::string& text) {
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
  py::dict parameters, options, quantities;
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
