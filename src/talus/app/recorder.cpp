#include "talus/app/recorder.hpp"

#include <algorithm>
#include <limits>

#include "talus/app/processes.hpp"
#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"
#include "talus/case/defaults.hpp"

namespace talus {

RunClock::RunClock(double wall_before, double cpu_before)
    : start_(std::chrono::steady_clock::now()),
      wall_before_(wall_before),
      cpu_before_(cpu_before - talus::cpu_seconds()) {}

double RunClock::wall_seconds() const {
  return wall_before_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double RunClock::cpu_seconds() const { return cpu_before_ + talus::cpu_seconds(); }

namespace {

/// The checkpoints of a run; a new one gets its first, so that there is one as soon as there are results.
Checkpoints checkpoints_of(const Task& task, const RunSoFar& so_far, const Simulation& simulation) {
  Checkpoints checkpoints(task.folder, task.saved ? &*task.saved : nullptr);
  if (!task.saved) checkpoints.write(so_far, simulation.save(), processes().fill_of(simulation));
  return checkpoints;
}

}  // namespace

Recorder::Recorder(const Task& task, RunSoFar so_far, const OutlineFinder& outlines, const Simulation& simulation)
    : case_(task.input.case_),
      outlines_(outlines),
      so_far_(std::move(so_far)),
      checkpoints_(checkpoints_of(task, so_far_, simulation)),
      history_(task.folder / "history.csv", task.input.case_, so_far_.history_bytes),
      profiles_(task.folder, task.input.case_, so_far_.profile_bytes),
      snapshots_(task.folder, *task.input.case_.output.fields, so_far_.snapshots),
      pictures_(task.folder / "pictures", task.input.case_, so_far_.instants),
      noise_(task.input.case_, so_far_.pressure_noise),
      maps_(task.folder / "maps", task.input.case_, task.case_text, so_far_.maps, so_far_.profile),
      forces_(task.input.case_, so_far_.forces),
      gauges_(task.folder / "gauges.csv", task.input.case_, so_far_.gauges, so_far_.gauge_bytes),
      stop_below_(task.input.case_.stop_below),
      stop_after_(time_of_fall(task.input.case_)),
      picture_times_(*task.input.case_.output.pictures),
      checkpoint_times_{task.input.case_.output.checkpoints.value_or(std::numeric_limits<double>::infinity())},
      checkpoint_wall_(task.input.case_.output.checkpoint_wall),
      clock_(so_far_.wall_seconds, so_far_.cpu_seconds),
      checkpoint_at_(clock_.wall_seconds()) {
  std::sort(picture_times_.begin(), picture_times_.end());
  std::erase_if(picture_times_, [&](double t) { return !so_far_.instants.empty() && t <= so_far_.instants.back(); });
  checkpoint_times_.due(simulation.ledger().time);
  if (case_.dim == 3) surface_map_.emplace(task.folder, so_far_.surface_map_bytes);
}

bool Recorder::picture_is_due(double time) {
  const auto to_come =
      std::find_if(picture_times_.begin(), picture_times_.end(), [&](double t) { return !(time >= t); });
  const bool due = to_come != picture_times_.begin();
  picture_times_.erase(picture_times_.begin(), to_come);
  return due;
}

bool Recorder::has_come_to_rest(const Simulation& simulation) const {
  return stop_below_ > 0 && simulation.ledger().time - so_far_.last_flow > stop_after_;
}

void Recorder::record(Simulation& simulation, bool is_end) {
  const double t = simulation.ledger().time;
  so_far_.peak_kinetic = std::max(so_far_.peak_kinetic, simulation.ledger().kinetic);
  if (simulation.ledger().kinetic >= stop_below_ * so_far_.peak_kinetic) so_far_.last_flow = t;
  forces_.follow(t, simulation.surfaces());
  const bool map = maps_.due(t), frame = maps_.frame_due(t);
  if (noise_.due(t)) noise_.add(t, simulation.pressures());
  const bool picture = picture_is_due(t);
  const bool snapshot = so_far_.next_snapshot.due(t) || (is_end && so_far_.next_snapshot.last != t);
  const bool row = so_far_.next_row.due(t) || (is_end && so_far_.next_row.last != t);
  const bool surface_map = snapshot && surface_map_;
  if (map || frame || surface_map || (row && gauges_.any())) {
    const FlowPoints flow = simulation.flow();
    if (surface_map) surface_map_->add(t, talus::surface_map(case_, flow));
    if (map) maps_.add(t, flow);
    if (frame) maps_.add_frame(t, flow);
    if (map || row) gauges_.add(t, flow, row);
  }
  if (row || snapshot) {
    const Outline outline = outlines_.find(simulation.places());
    if (row) history_.add(simulation.ledger(), outline, forces_.row());
    if (snapshot) profiles_.add(t, outline.surface);
  }
  if (!snapshot && !picture) return;
  const bool is_shared = processes().n() > 1;
  Observation seen;
  if (!is_shared || picture) seen = simulation.observe(is_shared ? pictures_.fields() : std::vector<std::string>{});
  if (picture) pictures_.add(seen);
  if (picture && maps_.any()) maps_.write_instant(t, simulation.flow());
  if (snapshot && is_shared) {
    seen = {};
    snapshots_.add(t, [&](const std::filesystem::path& file) {
      processes().write_snapshot(simulation, file, *case_.output.fields);
    });
  } else if (snapshot) {
    snapshots_.add(std::move(seen));
  }
}

bool Recorder::checkpoint_is_due(const Simulation& simulation) {
  const bool by_time = checkpoint_times_.due(simulation.ledger().time);
  return by_time || clock_.wall_seconds() - checkpoint_at_ >= checkpoint_wall_;
}

void Recorder::write_checkpoint(const Simulation& simulation) {
  snapshots_.finish();
  so_far_.time = simulation.ledger().time;
  so_far_.step = simulation.ledger().step;
  so_far_.wall_seconds = clock_.wall_seconds();
  so_far_.cpu_seconds = clock_.cpu_seconds();
  so_far_.history_bytes = history_.bytes();
  so_far_.profile_bytes = profiles_.bytes();
  if (surface_map_) so_far_.surface_map_bytes = surface_map_->bytes();
  put_on_disk(history_.file());
  put_on_disk(profiles_.file());
  if (surface_map_) put_on_disk(surface_map_->file());
  so_far_.gauge_bytes = gauges_.bytes();
  so_far_.gauges = gauges_.state();
  if (gauges_.table()) put_on_disk(gauges_.table()->file());
  for (int i = int(so_far_.snapshots.size()); i < snapshots_.size(); ++i) put_on_disk(snapshots_.file(i));
  for (int i = int(so_far_.instants.size()); i < int(pictures_.times().size()); ++i) put_on_disk(pictures_.instant(i));
  so_far_.pressure_noise = noise_.state();
  so_far_.maps = maps_.state();
  so_far_.forces = forces_.state();
  so_far_.profile = maps_.profile_state();
  so_far_.snapshots = snapshots_.times();
  so_far_.instants = pictures_.times();
  checkpoints_.write(so_far_, simulation.save(), processes().fill_of(simulation));
  checkpoint_at_ = clock_.wall_seconds();
}

}  // namespace talus
