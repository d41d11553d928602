/// Reads whatever it is given as the files that an input names: particles, a motion, strain rates, a picture.

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "talus/input/read.hpp"

namespace {

const std::string folder =
    (std::filesystem::temp_directory_path() / ("talus_fuzz_" + std::to_string(getpid()))).string();

/// A case of which one section is given.
std::string with(const std::string& section) {
  return R"(title = "x"
[domain]
kind = "plane_strain"
min = ["0 m", "0 m"]
max = ["1 m", "1 m"]
cell = "0.1 m"
gravity = ["0 m/s2", "-9.81 m/s2"]
[material.rubber]
law = "linear_elastic"
E = "1 MPa"
nu = 0.3
density = "1000 kg/m3"
[body.block]
material = "rubber"
initial_stress = "zero"
spacing = "0.05 m"
)" + section +
         "[run]\nend = \"1 s\"\n";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/file", std::ios::binary).write(reinterpret_cast<const char*>(data), std::streamsize(size));
  const auto read_case = [](const std::string& section) {
    try {
      talus::read_case_text("fuzz.toml", with(section), folder);
    } catch (const talus::InputError&) {
    }
  };
  if (size > 0 && data[0] == 0x89) {  // how PNG files begin
    read_case("image = { file = \"file\", min = [\"0 m\", \"0 m\"], pixel = \"1 mm\" }\n");
    return 0;
  }
  read_case("points = { file = \"file\" }\n");
  read_case(
      "box = { min = [\"0 m\", \"0 m\"], max = [\"0.2 m\", \"0.2 m\"] }\n[solid.gate]\ncontact = \"slip\"\n"
      "box = { min = [\"0.5 m\", \"0 m\"], max = [\"0.8 m\", \"1 m\"] }\nmotion = { file = \"file\" }\n");
  try {
    talus::read_element_test_text("fuzz.toml", R"(title = "x"
[material]
law = "linear_elastic"
E = "1 MPa"
nu = 0.3
[initial]
pressure = "1 kPa"
[[segment]]
rates = "file"
)",
                                  folder);
  } catch (const talus::InputError&) {
  }
  return 0;
}
