#pragma once
/// Reads the measured tests of a calibration.

#include <map>
#include <string>
#include <vector>

#include "talus/calibration/measured_table.hpp"
#include "talus/calibration/specification.hpp"
#include "talus/input/reader.hpp"

namespace talus {

const Declaration& measured_test_declaration();

/// Reads [[test]] after [[test]]; mistakes become complaints of the document.
class MeasuredTestReader {
 public:
  /// `folder` holds the tables that tests name.
  MeasuredTestReader(std::string folder, const AnyLaw& law) : folder_(std::move(folder)), law_(law) {}

  /// The tests that one entry makes: with `each` one for every value of a column.
  std::vector<MeasuredTest> read(Section& s);

  /// Files that were read.
  const std::map<std::string, MeasuredTable>& tables() const { return tables_; }

 private:
  const MeasuredTable* read_table(Section& s);

  std::string folder_;
  const AnyLaw& law_;
  std::map<std::string, MeasuredTable> tables_;
  std::vector<std::string> names_;
};

}  // namespace talus
