#include "talus/output/plot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "talus/base/file.hpp"

extern char** environ;

namespace talus {

bool run_gnuplot(const std::filesystem::path& script) {
  const std::filesystem::path log = std::filesystem::absolute(script.string() + ".log");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, script.parent_path().c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  std::string program = "gnuplot", file = script.filename().string();
  char* arguments[] = {program.data(), file.data(), nullptr};
  pid_t child = 0;
  const int failure = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT) return false;
  if (failure != 0) throw std::runtime_error("gnuplot could not be started");
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) return false;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::ostringstream message;
    message << std::ifstream(log).rdbuf();
    throw std::runtime_error(fmt::format("gnuplot could not draw {}: {}", script.string(), message.str()));
  }
  std::error_code ignored;
  std::filesystem::remove(log, ignored);
  return true;
}

DrawingFolder::DrawingFolder(const std::filesystem::path& picture)
    : path_(picture.parent_path() / ("." + picture.stem().string() + ".drawing")) {
  std::filesystem::create_directories(path_);
}

DrawingFolder::~DrawingFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

bool gnuplot_is_installed() {
  std::string program = "gnuplot", option = "--version";
  char* arguments[] = {program.data(), option.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (int stream : {1, 2}) posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failure = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) return false;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string gnuplot_text(const std::string& text) {
  std::string out = "'";
  for (char c : text) {
    if (c == '\'') out += '\'';
    out += c == '\n' ? ' ' : c;
  }
  return out + "'";
}

const char* line_colour(int i) {
  static constexpr const char* colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00",
                                            "#56b4e9", "#000000", "#882255", "#999933", "#999999"};
  return colours[i % std::size(colours)];
}

std::string even_palette() {
  // Ten samples of viridis (Smith and van der Walt 2015, public domain).
  return "set palette defined (0 '#440154', 1 '#482878', 2 '#3e4a89', 3 '#31688e', 4 '#26828e', 5 '#1f9e89', 6 "
         "'#35b779', 7 '#6dcd59', 8 '#b4de2c', 9 '#fde725')\n";
}

/// Whether there is a number to draw in any curve of a chart: fronts are NaN while there is no deposit.
static bool has_numbers(const std::filesystem::path& csv, const Chart& chart) {
  std::ifstream in(csv);
  std::string line, cell;
  std::getline(in, line);  // names
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    for (int column = 1; std::getline(cells, cell, ','); ++column)
      for (const auto& curve : chart.curves)
        if (curve.column == column && std::isfinite(std::strtod(cell.c_str(), nullptr))) return true;
  }
  return false;
}

bool draw_chart(const std::filesystem::path& folder, const std::filesystem::path& csv, const Chart& chart) {
  const std::filesystem::path script = folder / (chart.name + ".gp");
  std::ostringstream out;
  out << "set terminal svg size 640,400 font 'sans,12' background '#ffffff'\n"
      << "set output " << gnuplot_text(chart.name + ".svg") << "\n"
      << "set encoding utf8\nset datafile separator ','\n"
         "set key outside bottom center horizontal noenhanced\nset grid lc '#dddddd'\nset border 3\n"
         "set tics nomirror\n"
      << "set xlabel " << gnuplot_text(chart.x_label) << "\nset ylabel " << gnuplot_text(chart.y_label) << "\n";
  if (!has_numbers(csv, chart)) out << "set yrange [0:1]\n";  // without any, gnuplot finds no range and fails
  std::vector<std::string> plots;
  for (std::size_t i = 0; i < chart.curves.size(); ++i)
    plots.push_back(fmt::format("{} every ::1 using (${}*{}):(${}*{}) with lines lw 2 lc '{}' title {}",
                                gnuplot_text(std::filesystem::relative(csv, folder).string()), chart.x_column,
                                chart.x_scale, chart.curves[i].column, chart.y_scale, line_colour(int(i)),
                                gnuplot_text(chart.curves[i].label)));
  out << "plot " << fmt::format("{}", fmt::join(plots, ", \\\n     ")) << "\n";
  write_whole(script, out.str());
  return run_gnuplot(script);
}

}  // namespace talus
