#pragma once
/// The readers of the sections of a case, and of what several of them hold.

#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/input/reader.hpp"

namespace talus {

// ---- sections of a case, each into its part of the case ----------------------------------------------------------

/// `folder` is where files are looked for that a section names.
void read_materials(Section& root, Preset preset, Case& case_);
void read_domain(Section& root, Case& case_);
void read_bodies(Section& root, Case& case_, const std::string& folder);
void read_loads(Section& root, Case& case_);
void read_solids(Section& root, Case& case_, const std::string& folder);
void read_numerics(Section& numerics, Case& case_);
void read_output(Section& root, Case& case_);

// ---- what several sections hold ----------------------------------------------------------------------------------

/// A key that says what a surface does to material: a word, or a table where it takes numbers.
struct SurfaceKey {
  Option option;
  std::span<const WallKind> kinds;  ///< that the words of `option` mean
  bool (*separates)(WallKind);      ///< whether material may lift off by default
};
Wall read_surface(Section& s, const SurfaceKey& surface, const Case& case_);

/// The key `box`, `cylinder` or `polygon`, whichever there is.
Region read_shape(Section& s, int dim);
/// A half-space, a sphere or one of the shapes that bodies have, too.
SolidShape read_solid_shape(Section& s, int dim);
/// The dark pixels of a PNG file.
Region read_image(Section& s, const std::string& folder);
/// Particles of a CSV file, in SI; without a column of volumes each is a square or cube of edge `spacing`.
Region read_points(Section& s, int dim, const std::string& folder, std::optional<double> spacing);

PrescribedMotion read_motion(Section& s, int dim, const std::string& folder);

/// Numbers as a vector; components that are not there are zero.
Vec<3> vector_of(const std::vector<double>& values);

/// Complains unless exactly one of some keys is there.
void expect_one_of(Section& s, const std::vector<std::string_view>& keys);
/// Complains of keys that go with another one only.
void expect_absent(Section& s, std::initializer_list<const char*> keys, std::string_view with);
/// Complains where instants do not increase or are not as many as what they are given for, and makes the function empty.
template <class T>
void expect_instants(Section& s, std::string_view values, std::string_view times, LinearInTime<T>& f);

}  // namespace talus
