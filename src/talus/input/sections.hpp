#pragma once
/// The readers of the sections of a case, and of what several of them hold.

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/case/keys.hpp"
#include "talus/input/reader.hpp"

namespace talus {

// ---- what sections hold -----------------------------------------------------------------------------------------

const Declaration& case_declaration();
const Declaration& domain_declaration();
const Declaration& material_declaration();
const Declaration& body_declaration();
const Declaration& load_declaration();
const Declaration& solid_declaration();
const Declaration& terrain_declaration();
const Declaration& release_declaration();
const Declaration& motion_declaration();
const Declaration& numerics_declaration();
const Declaration& output_declaration();
const Declaration& gauge_declaration();
const Declaration& thalweg_declaration();

// ---- sections of a case, each into its part of the case ----------------------------------------------------------

/// `folder` is where files are looked for that a section names.
void read_materials(Section& root, Preset preset, Case& case_);
void read_domain(Section& root, Case& case_);

/// What a case cuts out of the raster of its terrain.
struct TerrainCrop {
  enum Pixel : char { kept, beside, in_hole };

  std::string key;            ///< that states it: "terrain.crop.polygons"
  Vec<2> low{}, high{};       ///< corners of the whole raster, in coordinates of the run [m]
  std::vector<Pixel> pixels;  ///< of the terrain; empty if it has no others than those that are kept
};
/// After the domain, whose size the terrain states. Returns its crop, if there is one.
std::optional<TerrainCrop> read_terrain(Section& root, Case& case_, const std::string& folder);
void read_bodies(Section& root, Case& case_, const std::string& folder, const std::optional<TerrainCrop>& crop);

void read_loads(Section& root, Case& case_);
void read_solids(Section& root, Case& case_, const std::string& folder);
void read_numerics(Section& numerics, Case& case_);
void read_output(Section& root, Case& case_);
/// Gauges and thalweg, after the terrain.
void read_gauges(Section& root, Case& case_, const std::string& folder);

namespace keys {
inline constexpr NamedTables materials{{"material", "materials of the bodies", material_declaration}};
inline constexpr Table domain{"domain", "the box the grid fills", domain_declaration};
inline constexpr NamedTables bodies{{"body", "the bodies, each a region filled with particles", body_declaration}};
inline constexpr NamedTables loads{{"load", "stresses on the sides of bodies", load_declaration}};
inline constexpr Table terrain{"terrain", "the ground of a slope, from a raster of heights", terrain_declaration};
inline constexpr NamedTables solids{{"solid", "rigid solids inside the domain", solid_declaration}};
inline constexpr Table numerics{"numerics", "how the equations are solved", numerics_declaration};
inline constexpr Option preset{"preset", "set of defaults for the other keys", preset_choices};
inline constexpr NamedTables gauges{
    {"gauge", "places, and lines across the flow, of which gauges.csv has time histories", gauge_declaration}};
inline constexpr Table thalweg{"thalweg", "the line down a slope along which runout is measured", thalweg_declaration};
inline constexpr Table output{"output", "what is written", output_declaration};
}  // namespace keys

// ---- what several sections hold ----------------------------------------------------------------------------------

/// A key that says what a surface does to material: a word, or a table where it takes numbers.
struct SurfaceKey {
  Option option;
  Table table;
  std::span<const WallKind> kinds;  ///< that the words of `option` mean
  bool (*separates)(WallKind);      ///< whether material may lift off by default
  bool may_be_turbulent = false;    ///< whether there is `voellmy` among the words
};
/// A side of the domain, and the surface of a solid.
SurfaceKey key_of_wall(int side);
SurfaceKey key_of_contact();
/// The ground of a terrain.
SurfaceKey key_of_ground();
Wall read_surface(Section& s, const SurfaceKey& surface, const Case& case_);

/// Tables of shapes.
const Declaration& box_declaration();
const Declaration& cylinder_declaration();
const Declaration& polygon_declaration();
const Declaration& half_space_declaration();
const Declaration& sphere_declaration();
const Declaration& mesh_declaration();
const Declaration& image_declaration();
const Declaration& points_declaration();
namespace keys {
inline constexpr Table box{"box", "all points between two corners", box_declaration};
inline constexpr Table cylinder{"cylinder", "an upright cylinder; in plane strain a disk", cylinder_declaration};
inline constexpr Table polygon{"polygon", "a polygon in the vertical plane", polygon_declaration};
inline constexpr Table half_space{"half_space", "all points behind a plane", half_space_declaration};
inline constexpr Table sphere{"sphere", "a sphere; in plane strain a disk", sphere_declaration};
inline constexpr Table mesh{"mesh", "the volume enclosed by a surface of triangles", mesh_declaration};
inline constexpr Table image{"image", "the dark pixels of a picture", image_declaration};
inline constexpr Table points{"points", "particles listed in a file", points_declaration};
inline constexpr Table release{"release", "a layer on the terrain", release_declaration};
}  // namespace keys

/// The key `box`, `cylinder` or `polygon`, whichever there is.
Region read_shape(Section& s, int dim);
/// A half-space, a sphere, a mesh or one of the shapes that bodies have, too.
SolidShape read_solid_shape(Section& s, int dim, const std::string& folder);
/// A mesh; an empty box if the input is not valid.
SolidShape read_mesh(Section& s, int dim, const std::string& folder);
/// The dark pixels of a PNG file.
Region read_image(Section& s, const std::string& folder);
/// Particles of a CSV file, in SI; without a column of volumes each is a square or cube of edge `spacing`.
Region read_points(Section& s, int dim, const std::string& folder, std::optional<double> spacing);

/// A layer on the terrain of the case, filled with particles that stand `spacing` apart.
Region read_release(Section& s, Case& case_, const std::string& folder, double spacing,
                    const std::optional<TerrainCrop>& crop);

PrescribedMotion read_motion(Section& s, int dim, const std::string& folder);

/// Numbers as a vector; components that are not there are zero.
Vec<3> vector_of(const std::vector<double>& values);

/// Complains of keys that go with another one only.
void expect_absent(Section& s, std::initializer_list<const char*> keys, std::string_view with);
/// Complains where instants do not increase or are not as many as what they are given for, and makes the function empty.
template <class T>
void expect_instants(Section& s, std::string_view values, std::string_view times, LinearInTime<T>& f);

}  // namespace talus
