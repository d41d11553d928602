/// A law from C++: wrong settings are reported together; a thousand points are updated at a time.

#include <talus/law.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

int main() {
  char message[2000];
  talus_law* made = nullptr;
  const talus_setting wrong[] = {{"E", "10", 0}, {"mu", nullptr, 0.3}};
  if (talus_law_make("linear_elastic", wrong, 2, &made, message, sizeof message) != TALUS_INPUT_ERROR) return 1;
  if (!std::strstr(message, "E = ") || !std::strstr(message, "did you mean `nu`")) return std::puts(message), 2;

  const talus_setting right[] = {{"E", "10 MPa", 0}, {"nu", nullptr, 0.25}};
  if (talus_law_make("linear_elastic", right, 2, &made, message, sizeof message) != TALUS_OK) return 3;
  const std::unique_ptr<talus_law, decltype(&talus_law_free)> law(made, talus_law_free);
  const std::size_t n = 1000, size = talus_law_state_size(law.get());
  talus_initial initial;
  talus_initial_defaults(&initial);
  std::vector<double> states(n * size), strains(6 * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    if (talus_law_initial_state(law.get(), &initial, &states[i * size], message, sizeof message) != TALUS_OK) return 4;
    strains[6 * i] = 1e-6 * double(i);
  }
  std::vector<talus_response> responses(n);
  talus_law_update_many(law.get(), n, states.data(), strains.data(), nullptr, 1, responses.data());
  // lambda + 2 G = E (1 - nu)/((1 + nu)(1 - 2 nu)) = 12 MPa
  for (std::size_t i = 0; i < n; ++i)
    if (std::abs(responses[i].stress[0] - 12e6 * strains[6 * i]) > 1e-6) return 5;
  std::puts("ok");
}
