#pragma once
/// gauges.csv: the flow over a terrain at places, and through lines, in time.
///
/// A gauge sees columns of material by the rule of the maps (output/flow_maps.hpp), as wide as their pixels but of its
/// own: that of a place lies around it; those of a line stand side by side along it, half of each on either side. So a
/// gauge in the middle of a pixel has the numbers of the maps there.
///
/// Flux through a line is the sum over its columns of vertical thickness times velocity across the line times the width
/// of the column, of all material, however thin. A particle that crosses adds just its volume to the integral of the
/// flux over time, which is taken by trapezoids over all instants at which gauges are read: those of maps and those of
/// the rows.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/output/flow_maps.hpp"
#include "talus/output/history.hpp"

namespace talus {

/// What a gauge reads at an instant. Speeds and pressures are no number where no flow exceeds the least thickness.
struct GaugeReading {
  double thickness = 0, vertical_thickness = 0;  ///< [m]; the first normal to the ground. Of a line: the largest
  double speed = PlanRaster::none;               ///< [m/s], of a line the largest
  double pressure = PlanRaster::none;            ///< rho v^2 [Pa], of a line the largest
  Vec<3> velocity{PlanRaster::none, PlanRaster::none, PlanRaster::none};  ///< of a place: east, north, up [m/s]
  double width = 0;                      ///< of a line: in plan, where flow exceeds the least thickness [m]
  double mean_thickness = 0;             ///< of a line: normal to the ground, over this width; 0 where no flow is
  double mean_speed = PlanRaster::none;  ///< of a line: weighted with vertical thickness, over this width
  double flux = 0;                       ///< through a line [m3/s], positive towards its left
  bool has_flow() const { return width > 0; }
};

/// One gauge: a place or a line on the ground.
class FlowGauge {
 public:
  FlowGauge(const Case& case_, const Gauge& gauge);
  GaugeReading read(const FlowPoints& points);

 private:
  /// Columns along a straight part of a line, of which one corner of the first is the origin and x goes along it.
  struct Part {
    Vec<2> begin, along;
    double edge;  ///< of a column [m]
    int n;
    FlowColumns columns;
  };
  void gather(Part& part, const FlowPoints& points);

  bool is_line_;
  std::vector<Part> parts_;
  FlowPoints near_;  ///< points that touch the columns of a part, in its coordinates
};

/// What a gauge has seen up to now.
struct GaugeSummary {
  Gauge gauge;                                    ///< in coordinates of the map
  std::optional<double> arrival;                  ///< of flow above the least thickness [s]
  double thickness = 0, speed = 0, pressure = 0;  ///< largest [m, normal to the ground], [m/s], [Pa]
  double flux = 0;                                ///< of the largest amount, with its sign [m3/s]
  double volume = 0;                              ///< that has crossed to the left, less what has crossed back [m3]
};

/// The gauges of a run.
class Gauges {
 public:
  /// Starts gauges.csv, or continues it after its first `bytes` with the `state` of then; no file in a case without
  /// gauges. Throws std::runtime_error if the state is of other gauges, or the file cannot be written.
  Gauges(const std::filesystem::path& csv, const Case& case_, std::span<const double> state = {}, long bytes = 0);

  bool any() const { return !gauges_.empty(); }
  /// Reads all gauges at an instant [s]; `row`: and writes a row.
  void add(double time, const FlowPoints& points, bool row);
  /// Everything that decides what is to come; finite numbers.
  std::vector<double> state() const;
  const std::vector<GaugeSummary>& summaries() const { return summaries_; }

  /// gauges.csv; null in a case without gauges.
  const GrowingTable* table() const { return table_ ? &*table_ : nullptr; }
  long bytes() const { return table_ ? table_->bytes() : 0; }
  /// Charts of gauges.csv: thickness and speed at places; thickness, flux and volume through lines.
  std::vector<Chart> charts() const;

 private:
  void add_to(GaugeSummary& summary, double& last_flux, double time, const GaugeReading& reading) const;

  std::vector<FlowGauge> gauges_;
  std::vector<GaugeSummary> summaries_;
  std::vector<double> last_flux_;  ///< of each, at the last instant [m3/s]
  std::optional<double> last_;     ///< last instant [s]
  std::optional<GrowingTable> table_;
};

}  // namespace talus
