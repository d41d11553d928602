#include "talus/app/program.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>

#include "talus/app/commands.hpp"
#include "talus/base/error.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/text.hpp"
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

}  // namespace

int talus_program(int argc, char** argv) {
  CLI::App app{"talus " + talus::version() + ": granular ground that fails, flows and comes to rest"};
  app.set_version_flag("--version", talus::version());
  app.require_subcommand(1);

  talus::RunOptions run;
  CLI::App* run_command = app.add_subcommand("run", "run a case and write its results");
  run_command->add_option("CASE", run.case_file, "case file (TOML); with --resume the folder of its results will do")
      ->required();
  run_command->add_option("--out", run.out, "folder for the results [out/CASE]");
  run_command->add_option("--threads", run.threads, "threads [all processors]")->check(CLI::Range(1, 4096));
  run_command->add_option("--until", run.until, "stop at this simulated time, such as \"0.1 s\"");
  CLI::Option* overwrite =
      run_command->add_flag("--overwrite", run.overwrite, "write into a folder that holds results already");
  run_command
      ->add_flag(
          "--resume", run.resume,
          "go on from the last checkpoint, by the same bits as if the run had not stopped; from the beginning if "
          "there are no results yet; with --until beyond the end")
      ->excludes(overwrite);
  run_command->footer(
      "A run writes a checkpoint every 10 minutes ([output] checkpoint_wall, checkpoints), at its end, and when Ctrl-C "
      "or SIGTERM stops it (exit code 130 or 143; a second one stops it at once).");

  std::string check_file;
  int check_threads = 0;
  CLI::App* check_command =
      app.add_subcommand("check", "say what a case was understood to be and how long it would take; write nothing");
  check_command->add_option("CASE", check_file, "case file (TOML)")->required();
  check_command->add_option("--threads", check_threads, "threads [all processors]")->check(CLI::Range(1, 4096));

  std::string view_folder;
  CLI::App* view_command = app.add_subcommand("view", "open the report of a run, or say where it is");
  view_command->add_option("DIR", view_folder, "folder of the results")->required();

  talus::ElementOptions element;
  CLI::App* element_command = app.add_subcommand("element", "run an element test");
  element_command->add_option("TEST", element.test_file, "test file (TOML)")->required();
  element_command->add_option("--out", element.out, "CSV file for the result [standard output]");

  talus::ReproduceOptions figures;
  CLI::App* reproduce_command =
      app.add_subcommand("reproduce", "remake published figures and say which of their claims hold");
  reproduce_command->add_option("FIGURE", figures.figure, "a figure's number or folder, or `all`")->required();
  reproduce_command->add_option("--from", figures.from, "folder that holds the figures [validation]");
  reproduce_command->add_option("--out", figures.out, "folder for the pages [out/reproduce]");
  reproduce_command->add_option("--threads", figures.threads, "threads [all processors]")->check(CLI::Range(1, 4096));

  CLI::App* list_command =
      app.add_subcommand("list", "list laws, shapes, transfers and walls with units, ranges and meaning");

  std::string template_name;
  CLI::App* new_command = app.add_subcommand("new", "print a case to start from, with comments; or which there are");
  new_command->add_option("NAME", template_name, "name of the case or element test [lists them]");

  CLI::App* schema_command =
      app.add_subcommand("schema", "print a JSON Schema of input files, with which editors complete and check them");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    if (argc > 1 && argv[1][0] != '-' && app.get_subcommands().empty()) return unknown_command(app, argv[1]);
    app.exit(e);
    return talus::exit_input;
  }

  try {
    if (*run_command) return talus::run_case(run);
    if (*check_command) return talus::check_case(check_file, check_threads);
    if (*view_command) return talus::view_report(view_folder);
    if (*element_command) return talus::run_element(element);
    if (*reproduce_command) return talus::reproduce(figures);
    if (*list_command) return talus::list_everything();
    if (*new_command) return talus::print_template(template_name);
    if (*schema_command) std::fputs(talus::schema_of_inputs().c_str(), stdout);
  } catch (const talus::InputError& e) {
    const std::size_t n = e.complaints().size();
    std::fprintf(stderr, "%s\n", e.what());
    if (n > 1) std::fprintf(stderr, "talus: %zu mistakes in the input; nothing was run\n", n);
    return talus::exit_input;
  } catch (const talus::RunError& e) {
    std::fprintf(stderr, "talus: %s\n", e.what());
    return talus::exit_failed;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "talus: %s\n", e.what());
    return talus::exit_failed;
  }
  return 0;
}
