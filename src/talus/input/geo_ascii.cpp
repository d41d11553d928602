#include "talus/input/geo_ascii.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <istream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "talus/base/text.hpp"
#include "talus/input/geodata.hpp"

namespace talus {

namespace {

constexpr std::string_view blanks = " \t\r\n\v\f";
constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

/// Takes the first word off a line; empty at its end.
std::string_view take_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

/// NaN for "nan"; infinite where it is too large for a double.
std::optional<double> number_of(std::string_view word) {
  if (word.size() > 1 && word.front() == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || failure == std::errc::invalid_argument) return {};
  if (failure == std::errc::result_out_of_range) return std::strtod(std::string(word).c_str(), nullptr);
  return value;
}

/// A key as it is compared: `NODATA_value`, `nodata_value` and `no_data_value` are one.
std::string plain(std::string_view word) {
  std::string key;
  for (char c : word)
    if (c != '_' && c != '-' && c != ':') key += char(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return key;
}

/// Reads a line as std::getline does, but only to the first byte of zero: a file of such bytes, as a download that was
/// interrupted leaves, has one line without an end.
bool read_line(std::istream& in, std::string& line) {
  line.clear();
  std::streambuf& bytes = *in.rdbuf();
  try {
    for (int c = bytes.sbumpc(); c != std::char_traits<char>::eof(); c = bytes.sbumpc()) {
      if (c == '\n') return true;
      line.push_back(char(c));
      if (c == 0) return true;
    }
  } catch (const std::ios_base::failure&) {  // where the disk fails
    in.setstate(std::ios::badbit);
    return false;
  }
  return !line.empty();
}

/// The header of a raster, and where in its text values begin.
class Header {
 public:
  explicit Header(const std::string& path) : path_(path) {}

  /// Whether a line belongs to the header, which it is then taken into.
  bool accept(std::string_view line, int number) {
    std::string_view rest = line;
    const std::string_view word = take_word(rest);
    if (word.empty() || word.front() == '#') return true;
    if (!std::isalpha(static_cast<unsigned char>(word.front())) || number_of(word)) return false;
    const std::string key = plain(word);
    const std::string_view text = take_word(rest);
    const bool known = std::any_of(std::begin(keys), std::end(keys), [&](std::string_view k) { return k == key; });
    // Some programs write lines of their own, such as `byteorder LSBFIRST`.
    if (!known) return true;
    const std::optional<double> value = number_of(text);
    if (!value) fail(fmt::format(":{}: `{}` needs a number, not \"{}\"", number, printable(word), printable(text)));
    if (!values_.emplace(key == "nodatavalue" ? "nodata" : key, Entry{*value, number}).second)
      fail(fmt::format(":{}: `{}` stands twice in the header", number, printable(word)));
    return true;
  }

  /// A raster without values.
  PlanRaster raster() const {
    PlanRaster raster;
    raster.pixel = cell_size();
    const double columns = count("ncols"), rows = count("nrows");
    if (columns * rows > most_raster_pixels)
      fail(
          fmt::format(" has {} x {} pixels, and at most {} are read; cut out the part that the run needs: "
                      "gdal_translate -projwin WEST NORTH EAST SOUTH IN OUT",
                      columns, rows, most_raster_pixels));
    raster.columns = int(columns);
    raster.rows = int(rows);
    raster.corner = {lower_left("xll", raster.pixel), lower_left("yll", raster.pixel)};
    return raster;
  }
  /// The no-data value. -9999 is the format's default.
  double no_data() const { return values_.count("nodata") ? values_.at("nodata").value : -9999; }

 private:
  static constexpr std::string_view keys[] = {"ncols",    "nrows", "xllcorner", "xllcenter", "yllcorner",  "yllcenter",
                                              "cellsize", "dx",    "dy",        "nodata",    "nodatavalue"};

  /// What a line of the header states.
  struct Entry {
    double value;
    int line;
  };

  [[noreturn]] void fail(const std::string& text) const { throw std::runtime_error(path_ + text); }

  double need(const std::string& key) const {
    const auto found = values_.find(key);
    if (found == values_.end())
      fail(fmt::format(
          " has no `{}` in its header; an ESRI ASCII raster begins with ncols, nrows, xllcorner, yllcorner, "
          "cellsize and NODATA_value",
          key));
    if (!std::isfinite(found->second.value)) fail(fmt::format(": `{}` in the header must be finite", key));
    return found->second.value;
  }
  double count(const std::string& key) const {
    const double n = need(key);
    if (!(n >= 1 && n == std::floor(n)))
      fail(fmt::format(": `{}` in the header is {}, and must be a whole number greater than 0", key, n));
    return n;
  }
  /// The edge of a pixel: `cellsize`, or `dx` and `dy` as other programs write it.
  double cell_size() const {
    for (const auto& [one, other] : {std::pair("dx", "dy"), std::pair("dy", "dx")})
      if (values_.count(one) && !values_.count(other))
        fail(fmt::format(":{}: `{}` needs `{}`, the other edge of a pixel; write both, or `cellsize` alone",
                         values_.at(one).line, one, other));
    const bool sides = values_.count("dx") > 0;
    const double edge = need(sides ? "dx" : "cellsize");
    if (sides && !is_same_edge(need("dy"), edge))
      fail(fmt::format(" has pixels of {} m x {} m, which are not square; resample it: gdalwarp -tr {} {} IN OUT", edge,
                       need("dy"), edge, edge));
    if (sides && values_.count("cellsize") && !is_same_edge(need("cellsize"), edge))
      fail(fmt::format(":{}: `cellsize` is {}, but `dx` and `dy` are {}; keep the one that is right",
                       values_.at("cellsize").line, need("cellsize"), edge));
    if (!(edge > 0)) fail(fmt::format(": the cell size in the header is {}, and must be greater than 0", edge));
    return edge;
  }
  static bool is_same_edge(double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(b); }
  double lower_left(const std::string& axis, double pixel) const {
    const bool middle = values_.count(axis + "center") > 0;
    if (middle && values_.count(axis + "corner"))
      fail(fmt::format(" has both `{}corner` and `{}center` in its header; leave one of them", axis, axis));
    return middle ? need(axis + "center") - pixel / 2 : need(axis + "corner");
  }

  std::string path_;
  std::map<std::string, Entry> values_;
};

/// How many values the lines of a file hold. A row may stand on several lines, and all rows on one; but even lines that
/// are longer than a row, or as many and as long as the columns of the raster, show that the header is that of another.
class LinesOfValues {
 public:
  void add(std::size_t n_values) {
    if (n_values == 0) return;
    if (n_lines_++ == 0) length_ = n_values;
    even_ = even_ && n_values == length_;
  }
  /// Throws std::runtime_error.
  void expect_rows_of(const PlanRaster& raster, const std::string& path) const {
    const auto columns = std::size_t(raster.columns), rows = std::size_t(raster.rows);
    const bool are_columns = length_ == rows && n_lines_ == columns;
    if (n_lines_ > 1 && even_ && length_ != columns && (length_ > columns || are_columns))
      throw std::runtime_error(
          fmt::format("{} has {} lines of {} values, and its header states {} columns and {} rows: it is the header of "
                      "another grid",
                      path, n_lines_, length_, columns, rows));
  }

 private:
  std::size_t n_lines_ = 0, length_ = 0;
  bool even_ = true;
};

}  // namespace

bool is_no_data(double value, double no_data) {
  if (value == no_data || float(value) == float(no_data)) return true;
  // The lowest float is written with as many digits as programs like.
  return std::abs(no_data) > 1e30 && std::abs(value - no_data) <= 1e-4 * std::abs(no_data);
}

bool looks_like_ascii_raster(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  char first[4096];
  in.read(first, sizeof first);
  std::string_view text(first, std::size_t(in.gcount()));
  if (text.substr(0, 3) == byte_order_mark) text.remove_prefix(3);
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::string key = plain(take_word(line));
    if (key == "ncols" || key == "nrows" || key == "cellsize" || key == "xllcorner" || key == "xllcenter") return true;
  }
  return false;
}

AsciiRaster read_ascii_raster(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  Header header(path);
  PlanRaster raster;
  double no_data = 0;
  UnstatedNan unstated_nan;
  LinesOfValues lines;
  std::size_t expected = 0;
  bool in_header = true;
  std::string text;
  for (int number = 1; read_line(in, text); ++number) {
    if (!text.empty() && text.back() == '\0')
      throw std::runtime_error(
          fmt::format("{}:{}: a byte of zero, which no text has; the file is damaged or incomplete", path, number));
    std::string_view line = text;
    if (number == 1 && line.substr(0, 3) == byte_order_mark) line.remove_prefix(3);
    if (in_header && header.accept(line, number)) continue;
    if (in_header) {
      in_header = false;
      raster = header.raster();
      no_data = header.no_data();
      expected = std::size_t(raster.columns) * std::size_t(raster.rows);
      raster.values.reserve(std::min(expected, std::size_t(std::filesystem::file_size(path) / 2 + 1)));
    }
    const std::size_t n_before = raster.values.size();
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
      const std::optional<double> value = number_of(word);
      if (!value)
        throw std::runtime_error(
            fmt::format("{}:{}: \"{}\" is no number{}", path, number, printable(word.substr(0, 40)),
                        word.find(',') != std::string_view::npos ? "; write decimals with a point" : ""));
      if (raster.values.size() == expected)
        throw std::runtime_error(fmt::format("{}:{}: more values than the {} x {} = {} that its header states", path,
                                             number, raster.columns, raster.rows, expected));
      raster.values.push_back(is_no_data(*value, no_data) ? PlanRaster::none : *value);
      if (std::isnan(*value) && !std::isnan(no_data)) {
        const int index = int(raster.values.size()) - 1;
        unstated_nan.add(index % raster.columns, raster.rows - 1 - index / raster.columns);
      }
    }
    lines.add(raster.values.size() - n_before);
  }
  if (in_header) raster = header.raster();  // to name what is missing first
  if (in.bad()) throw std::runtime_error(fmt::format("{} cannot be read", path));
  if (raster.values.size() < expected || expected == 0)
    throw std::runtime_error(fmt::format(
        "{} holds {} values, and its header states {} x {} = {}; the file is incomplete", path, raster.values.size(),
        raster.columns, raster.rows, std::size_t(raster.columns) * std::size_t(raster.rows)));
  lines.expect_rows_of(raster, path);
  // The file begins in the north.
  for (int south = 0, north = raster.rows - 1; south < north; ++south, --north)
    std::swap_ranges(raster.values.begin() + long(raster.index(0, south)),
                     raster.values.begin() + long(raster.index(0, south)) + raster.columns,
                     raster.values.begin() + long(raster.index(0, north)));
  return {std::move(raster), unstated_nan};
}

}  // namespace talus
