#include "talus/case/read_law.hpp"

#include <fmt/format.h>

#include <cmath>

namespace talus {

namespace {

/// What the ranges of single parameters cannot say.
void check(Section& section, const MuI& law) {
  if (law.mu_d < law.mu_s)
    section.complain(
        "mu_d",
        fmt::format("must not be less than mu_s = {}: friction grows with the inertial number (Eq. 16)", law.mu_s));
}
template <bool H>
void check(Section& section, const GranularOf<H>& law) {
  check(section, law.collisional);
}
void check(Section& section, const MohrCoulomb& law) {
  if (law.psi > law.phi) section.complain("psi", "must not exceed phi: such a material would create energy");
}
template <class Law>
void check(Section&, const Law&) {}

}  // namespace

AnyLaw read_law(Section& section) {
  std::vector<Choice> laws;
  Laws::for_each([&]<class Law>() {
    if (is_named<Law>) laws.push_back({Law::name, Law::meaning});
  });
  const int chosen = section.required_choice({"law", "constitutive law", laws});
  AnyLaw result;
  Laws::for_each([&]<class Law>() {
    if (!is_named<Law> || Law::name != laws[chosen].word) return;
    Law law{};
    for (const auto& p : Law::parameters()) p.value(law) = section.number(p);
    for (const auto& o : Law::options()) o.set(law, section.choice(o));
    check(section, law);
    law.prepare();
    result = settled(law);
  });
  return result;
}

std::string name_of(const AnyLaw& law) {
  return std::visit([](const auto& l) { return std::string(l.name); }, law);
}

}  // namespace talus
