#pragma once
/// Pictures of a run: a quantity at several instants, seen from the side.

#include <filesystem>
#include <string>
#include <vector>

#include "talus/mpm/simulation.hpp"

namespace talus {

/// A picture that was made.
struct Picture {
  std::filesystem::path file;
  std::string caption;
};

/// Collects instants while a run goes on and draws them at its end: speed, plastic strain and viscosity, those of them
/// that the laws tell. In 3D it shows the slice through the middle. Data (instant_0.csv ...) and scripts (speed.gp ...)
/// stay in the folder.
class PictureBook {
 public:
  PictureBook(std::filesystem::path folder, const Case& what);
  void add(const Observation& seen);
  /// Draws everything. Empty if there is no gnuplot or nothing was added.
  std::vector<Picture> draw();

 private:
  struct Instant {
    double time;
    std::string file;
  };
  struct Shown {
    std::string name, title, label;
    bool present = false;
    std::vector<float> values;  ///< of all instants, for the scale
  };

  std::filesystem::path folder_;
  int dim_;
  double cell_;
  std::string title_;
  double low_[2], high_[2];  ///< extent of what is shown [m]
  double slice_ = 0;         ///< place of the slice along y [m]
  std::vector<Instant> instants_;
  std::vector<Shown> shown_;
};

}  // namespace talus
