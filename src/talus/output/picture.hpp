#pragma once
/// Pictures of a run: a quantity at several instants, seen from the side.

#include <filesystem>
#include <string>
#include <vector>

#include "talus/base/units.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus {

/// A picture that was made.
struct Picture {
  std::filesystem::path file;
  std::string caption;
};

/// Collects instants during a run and draws them at its end: speed, plastic strain and viscosity, as far as the
/// laws have them, and the surfaces of solids. In 3D it shows the slice through the middle. Data
/// (instant_0.csv ..., solids_0.csv ...) and scripts (speed.gp ...) stay in the folder.
class PictureBook {
 public:
  /// `times` are those of the instants that are there already [s].
  PictureBook(std::filesystem::path folder, const Case& case_, std::vector<double> times = {});
  void add(const Observation& seen);
  /// Names of the fields that `add` reads, as far as a run has them.
  static std::vector<std::string> fields();
  /// Draws everything. Empty if there is no gnuplot or nothing was added.
  std::vector<Picture> draw() const;
  /// Of the instants that were added [s].
  const std::vector<double>& times() const { return times_; }
  std::filesystem::path instant(int number) const;

 private:
  struct Quantity;
  struct Instants;
  struct Layout;
  static const std::vector<Quantity> quantities;

  Instants read_instants() const;
  std::string caption(const Quantity& quantity) const;
  /// Line by line.
  std::vector<std::string> title(const Quantity& quantity, const Layout& layout) const;
  /// The columns x and y of the files in the unit of the axes, as gnuplot reads them.
  std::string columns_of_places() const;
  std::string head_of_script(const Quantity& quantity, const Instants& all, const Layout& layout) const;
  /// Place, title and labels of a panel.
  std::string panel_of_script(int number, const Layout& layout) const;
  /// What draws the particles of an instant, in the colours of a column. `stretch`: scale of heights over that of lengths.
  std::string particles_of_script(int number, long column, double pixels_per_metre, double stretch) const;
  /// Writes points on the surfaces of solids at an instant, inside the part of the plane that is shown. Returns the file.
  std::string write_solids(int number, const double low[2], const double high[2], double spacing) const;

  std::filesystem::path folder_;
  int dim_;
  bool axisymmetric_;
  double cell_;
  LengthUnit unit_;
  std::string title_;
  double floor_;  ///< lower side of the domain [m]
  double slice_;  ///< y of the slice [m]
  std::vector<Solid> solids_;
  std::vector<double> times_;
};

}  // namespace talus
