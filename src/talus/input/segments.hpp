#pragma once
/// The loading path of an element test.

#include <string>
#include <vector>

#include "talus/case/loading.hpp"
#include "talus/input/reader.hpp"

namespace talus {

const Declaration& element_test_declaration();
const Declaration& segment_declaration();
/// The keys of tests by their names.
std::vector<Entry> entries_of_named_tests();

/// The table [[segment]]: as many segments as it makes of the path. Files it names are looked for in `folder`.
std::vector<Segment> read_segment(Section& s, const std::string& folder);

/// A test by its name: one segment, or with turning points (`reversals`) one for every way between them.
std::vector<Segment> read_named_test(Section& s, Segment segment);

}  // namespace talus
