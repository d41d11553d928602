#include "talus/app/program.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <functional>

#include "talus/app/commands.hpp"
#include "talus/base/error.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/text.hpp"
#include "talus/calibration/read_calibration.hpp"
#include "talus/input/schema.hpp"

namespace {

/// What the user typed instead of a subcommand, and what may have been meant.
int unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string_view> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  const std::string_view alike = talus::most_alike(word, names);
  std::fprintf(stderr, "talus: `%s` is no command; %s\n", word.c_str(),
               alike.empty() ? ("there is " + talus::any_of(names)).c_str()
                             : ("did you mean `" + std::string(alike) + "`?").c_str());
  return talus::exit_input;
}

void add_threads(CLI::App* command, int& threads) {
  command->add_option("--threads", threads, "threads [all processors]")->check(CLI::Range(1, 4096));
}

/// The subcommands and their options.
class Commands {
 public:
  explicit Commands(CLI::App& app) {
    add_run(app);
    add_check(app);
    add_view(app);
    add_element(app);
    add_calibrate(app);
    add_reproduce(app);
    add(app, "list", "list laws, shapes, transfers and walls with units, ranges and meaning", talus::list_everything);
    add_new(app);
    add(app, "schema", "print a JSON Schema of input files, with which editors complete and check them", [] {
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
    command
        ->add_option("CASE", run_options_.case_file,
                     "case file (TOML); with --resume the folder of its results will do")
        ->required();
    command->add_option("--out", run_options_.out, "folder for the results [out/CASE]");
    add_threads(command, run_options_.threads);
    command->add_option("--until", run_options_.until, "stop at this simulated time, such as \"0.1 s\"");
    CLI::Option* overwrite =
        command->add_flag("--overwrite", run_options_.overwrite, "write into a folder that holds results already");
    command
        ->add_flag(
            "--resume", run_options_.resume,
            "go on from the last checkpoint, by the same bits as if the run had not stopped; from the beginning if "
            "there are no results yet; with --until beyond the end")
        ->excludes(overwrite);
    command->footer(
        "A run writes a checkpoint every 10 minutes ([output] checkpoint_wall, checkpoints), at its end, and when "
        "Ctrl-C "
        "or SIGTERM stops it (exit code 130 or 143; a second one stops it at once).");
  }

  void add_check(CLI::App& app) {
    CLI::App* command =
        add(app, "check", "say what a case was understood to be and how long it would take; write nothing",
            [this] { return talus::check_case(case_to_check_, threads_of_check_); });
    command->add_option("CASE", case_to_check_, "case file (TOML)")->required();
    add_threads(command, threads_of_check_);
  }

  void add_view(CLI::App& app) {
    add(app, "view", "open the report of a run, or say where it is",
        [this] { return talus::view_report(folder_to_view_); })
        ->add_option("DIR", folder_to_view_, "folder of the results")
        ->required();
  }

  void add_element(CLI::App& app) {
    CLI::App* command =
        add(app, "element", "run an element test", [this] { return talus::run_element(element_options_); });
    command->add_option("TEST", element_options_.test_file, "test file (TOML)")->required();
    command->add_option("--out", element_options_.out, "CSV file for the result [standard output]");
  }

  void add_calibrate(CLI::App& app) {
    CLI::App* command = add(app, "calibrate", "find the parameters of a law from measured tests",
                            [this] { return talus::calibrate_law(calibrate_options_); });
    command->add_option("DATA", calibrate_options_.data_file, "calibration file (TOML)")->required();
    command->add_option("--out", calibrate_options_.out, "folder for the results [out/DATA]");
    add_threads(command, calibrate_options_.threads);
    CLI::Option* overwrite = command->add_flag("--overwrite", calibrate_options_.overwrite,
                                               "write into a folder that holds a calibration already");
    command->add_flag("--resume", calibrate_options_.resume, "go on from the last iteration, to the same result")
        ->excludes(overwrite);
  }

  void add_reproduce(CLI::App& app) {
    CLI::App* command = add(app, "reproduce", "remake published figures and say which of their claims hold",
                            [this] { return talus::reproduce(figure_options_); });
    command->add_option("FIGURE", figure_options_.figure, "a figure's number or folder, or `all`")->required();
    command->add_option("--from", figure_options_.from, "folder that holds the figures [validation]");
    command->add_option("--out", figure_options_.out, "folder for the pages [out/reproduce]");
    add_threads(command, figure_options_.threads);
  }

  void add_new(CLI::App& app) {
    add(app, "new", "print a case to start from, with comments; or which there are", [this] {
      return talus::print_template(template_name_);
    })->add_option("NAME", template_name_, "name of the case or element test [lists them]");
  }

  talus::RunOptions run_options_;
  talus::ElementOptions element_options_;
  talus::CalibrateOptions calibrate_options_;
  talus::ReproduceOptions figure_options_;
  std::string case_to_check_, folder_to_view_, template_name_;
  int threads_of_check_ = 0;
  std::vector<std::pair<CLI::App*, std::function<int()>>> all_;
};

/// Runs the subcommand; errors become messages and exit codes.
int run_command(const Commands& commands) {
  try {
    return commands.run();
  } catch (const talus::InputError& e) {
    const std::size_t n = e.complaints().size();
    std::fprintf(stderr, "%s\n", e.what());
    if (n > 1) std::fprintf(stderr, "talus: %zu mistakes in the input; nothing was run\n", n);
    return talus::exit_input;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "talus: %s\n", e.what());
    return talus::exit_failed;
  }
}

}  // namespace

int talus_program(int argc, char** argv) {
  CLI::App app{"talus " + talus::version() + ": granular ground that fails, flows and comes to rest"};
  app.set_version_flag("--version", talus::version());
  app.require_subcommand(1);
  const Commands commands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    if (argc > 1 && argv[1][0] != '-' && app.get_subcommands().empty()) return unknown_command(app, argv[1]);
    app.exit(e);
    return talus::exit_input;
  }
  return run_command(commands);
}
