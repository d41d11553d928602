#include "talus/app/program.hpp"

#include <CLI/CLI.hpp>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <functional>
#include <new>
#include <system_error>

#include "talus/app/commands.hpp"
#include "talus/app/memory_limit.hpp"
#include "talus/app/processes.hpp"
#include "talus/base/error.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/text.hpp"
#include "talus/calibration/read_calibration.hpp"
#include "talus/input/schema.hpp"

namespace {

/// Word in the place of a subcommand, and the most similar subcommand.
int unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string_view> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  const std::string_view alike = talus::most_alike(word, names);
  std::fprintf(stderr, "talus: `%s` is not a command; %s\n", word.c_str(),
               alike.empty() ? ("commands are " + talus::any_of(names)).c_str()
                             : ("did you mean `" + std::string(alike) + "`?").c_str());
  return talus::exit_input;
}

void add_threads(CLI::App* command, int& threads, bool& force) {
  command->add_option("--threads", threads, "number of threads [one per processor]")->check(CLI::Range(1, 4096));
  command->add_flag("--force-threads", force, "use as many threads as given, also if there are fewer processors");
}

void add_set(CLI::App* command, std::vector<std::string>& set) {
  command
      ->add_option("--set", set,
                   "replace a value of the file: KEY=VALUE, such as --set 'domain.cell=2 mm'; may be repeated")
      ->allow_extra_args(false);
}

/// The subcommands and their options.
class Commands {
 public:
  explicit Commands(CLI::App& app) {
    add_run(app);
    add_check(app);
    add_view(app);
    add_sweep(app);
    add_compare(app);
    add_element(app);
    add_calibrate(app);
    add_reproduce(app);
    add(app, "list", "list laws, shapes, transfers and walls with units, ranges and meaning", talus::list_everything);
    add_new(app);
    add(app, "schema", "print a JSON Schema of input files, for completion and checks in editors", [] {
      std::fputs(talus::schema_of_inputs({{"a calibration", &talus::calibration_declaration()}}).c_str(), stdout);
      return 0;
    });
  }
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  /// Runs the subcommand that was parsed. Returns the exit code.
  int run() const {
    for (const auto& [command, function] : all_)
      if (*command) return function();
    return 0;
  }

 private:
  CLI::App* add(CLI::App& app, const char* name, const char* meaning, std::function<int()> run) {
    CLI::App* command = app.add_subcommand(name, meaning);
    all_.push_back({command, std::move(run)});
    return command;
  }

  void add_run(CLI::App& app) {
    CLI::App* command =
        add(app, "run", "run a case and write its results", [this] { return talus::run_case(run_options_); });
    command->add_option("CASE", run_options_.case_file, "case file (TOML), or with --resume the folder of the results")
        ->required();
    command->add_option("--out", run_options_.out, "folder for the results [out/CASE]");
    add_set(command, run_options_.set);
    add_threads(command, run_options_.threads, run_options_.force_threads);
    command->add_option("--until", run_options_.until, "stop at this simulated time, such as \"0.1 s\"");
    CLI::Option* overwrite =
        command->add_flag("--overwrite", run_options_.overwrite, "overwrite results in the folder");
    command
        ->add_flag("--resume", run_options_.resume,
                   "resume from the last checkpoint, bit-identical to a run without a stop; starts the run if there "
                   "are no results "
                   "yet; with --until also beyond the end")
        ->excludes(overwrite);
    command->footer(
        "A run writes a checkpoint every 10 minutes ([output] checkpoint_wall, checkpoints), at its end, and when "
        "Ctrl-C or "
        "SIGTERM stops it (exit code 130 or 143). A second signal stops it at once.");
  }

  void add_check(CLI::App& app) {
    CLI::App* command = add(app, "check", "print a case as talus reads it, with an estimated run time; write nothing",
                            [this] { return talus::check_case(check_options_); });
    command->add_option("CASE", check_options_.case_file, "case file (TOML)")->required();
    add_set(command, check_options_.set);
    add_threads(command, check_options_.threads, check_options_.force_threads);
  }

  void add_view(CLI::App& app) {
    add(app, "view", "open the report of a run, or print its path",
        [this] { return talus::view_report(folder_to_view_); })
        ->add_option("DIR", folder_to_view_, "folder of the results")
        ->required();
  }

  void add_sweep(CLI::App& app) {
    CLI::App* command = add(app, "sweep", "run a case with every combination of some values",
                            [this] { return talus::run_sweep(sweep_options_); });
    command->add_option("CASE", sweep_options_.case_file, "case file (TOML), or the folder of a sweep to continue")
        ->required();
    command
        ->add_option("--set", sweep_options_.set,
                     "a key and its values, \"material.glass.phi_c=20 deg,30 deg\"; repeat for more keys")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    command->add_option("--out", sweep_options_.out, "folder for the results [out/CASE_sweep]");
    command->add_option("--workers", sweep_options_.workers, "runs at the same time [1]")->check(CLI::Range(1, 1024));
    command->add_option("--threads", sweep_options_.threads, "threads of each run [processors / workers]")
        ->check(CLI::Range(1, 4096));
    command->add_flag("--overwrite", sweep_options_.overwrite, "start every run of the sweep again");
    command->footer(
        "The same command continues a sweep that was stopped: complete runs stay, others resume from their last "
        "checkpoint.");
  }

  void add_compare(CLI::App& app) {
    CLI::App* command = add(app, "compare", "compare two runs: a page with both side by side, and what differs",
                            [this] { return talus::compare_runs(compare_options_); });
    command->add_option("A", compare_options_.folder_a, "folder of the results of a run")->required();
    command->add_option("B", compare_options_.folder_b, "folder of the results of another run")->required();
    command->add_option("--out", compare_options_.out, "HTML file [out/compare_A_B.html]");
  }

  void add_element(CLI::App& app) {
    CLI::App* command =
        add(app, "element", "run an element test", [this] { return talus::run_element(element_options_); });
    command->add_option("TEST", element_options_.test_file, "test file (TOML)")->required();
    add_set(command, element_options_.set);
    command->add_option("--out", element_options_.out, "CSV file for the result [standard output]");
  }

  void add_calibrate(CLI::App& app) {
    CLI::App* command = add(app, "calibrate", "find the parameters of a law from measured tests",
                            [this] { return talus::calibrate_law(calibrate_options_); });
    command->add_option("DATA", calibrate_options_.data_file, "calibration file (TOML)")->required();
    command->add_option("--out", calibrate_options_.out, "folder for the results [out/DATA]");
    add_threads(command, calibrate_options_.threads, calibrate_options_.force_threads);
    CLI::Option* overwrite =
        command->add_flag("--overwrite", calibrate_options_.overwrite, "overwrite the calibration in the folder");
    command->add_flag("--resume", calibrate_options_.resume, "resume from the last iteration, with the same result")
        ->excludes(overwrite);
  }

  void add_reproduce(CLI::App& app) {
    CLI::App* command = add(app, "reproduce", "recompute published figures and check their claims",
                            [this] { return talus::reproduce(figure_options_); });
    command->add_option("FIGURE", figure_options_.figure, "a figure's number or folder, or `all`")->required();
    command->add_option("--from", figure_options_.from, "folder that holds the figures [validation]");
    command->add_option("--out", figure_options_.out, "folder for the pages [out/reproduce]");
    add_threads(command, figure_options_.threads, figure_options_.force_threads);
  }

  void add_new(CLI::App& app) {
    add(app, "new", "print a case to start from, with comments; without a name, list them", [this] {
      return talus::print_template(template_name_);
    })->add_option("NAME", template_name_, "name of the case or element test [lists them]");
  }

  talus::RunOptions run_options_;
  talus::SweepOptions sweep_options_;
  talus::CompareOptions compare_options_;
  talus::ElementOptions element_options_;
  talus::CalibrateOptions calibrate_options_;
  talus::ReproduceOptions figure_options_;
  talus::CheckOptions check_options_;
  std::string folder_to_view_, template_name_;
  std::vector<std::pair<CLI::App*, std::function<int()>>> all_;
};

/// Runs the subcommand; errors become messages and exit codes.
int run_command(const Commands& commands) {
  try {
    return commands.run();
  } catch (const talus::InputError& e) {
    const std::size_t n = e.complaints().size();
    std::fprintf(stderr, "%s\n", e.what());
    if (n > 1) std::fprintf(stderr, "talus: %zu errors in the input; nothing was run\n", n);
    return talus::exit_input;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "talus: %s\n", talus::out_of_memory);
    return talus::exit_failed;
  } catch (const std::system_error& e) {
    const bool no_thread = e.code() == std::errc::resource_unavailable_try_again;
    std::fprintf(stderr, "talus: %s\n", no_thread ? talus::out_of_memory : e.what());
    return talus::exit_failed;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "talus: %s\n", e.what());
    return talus::exit_failed;
  }
}

/// The exit code, unless standard output could not be written: then that of a failure, with a message.
int code_after_output(int code) {
  errno = 0;
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
  std::fprintf(stderr, "talus: standard output cannot be written%s%s\n", errno == 0 ? "" : ": ",
               errno == 0 ? "" : std::strerror(errno));
  return code == 0 ? talus::exit_failed : code;
}

int program(int argc, char** argv) {
  CLI::App app{"talus " + talus::version() + ": granular ground that fails, flows and comes to rest"};
  app.set_version_flag("--version", talus::version());
  app.require_subcommand(1);
  talus::report_out_of_memory_in_libraries();
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit of `ulimit -f` is then an error of writing, with a message
  const Commands commands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return code_after_output(app.exit(e));
    if (argc > 1 && argv[1][0] != '-' && app.get_subcommands().empty()) return unknown_command(app, argv[1]);
    app.exit(e);
    return talus::exit_input;
  }
  return code_after_output(run_command(commands));
}

}  // namespace

/// The first of the processes that a launcher has started is the program; the others follow it.
int talus_program(int argc, char** argv) {
  talus::Processes& processes = talus::processes();
  try {
    processes.connect(&argc, &argv);
  } catch (const std::exception& e) {
    if (talus::launched().process == 0) std::fprintf(stderr, "talus: %s\n", e.what());
    return talus::exit_input;
  }
  if (!processes.is_first()) return processes.follow();
  const int code = program(argc, argv);
  processes.disconnect();
  return code;
}
