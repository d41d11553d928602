#pragma once
/// What is known of a run when it has ended.

#include <optional>
#include <string>
#include <vector>

#include "talus/input/read.hpp"
#include "talus/mpm/simulation.hpp"
#include "talus/output/gauges.hpp"
#include "talus/output/outflow_places.hpp"
#include "talus/output/outline.hpp"
#include "talus/output/pressure_noise.hpp"
#include "talus/output/surface_forces.hpp"
#include "talus/output/terrain_maps.hpp"

namespace talus {

struct RunSummary {
  std::string case_file;
  std::string case_text;  ///< the file as it was read
  std::vector<Understood> understood;
  Ledger ledger;
  StepTally tally;
  SurfaceSummary surfaces;
  Outline start, end;
  std::optional<NoiseShares> noise;  ///< of the pressure in flow; none if nothing has flowed
  double wall_seconds = 0, cpu_seconds = 0;
  long n_particles = 0;
  std::size_t bytes = 0;
  int n_threads = 1;
  int n_snapshots = 0;
  std::string failure;                   ///< reason the run failed; empty if it did not
  bool stopped = false;                  ///< by the user, before its end
  std::optional<Runout> runout;          ///< of a run on terrain
  std::vector<OutflowOnMap> outflow;     ///< places of a run on terrain where material has left
  std::optional<ThalwegRunout> thalweg;  ///< of one with a thalweg, if there was flow
  std::vector<GaugeSummary> gauges;
  bool came_to_rest = false;       ///< ended before its end, because its kinetic energy had fallen so far
  std::vector<double> resumed_at;  ///< times from which it was resumed [s]
  std::vector<std::string> warnings;
};

}  // namespace talus
