#pragma once
/// The loading path of an element test.

#include <string>
#include <vector>

#include "talus/case/loading.hpp"
#include "talus/input/reader.hpp"

namespace talus {

/// Stresses that a user may give: beyond, the numbers of a law have no meaning [Pa].
inline constexpr Range pressures = Range::between(0, 1e12), stresses = Range::between(-1e12, 1e12);

const Declaration& element_test_declaration();
const Declaration& segment_declaration();
/// The keys of tests by their names.
std::vector<Entry> entries_of_named_tests();

/// The table [[segment]]: adds as many segments to the path as it makes, with `repeat` also of those before it. Files it names
/// are looked for in `folder`.
void add_segments(Section& s, const std::string& folder, std::vector<Segment>& path);

/// A test by its name: one segment, or with turning points (`reversals`) one for every way between them.
std::vector<Segment> read_named_test(Section& s, Segment segment);

}  // namespace talus
