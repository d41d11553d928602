#include "talus/output/viewer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <future>
#include <stdexcept>

#include "talus/output/packing.hpp"
#include "talus/output/page.hpp"
#include "talus/output/page_parts.hpp"
#include "talus/output/snapshot.hpp"

namespace talus {

namespace {

/// Component `c` of all particles.
std::vector<double> component(const Field& field, int c) {
  std::vector<double> values;
  values.reserve(field.values.size() / std::size_t(field.components));
  for (std::size_t i = std::size_t(c); i < field.values.size(); i += std::size_t(field.components))
    values.push_back(field.values[i]);
  return values;
}

nlohmann::json quantities_of(const Observation& seen) {
  nlohmann::json quantities = nlohmann::json::array();
  for (std::size_t q = 1; q < seen.fields.size(); ++q) {
    const Field& f = seen.fields[q];
    quantities.push_back({{"name", f.name}, {"unit", f.unit}, {"meaning", f.meaning}, {"components", f.components}});
  }
  return quantities;
}

/// An element of the page that holds packed numbers.
std::string element_of(const std::string& id, const std::string& words) {
  return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id, words);
}

/// Packed places along one axis: their scale for the scene's JSON, and the element that holds them.
void add_axis(const std::string& id, const Packed& places, nlohmann::json& facts, std::string& html) {
  facts["low"].push_back(places.facts["low"]);
  facts["step_of_place"].push_back(places.facts["step"]);
  html += element_of(id, places.words);
}

/// Takes the fields `id` and `ancestor` out, which are of no use in a picture.
void remove_numbers(Observation& seen) {
  std::erase_if(seen.fields, [](const Field& f) { return f.name == "id" || f.name == "ancestor"; });
}

/// The first of every `every` particles of a snapshot.
Observation seen_in(const std::filesystem::path& snapshot, std::size_t every) {
  Observation seen = read_snapshot(snapshot, every);
  remove_numbers(seen);
  return seen;
}

/// Whether each particle has the row of its number in a snapshot, of which every `every` particles were read: none before
/// it has left or was merged. `n`: how many there are in other snapshots, which tells it where no ids are.
bool rows_are_numbers(const Observation& seen, std::size_t every, int n) {
  const Field* id = seen.find("id");
  if (!id) return seen.n_particles() == n;
  for (std::size_t i = 0; i < id->values.size(); ++i)
    if (id->values[i] != double(i * every)) return false;
  return true;
}

/// One instant: facts for the scene's JSON, and the elements of the page that hold its numbers.
struct Instant {
  nlohmann::json facts;
  std::string html;
};

Instant pack(const Observation& seen, std::size_t frame) {
  // Compressing is most of the work of a report; a thread for each component.
  std::vector<std::future<Packed>> places, values;
  const auto start = [](auto work) { return std::async(std::launch::async, work); };
  Instant instant;
  for (int a = 0; a < 3; ++a) places.push_back(start([&, a] { return packed_places(component(seen.fields[0], a)); }));
  for (std::size_t q = 1; q < seen.fields.size(); ++q)
    for (int c = 0; c < seen.fields[q].components; ++c)
      values.push_back(start([&, q, c] { return packed_values(component(seen.fields[q], c)); }));

  nlohmann::json& facts = instant.facts;
  facts["time"] = seen.time;
  facts["step"] = seen.step;
  facts["n"] = seen.n_particles();
  for (int a = 0; a < 3; ++a) add_axis(fmt::format("place-{}-{}", frame, a), places[a].get(), facts, instant.html);
  auto next = values.begin();
  for (std::size_t q = 1; q < seen.fields.size(); ++q) {
    nlohmann::json of_components;
    for (int c = 0; c < seen.fields[q].components; ++c) {
      const Packed p = (next++)->get();
      of_components.push_back(p.facts);
      instant.html += element_of(fmt::format("value-{}-{}-{}", frame, q - 1, c), p.words);
    }
    if (seen.fields[q].components == 3) {
      std::vector<double> magnitude;
      const std::vector<double>& v = seen.fields[q].values;
      for (std::size_t i = 0; i < v.size(); i += 3) magnitude.push_back(std::hypot(v[i], v[i + 1], v[i + 2]));
      of_components.push_back({{"range", range_of(std::move(magnitude))}});
    }
    facts["values"].push_back(of_components);
  }
  return instant;
}

/// The surfaces of solids at the start, as points: close to each other along a line in 2D, apart in 3D, so that one
/// sees the particles between them.
nlohmann::json pack_solids(const Case& case_, std::string& html) {
  constexpr std::size_t most_points = 40'000;
  nlohmann::json solids = nlohmann::json::array();
  for (const Solid& solid : case_.solids) {
    const Box box = bounding_box(solid.shape, case_.dim, case_.domain);
    double spacing = case_.cell / (case_.dim == 2 ? 8 : 3);
    std::vector<Vec<3>> points = surface_points(solid, {}, box, spacing, case_.dim);
    for (; points.size() > most_points; points = surface_points(solid, {}, box, spacing, case_.dim)) spacing *= 1.5;
    nlohmann::json facts = {{"name", solid.name}, {"n", points.size()}, {"spacing", spacing}};
    for (int a = 0; a < 3; ++a) {
      std::vector<double> along;
      for (const Vec<3>& x : points) along.push_back(x[a]);
      add_axis(fmt::format("solid-{}-{}", solids.size(), a), packed_places(along), facts, html);
    }
    solids.push_back(facts);
  }
  return solids;
}

/// Pose of a solid at an instant: the rows of x = R x_at_start + t, one after another.
nlohmann::json pose_of(const Solid& solid, double time) {
  const Pose pose = solid.motion.at(time);
  const Vec<3> shift = pose.centre + pose.displacement - pose.turned(pose.centre);
  nlohmann::json rows = nlohmann::json::array();
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) rows.push_back(pose.rotation[a][b]);
    rows.push_back(shift[a]);
  }
  return rows;
}

/// The data of a page: elements with packed numbers, and the scene that describes them.
struct SceneData {
  std::string html;
  nlohmann::json scene;
  std::size_t size = 0;  ///< of both [bytes]
};

/// Packs `n` of the snapshots, and of each the first of every `every` particles.
SceneData pack_scene(const Case& case_, const std::vector<std::filesystem::path>& snapshots, std::size_t n,
                     std::size_t every) {
  const std::size_t n_all = snapshots.size();
  SceneData packed;
  nlohmann::json& scene = packed.scene;
  double spacing = 0;
  for (const BodySpec& body : case_.bodies) spacing = std::max(spacing, body.spacing);
  scene["dim"] = case_.dim;
  scene["spacing"] = spacing * (every > 1 ? std::pow(double(every), 1.0 / case_.dim) : 1);
  scene["floor"] = case_.domain.min[case_.dim - 1];
  scene["every"] = every;
  scene["notes"] =
      "Values are rounded to 0.2 %, positions to 1/65535 of the extent; snapshots have them in full." +
      (n < n_all
           ? fmt::format(" The page shows {} of {} snapshots, to limit its size; output.report = \"full\" shows all.",
                         n, n_all)
           : "") +
      (every > 1 ? fmt::format(" The page shows one particle in {}, drawn larger.", every) : "");

  std::string& data = packed.html;
  scene["solids"] = pack_solids(case_, data);
  bool numbered = true;
  for (std::size_t i : spread_out(n_all, n)) {
    Observation seen = read_snapshot(snapshots[i], every);
    numbered =
        numbered &&
        rows_are_numbers(seen, every, scene.contains("frames") ? int(scene["frames"][0]["n"]) : seen.n_particles());
    remove_numbers(seen);
    const nlohmann::json quantities = quantities_of(seen);
    if (!scene.contains("quantities")) scene["quantities"] = quantities;
    if (quantities != scene["quantities"])
      throw std::runtime_error(
          fmt::format("{} holds other fields than {}", snapshots[i].string(), snapshots[0].string()));
    const Instant instant = pack(seen, scene["frames"].size());
    data += instant.html;
    scene["frames"].push_back(instant.facts);
    for (const Solid& solid : case_.solids) scene["frames"].back()["poses"].push_back(pose_of(solid, seen.time));
  }
  scene["numbered"] = numbered;
  packed.size = data.size() + scene.dump().size();
  return packed;
}

}  // namespace

std::string viewer(const Case& case_, const std::vector<std::filesystem::path>& snapshots, std::size_t budget) {
  if (snapshots.empty()) throw std::runtime_error("there are no snapshots");
  const std::size_t n_all = snapshots.size();

  const std::size_t fewest = std::min<std::size_t>(fewest_instants, n_all);
  constexpr double margin = 0.97;                    // for what the estimate does not see
  double room = margin * double(budget), bytes = 1;  // for particles; of an instant with all of them
  std::size_t n = n_all, every = 1;
  const auto fit = [&] {
    n = std::clamp(std::size_t(std::min(room / bytes, double(n_all))), fewest, n_all);
    every = std::size_t(std::max(1.0, std::ceil(double(n) * bytes / room)));
  };

  // Size of an instant, from three as if it went on straight from one to the next, and from about as many particles as the page
  // will show: the fewer, the less neighbours have in common, and the more bytes each takes.
  const std::vector<std::size_t> samples = spread_out(n_all, std::min<std::size_t>(3, n_all));
  constexpr std::size_t first_guess = 20'000;
  std::size_t sampled = 1;
  for (std::size_t i : samples) sampled = std::max(sampled, 1 + particles_in(snapshots[i]) / first_guess);
  for (;; sampled = every) {
    bytes = 1;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const double share = n_all <= 3 ? 1.0 / double(n_all) : k == 1 ? 0.5 : 0.25;
      bytes += share * double(pack(seen_in(snapshots[samples[k]], sampled), 0).html.size() * sampled);
    }
    fit();
    const bool all_fits = every == 1 && n == n_all;
    if (all_fits || 2 * every >= sampled) break;
  }
  SceneData packed;
  // Other instants than these may be larger, and solids count too: if the result is too large, once more with the
  // size of an instant that it had, and less room.
  for (int trial = 0; trial < 6; ++trial) {
    packed = pack_scene(case_, snapshots, n, every);
    if (packed.size <= budget) break;
    bytes = std::max(bytes, double(packed.size) * double(every) / double(n));
    room *= margin;
    fit();
  }
  return std::string(page_parts::viewer_html()) + packed.html + embedded_json("scene", packed.scene.dump()) +
         embedded_script(page_parts::three_js()) + embedded_script(page_parts::orbit_controls_js()) +
         embedded_script(page_parts::viewer_js());
}

}  // namespace talus
