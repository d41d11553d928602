#include <filesystem>

#include "talus/case/resolve.hpp"
#include "talus/input/sections.hpp"
#include "talus/mpm/start/check_start.hpp"

namespace talus {

namespace {

constexpr Text title_of_case{"title", "what the case is, in one line", 200};

const Declaration& run_declaration() {
  static const Declaration d("[run]", {required(keys::end), optional(keys::stop_below)});
  return d;
}
constexpr Table run_table{"run", "how long", run_declaration};

}  // namespace

const Declaration& case_declaration() {
  static const Declaration d(
      "a case", {required(title_of_case), required(keys::domain), required(keys::materials), required(keys::bodies),
                 optional(keys::loads), optional(keys::solids), optional(keys::terrain), optional(keys::numerics),
                 required(run_table), optional(keys::output), optional(keys::gauges), optional(keys::thalweg)});
  return d;
}

namespace {

/// `with_start`: also what can be wrong at the start, for which particles are placed.
Case understand(Document& document, const std::string& folder, bool with_start) {
  Case case_;
  Section root = Section::root(document, &case_declaration());
  case_.title = root.text(title_of_case);
  Section numerics = root.optional_section(keys::numerics);
  read_materials(root, numerics.is_text(keys::preset.key, "paper") ? Preset::paper : Preset::standard, case_);
  read_domain(root, case_);
  const std::optional<TerrainCrop> crop = read_terrain(root, case_, folder);
  read_bodies(root, case_, folder, crop);
  read_loads(root, case_);
  read_solids(root, case_, folder);
  read_numerics(numerics, case_);
  const bool is_right_so_far = document.is_right();
  Section run = root.section(run_table);
  case_.end = run.number(keys::end);
  case_.stop_below = run.optional_number(keys::stop_below).value_or(0);
  run.close();
  read_output(root, case_);
  read_gauges(root, case_, folder);
  root.close();
  const Resolved resolved = resolve_read(std::move(case_));
  for (const Mistake& m : resolved.mistakes) root.complain(m);
  if (is_right_so_far && resolved.mistakes.empty())
    for (const Mistake& m : check_complete(resolved.case_)) root.complain(m);
  if (with_start && document.is_right())
    for (const Mistake& m : check_start(resolved.case_)) root.complain(m);
  return resolved.case_;
}

/// The folder where a case looks for files that it names.
std::string folder_of(const std::string& name) { return std::filesystem::path(name).parent_path().string(); }

}  // namespace

Case understand_case(Document& document, const std::string& folder) { return understand(document, folder, true); }

bool can_be_read_at(const std::string& name, std::string_view text) {
  try {
    Document document(name, text);
    understand(document, folder_of(name), false);
    return document.is_right();
  } catch (const InputError&) {  // no TOML
    return false;
  }
}

CaseFile read_case_text(const std::string& name, std::string_view text, const std::string& folder) {
  Document document(name, text);
  Case case_ = understand_case(document, folder.empty() ? folder_of(name) : folder);
  document.finish();
  return {std::move(case_), std::move(document.understood())};
}

CaseFile read_case(const std::string& path, const std::vector<Override>& overrides) {
  Document document(path);
  document.replace(overrides);
  Case case_ = understand_case(document, folder_of(path));
  document.finish();
  return {std::move(case_), std::move(document.understood())};
}

}  // namespace talus
