#include "talus/output/viewer.hpp"

#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <future>
#include <stdexcept>

#include "talus/output/page.hpp"
#include "talus/output/page_parts.hpp"
#include "talus/output/snapshot.hpp"

namespace talus {

namespace {

using Words = std::vector<std::uint16_t>;

/// Differences between neighbours, high bytes first, deflated, base64: what viewer.js unpacks. Neighbours in the order of
/// ids are neighbours in space, so most high bytes are 0 or 255.
std::string packed(const Words& words) {
  const std::size_t n = words.size();
  std::string bytes(2 * n, '\0');
  std::uint16_t before = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto difference = std::uint16_t(words[i] - before);
    bytes[i] = char(difference >> 8);
    bytes[n + i] = char(difference & 255);
    before = words[i];
  }
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                1) != Z_OK)
    throw std::runtime_error("zlib could not compress the particles of the report");
  out.resize(size);
  return base64(out);
}

/// Every `every`-th number of component `c`.
std::vector<double> component(const Field& field, int c, std::size_t every) {
  std::vector<double> values;
  for (std::size_t i = c; i < field.values.size(); i += every * field.components) values.push_back(field.values[i]);
  return values;
}

/// Least, 1st and 99th percentile, most of the finite ones; null where there are none.
nlohmann::json range_of(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return nullptr;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double ends[2] = {*least, *most};
  const auto percentile = [&](double share) {
    const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const double low = percentile(0.01), high = percentile(0.99);
  return {ends[0], low, high, ends[1]};
}

struct Packed {
  std::string words;
  nlohmann::json facts;
};

/// Half precision times 2^exponent, so that the largest magnitude lies in [2^14, 2^15) and what is 1e-8 of it still has
/// all its bits. Two of its eleven bits are rounded away: noise in them would make a page a quarter larger.
Packed packed_values(const std::vector<double>& values) {
  double most = 0;
  for (double v : values)
    if (std::isfinite(v)) most = std::max(most, std::abs(v));
  int exponent = 0;
  std::frexp(most, &exponent);  // most < 2^exponent
  exponent = most > 0 ? exponent - 15 : 0;
  Words words;
  words.reserve(values.size());
  for (double v : values) {
    const auto half = Eigen::numext::bit_cast<std::uint16_t>(Eigen::half(float(std::ldexp(v, -exponent))));
    words.push_back(std::uint16_t((half + 2) & ~3));
  }
  return {packed(words), {{"exponent", exponent}, {"range", range_of(values)}}};
}

/// 16 bits between the least and the most.
Packed packed_places(const std::vector<double>& values) {
  if (values.empty()) return {packed({}), {{"low", 0}, {"step", 0}}};
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double low = *least, step = (*most - low) / 65535;
  Words words;
  words.reserve(values.size());
  for (double v : values) words.push_back(step > 0 ? std::uint16_t(std::lround((v - low) / step)) : 0);
  return {packed(words), {{"low", low}, {"step", step}}};
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
void put_axis(const std::string& id, const Packed& places, nlohmann::json& facts, std::string& html) {
  facts["low"].push_back(places.facts["low"]);
  facts["step_of_place"].push_back(places.facts["step"]);
  html += element_of(id, places.words);
}

/// A snapshot without the numbers of the particles, which are not for looking at.
Observation seen_in(const std::filesystem::path& snapshot) {
  Observation seen = read_snapshot(snapshot);
  std::erase_if(seen.fields, [](const Field& f) { return f.name == "id"; });
  return seen;
}

/// One instant: facts for the scene's JSON, and the elements of the page that hold its numbers.
struct Instant {
  nlohmann::json facts;
  std::string html;
};

Instant pack(const Observation& seen, std::size_t frame, std::size_t every) {
  // Compressing is most of the work of a report; a thread for each component.
  std::vector<std::future<Packed>> places, values;
  const auto later = [](auto work) { return std::async(std::launch::async, work); };
  Instant instant;
  for (int a = 0; a < 3; ++a)
    places.push_back(later([&, a] { return packed_places(component(seen.fields[0], a, every)); }));
  for (std::size_t q = 1; q < seen.fields.size(); ++q)
    for (int c = 0; c < seen.fields[q].components; ++c)
      values.push_back(later([&, q, c] { return packed_values(component(seen.fields[q], c, every)); }));

  nlohmann::json& facts = instant.facts;
  facts["time"] = seen.time;
  facts["step"] = seen.step;
  facts["n"] = (seen.n_particles() + every - 1) / every;
  for (int a = 0; a < 3; ++a) put_axis(fmt::format("place-{}-{}", frame, a), places[a].get(), facts, instant.html);
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
      for (std::size_t i = 0; i < v.size(); i += 3 * every) magnitude.push_back(std::hypot(v[i], v[i + 1], v[i + 2]));
      of_components.push_back({{"range", range_of(std::move(magnitude))}});
    }
    facts["values"].push_back(of_components);
  }
  return instant;
}

/// The surfaces of solids as they stood at first, as points: next to each other a line, in space apart, so that one looks
/// through between them.
nlohmann::json pack_solids(const Case& what, std::string& html) {
  constexpr std::size_t most_points = 40'000;
  nlohmann::json solids = nlohmann::json::array();
  for (const Solid& solid : what.solids) {
    const Box box = bounding_box(solid.shape, what.dim, what.domain);
    double spacing = what.cell / (what.dim == 2 ? 8 : 3);
    std::vector<Vec<3>> points = surface_points(solid, {}, box, spacing, what.dim);
    for (; points.size() > most_points; points = surface_points(solid, {}, box, spacing, what.dim)) spacing *= 1.5;
    nlohmann::json facts = {{"name", solid.name}, {"n", points.size()}, {"spacing", spacing}};
    for (int a = 0; a < 3; ++a) {
      std::vector<double> along;
      for (const Vec<3>& x : points) along.push_back(x[a]);
      put_axis(fmt::format("solid-{}-{}", solids.size(), a), packed_places(along), facts, html);
    }
    solids.push_back(facts);
  }
  return solids;
}

/// Where a motion has brought a solid: the rows of x = R x_at_first + t, one after another.
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

/// `n` of `all` numbers, evenly, the first and the last among them.
std::vector<std::size_t> spread_out(std::size_t all, std::size_t n) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < n; ++i) chosen.push_back(n > 1 ? (i * (all - 1) + (n - 1) / 2) / (n - 1) : 0);
  return chosen;
}

}  // namespace

std::string viewer(const Case& what, const std::vector<std::filesystem::path>& snapshots, std::size_t budget) {
  if (snapshots.empty()) throw std::runtime_error("there are no snapshots");
  const std::size_t n_all = snapshots.size();

  // How much an instant takes, on average of three.
  const std::vector<std::size_t> tried = spread_out(n_all, std::min<std::size_t>(3, n_all));
  std::size_t sample = 1;
  for (std::size_t i : tried) sample += pack(seen_in(snapshots[i]), 0, 1).html.size() / tried.size();
  const std::size_t n = std::clamp<std::size_t>(budget / sample, std::min<std::size_t>(fewest_instants, n_all), n_all);
  const std::size_t every = std::max<std::size_t>(1, (n * sample + budget - 1) / budget);

  nlohmann::json scene;
  double spacing = 0;
  for (const BodySpec& body : what.bodies) spacing = std::max(spacing, body.spacing);
  scene["dim"] = what.dim;
  scene["spacing"] = spacing * (every > 1 ? std::pow(double(every), 1.0 / what.dim) : 1);
  scene["floor"] = what.domain.min[what.dim - 1];
  scene["every"] = every;
  scene["notes"] =
      "Values are rounded to 0.2 %, places to 1/65535 of the extent; the snapshots hold them in full." +
      (n < n_all ? fmt::format(" To keep this page small it shows {} of the run's {} snapshots.", n, n_all) : "") +
      (every > 1 ? fmt::format(" Of the particles it shows one in {}, drawn larger.", every) : "");

  std::string data;
  scene["solids"] = pack_solids(what, data);
  for (std::size_t i : spread_out(n_all, n)) {
    const Observation seen = seen_in(snapshots[i]);
    const nlohmann::json quantities = quantities_of(seen);
    if (!scene.contains("quantities")) scene["quantities"] = quantities;
    if (quantities != scene["quantities"])
      throw std::runtime_error(
          fmt::format("{} holds other fields than {}", snapshots[i].string(), snapshots[0].string()));
    const Instant instant = pack(seen, scene["frames"].size(), every);
    data += instant.html;
    scene["frames"].push_back(instant.facts);
    for (const Solid& solid : what.solids) scene["frames"].back()["poses"].push_back(pose_of(solid, seen.time));
  }
  return std::string(page_parts::viewer_html()) + data + embedded_json("scene", scene.dump()) +
         embedded_script(page_parts::three_js()) + embedded_script(page_parts::orbit_controls_js()) +
         embedded_script(page_parts::viewer_js());
}

}  // namespace talus
