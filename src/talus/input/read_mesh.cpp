#include <fmt/format.h>

#include "talus/base/units.hpp"
#include "talus/input/map_files.hpp"
#include "talus/input/mesh_file.hpp"

namespace talus {

namespace {

constexpr Text file_of_mesh{"file", "a closed surface of triangles: an STL"};
constexpr Text unit_of_mesh{"unit", "unit of its coordinates, such as \"mm\""};
constexpr Numbers position{{"position", "m", {}, "where the origin of the file lies; by default in that of the run"},
                           3};

std::string in_words(const Vec<3>& x) { return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", x[0], x[1], x[2]); }

}  // namespace

const Declaration& mesh_declaration() {
  static const Declaration d("a mesh", {required(file_of_mesh), required(unit_of_mesh), optional(position)});
  return d;
}

SolidShape read_mesh(Section& s, int dim, const std::string& folder) {
  Section m = s.section(keys::mesh);
  const std::string file = m.text(file_of_mesh);
  const double metres = metres_of(m, unit_of_mesh);
  const Vec<3> origin = m.has("position") ? vector_of(m.numbers(position)) : Vec<3>{};
  m.close();
  if (dim != 3) s.complain("mesh", "needs [domain] kind = \"3d\"");
  std::shared_ptr<TriangleMesh> mesh;
  if (!file.empty())
    complain_where_it_throws(m, "file", [&] {
      std::vector<Vec<3>> corners = read_stl(path_in(folder, file), metres);
      for (Vec<3>& x : corners) x = x + origin;
      mesh = std::make_shared<TriangleMesh>(corners);
    });
  if (!mesh) return Box{};
  if (const std::string why = mesh->fault(); !why.empty()) {
    m.complain("file", why);
    return Box{};
  }
  const double volume = mesh->volume();
  const Vec<3> edges = mesh->high() - mesh->low();
  if (!(std::abs(volume) > 1e-9 * edges[0] * edges[1] * edges[2])) {
    m.complain("file", "encloses no volume");
    return Box{};
  }
  if (volume < 0) mesh->turn_round();
  m.note("size", fmt::format("from {} to {}", in_words(mesh->low()), in_words(mesh->high())), "the box around it");
  m.note(
      "triangles", fmt::format("{}", mesh->triangles().size()),
      volume < 0 ? "of its surface; those of the file show their inner side, and were turned round" : "of its surface");
  m.note("volume", fmt::format("{:.6g} m3", std::abs(volume)), "that it encloses");
  return Mesh{std::move(mesh)};
}

}  // namespace talus
