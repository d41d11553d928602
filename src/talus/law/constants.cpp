#include "talus/law/constants.hpp"

#include <fmt/format.h>

#include <cmath>

#include "talus/base/units.hpp"

namespace talus {

namespace {

constexpr Parameter general_constants[n_general_constants] = {
    {"law", "1", Range::between(1, 1000), "number of the law"},
    {"stress_unit", "1", Range::positive(), "unit of stress that is passed, in Pa: 1 for Pa, 1000 for kPa"},
    {"integrator", "1", Range::between(0, 2), "0 modified_euler, 1 return_mapping, 2 forward_euler"},
    {"tolerance", "1", Range::between(0, 0.1), "relative error of the stress in a substep of modified_euler; 0: 1e-6"},
    {"void_ratio", "1", Range::not_negative(), "void ratio at the start; 0 for laws without one"},
    {"background_pressure", "Pa", Range::not_negative(),
     "constant pressure of contacts that are not modelled, of mu_i"},
};

/// Reads constants one after the other and collects what is wrong with them.
class ConstantReader {
 public:
  ConstantReader(std::span<const double> constants, std::string_view array) : constants_(constants), array_(array) {}

  bool is_right() const { return complaints_.empty(); }
  const std::string& complaints() const { return complaints_; }

  double next(const Parameter& p) {
    const std::size_t i = next_++;
    if (i >= constants_.size()) {
      complain(i, p.key, fmt::format("is missing: {}", p.meaning));
      return 0;
    }
    if (!std::isfinite(constants_[i]) || !p.range.contains(constants_[i]))
      complain(i, p.key,
               fmt::format("= {:g} is out of range; it must be {}: {}", constants_[i], in_words(p.range, p.unit),
                           p.meaning));
    return constants_[i];
  }
  int next_choice(const Option& o) {
    std::string words;
    for (std::size_t k = 0; k < o.choices.size(); ++k)
      words += fmt::format("{}{} {}", k > 0 ? ", " : "", k, o.choices[k].word);
    const double value = next({o.key, "1", Range::between(0, double(o.choices.size() - 1)), words});
    return whole(value, o.key, words);
  }
  int whole(double value, std::string_view key, std::string_view meaning) {
    const bool is_whole = value == std::floor(value) && std::abs(value) < 1e6;
    if (!is_whole) complain(next_ - 1, key, fmt::format("= {:g} is not a whole number: {}", value, meaning));
    return is_whole ? int(value) : 0;
  }
  void complain(std::size_t i, std::string_view key, const std::string& text) {
    complaints_ += fmt::format("{}{}({}) {} {}", complaints_.empty() ? "" : "\n", array_, i + 1, key, text);
  }

 private:
  std::span<const double> constants_;
  std::string_view array_;
  std::size_t next_ = 0;
  std::string complaints_;
};

template <class Law>
AnyLaw law_from(ConstantReader& reader) {
  Law law{};
  std::size_t number = n_general_constants;
  for (const auto& p : Law::parameters()) p.value(law) = reader.next(p);
  for (const auto& o : Law::options()) o.set(law, reader.is_right() ? reader.next_choice(o) : 0);
  if constexpr (requires { law.fault(); })
    if (const std::optional<Fault> fault = law.fault(); fault && reader.is_right()) {
      for (const auto& p : Law::parameters()) {
        if (p.key == fault->key) break;
        ++number;
      }
      reader.complain(number, fault->key, std::string(fault->why));
    }
  law.prepare();
  return settled(law);
}

}  // namespace

std::variant<MaterialConstants, std::string> material_from_constants(std::span<const double> constants,
                                                                     std::string_view array) {
  MaterialConstants m;
  ConstantReader reader(constants, array);
  const int number = reader.whole(reader.next(general_constants[0]), "law", "number of the law");
  m.stress_unit = reader.next(general_constants[1]);
  const Parameter& integrator = general_constants[2];
  m.integration.scheme = Integrator(reader.whole(reader.next(integrator), integrator.key, integrator.meaning));
  if (const double tolerance = reader.next(general_constants[3]); tolerance > 0) m.integration.tolerance = tolerance;
  m.void_ratio = reader.next(general_constants[4]);
  m.background_pressure = reader.next(general_constants[5]);
  bool found = false;
  Laws::for_each([&]<class Law>() {
    if (!is_named<Law> || number_of_law(Law::name) != number || number == 0) return;
    found = true;
    m.law = law_from<Law>(reader);
  });
  if (!found && reader.is_right()) {
    std::string known;
    for (const LawNumber& l : law_numbers) known += fmt::format("{}{} {}", known.empty() ? "" : ", ", l.number, l.name);
    reader.complain(0, "law", fmt::format("= {} is no law; the laws are {}", number, known));
  }
  if (!reader.is_right()) return reader.complaints();
  return m;
}

std::vector<NamedConstant> constants_of(const MaterialConstants& material) {
  std::vector<NamedConstant> all;
  const auto add = [&](const Parameter& p, double value) {
    all.push_back({std::string(p.key), std::string(p.unit), std::string(p.meaning), value});
  };
  const double general[n_general_constants] = {
      std::visit([](const auto& l) { return double(number_of_law(l.name)); }, material.law),
      material.stress_unit,
      double(material.integration.scheme),
      material.integration.tolerance,
      material.void_ratio,
      material.background_pressure};
  for (int i = 0; i < n_general_constants; ++i) add(general_constants[i], general[i]);
  std::visit(
      [&]<class Law>(Law law) {
        for (const auto& p : Law::parameters()) add(p, p.value(law));
        for (const auto& o : Law::options()) {
          std::string words;
          for (std::size_t k = 0; k < o.choices.size(); ++k)
            words += fmt::format("{}{} {}", k > 0 ? ", " : "", k, o.choices[k].word);
          all.push_back({std::string(o.key), "1", words, double(o.get(law))});
        }
      },
      material.law);
  return all;
}

}  // namespace talus
