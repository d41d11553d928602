#pragma once
/// From an input file to a case or an element test.

#include <string>
#include <vector>

#include "talus/base/error.hpp"
#include "talus/case/case.hpp"
#include "talus/case/estimate.hpp"
#include "talus/case/loading.hpp"
#include "talus/input/overrides.hpp"

namespace talus {

/// One setting with the value that talus uses.
struct Understood {
  std::string path;   ///< "material.glass.d"
  std::string value;  ///< with unit
  bool by_default;    ///< the user did not say it
  std::string meaning;
};

struct CaseFile {
  Case case_;
  std::vector<Understood> understood;
};
struct ElementTestFile {
  ElementTest test;
  std::vector<Understood> understood;
};

/// Reads and checks a file, in which some values are replaced first. Throws InputError with every mistake at once.
CaseFile read_case(const std::string& path, const std::vector<Override>& overrides = {});
ElementTestFile read_element_test(const std::string& path, const std::vector<Override>& overrides = {});

/// The same from a text; `name` stands for the file in messages, `folder` is where files it names are looked for. If it
/// is empty, a case looks in the folder of `name`.
CaseFile read_case_text(const std::string& name, std::string_view text, const std::string& folder = "");
ElementTestFile read_element_test_text(const std::string& name, std::string_view text, const std::string& folder);

/// Whether a case that is right elsewhere is so with the name of this file, too, in whose folder it looks for other files.
/// Does not place its particles.
bool can_be_read_at(const std::string& name, std::string_view text);

class Document;
/// The same from a document, in which mistakes stay.
Case understand_case(Document& document, const std::string& folder);
ElementTest understand_element_test(Document& document, const std::string& folder);

}  // namespace talus
