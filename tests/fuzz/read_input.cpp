/// Reads whatever it is given as a case or as an element test. libFuzzer makes the texts: bytes changed at random, and
/// every second time a mistake that a user could make.

#include <cstdint>
#include <cstring>

#include "../input/mistakes.hpp"
#include "talus/input/read.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    if (text.find("[[segment") != text.npos)
      talus::read_element_test_text("fuzz.toml", text, "");
    else
      talus::read_case_text("fuzz.toml", text);
  } catch (const talus::InputError& e) {
    if (e.complaints().empty() || *e.what() == '\0') __builtin_trap();
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned int seed) {
  if (seed % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const std::size_t n = mistakes::count(text);
    const std::string changed = n > 0 ? mistakes::made(text, seed / 2 % n).text : "";
    if (changed.empty() || changed.size() > most) return LLVMFuzzerMutate(data, size, most);
    std::memcpy(data, changed.data(), changed.size());
    return changed.size();
  } catch (const std::exception&) {  // no TOML, or no longer where it was
    return LLVMFuzzerMutate(data, size, most);
  }
}
