#pragma once
/// Reads the curves of a figure.toml, with the element tests and cases they name.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "talus/figure/specification.hpp"
#include "talus/input/reader.hpp"

namespace talus {

/// The name of something that has files of its own; complains if it is among `names`, and adds it to them.
std::string read_name(Section& s, std::string_view meaning, std::vector<std::string>& names);

/// Keys of a test or a case to replace: the table `set`, empty if there is none.
toml::table read_set(Section& s);

/// Reads curves one after another; mistakes become complaints of the document.
class CurveReader {
 public:
  /// `folder` holds the files that curves name, `abscissa` is the default of the curves, `sets` are the keys that each
  /// reading replaces.
  CurveReader(Document& document, std::string folder, std::string abscissa, std::vector<Reading> readings,
              std::vector<toml::table> sets)
      : document_(document),
        folder_(std::move(folder)),
        abscissa_(std::move(abscissa)),
        readings_(std::move(readings)),
        sets_(std::move(sets)) {}

  CurveSpec read(Section& s);

 private:
  /// One run of a curve as the file has it: the keys it replaces, and its values in the sweep's columns.
  struct Step {
    toml::table set;
    std::vector<double> values;
  };
  /// What a curve is computed from, before it is read once for each reading.
  struct Source {
    std::filesystem::path file;  ///< of the element test or the case; empty if the curve is a measurement
    bool is_case = false, is_sweep = false;
    std::vector<std::string> columns;  ///< that the sweep adds
    std::vector<Step> steps;           ///< one that replaces nothing if the curve is no sweep
    toml::table set;                   ///< keys that the curve replaces
    std::string only_reading;          ///< that has this curve; empty if all have it
  };

  Source read_source(Section& s, const CurveSpec& curve) const;
  static void read_sweep(Section& curve, Source& source);
  std::string read_only_reading(Section& s) const;
  /// Adds the curve's test or runs in a reading.
  void add_reading(const Source& source, std::size_t reading, CurveSpec& curve) const;

  Document& document_;
  std::string folder_, abscissa_;
  std::vector<Reading> readings_;
  std::vector<toml::table> sets_;
  std::vector<std::string> names_;
};

}  // namespace talus
