/// Where a user begins: cases to start from, and a schema for the editor in which they are changed.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <set>

#include "app/program.hpp"
#include "folder_of_its_own.hpp"
#include "talus/input/read.hpp"
#include "talus/law/registry.hpp"

namespace new_test {

namespace fs = std::filesystem;

using program::contents, program::Finished, program::has;

class ANewCase : public talus::FolderOfItsOwn {
 protected:
  std::string in(const std::string& name) const { return (folder_ / name).string(); }
  /// `talus new` in the folder of the test, with its case in a file; what it says beside the case.
  Finished make(const std::string& name, const std::string& file) const {
    return program::talus("new " + name + " > " + file + ")", "(cd " + folder_.string() + " &&");
  }
  static std::vector<fs::path> shipped(const std::string& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(TALUS_SOURCE_DIR + folder))
      if (entry.path().extension() == ".toml" && entry.path().filename() != "figure.toml")
        files.push_back(entry.path());
    return files;
  }
  static std::vector<std::string> understood(const std::string& file) {
    std::vector<talus::Understood> all = has(contents(file), "[[segment") ? talus::read_element_test(file).understood
                                                                          : talus::read_case(file).understood;
    std::vector<std::string> lines;
    for (const talus::Understood& u : all)
      lines.push_back(u.path + " = " + u.value + (u.by_default ? " by default" : ""));
    return lines;
  }
};

TEST_F(ANewCase, IsTheShippedOneWithAllItsKeysExplained) {
  const Finished list = program::talus("new");
  EXPECT_EQ(list.code, 0);
  for (const fs::path& file : shipped("/cases")) {
    const std::string name = file.stem();
    EXPECT_TRUE(has(list.output, "  " + name + " ")) << name;
    ASSERT_EQ(make(name, name + ".toml").code, 0);
    EXPECT_EQ(understood(in(name + ".toml")), understood(file)) << name;
  }
  const std::string slump = contents(in("slump_2d.toml"));
  EXPECT_TRUE(has(slump, "d = \"1 mm\"                                    # grain diameter (Eqs. 15, 16)\n")) << slump;
  EXPECT_TRUE(has(slump, "#   numerics.cfl = 0.9 ")) << slump;
  const Finished wrong = program::talus("new slump2d");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(has(wrong.output, "`slump2d` is not a case of talus; did you mean `slump_2d`?")) << wrong.output;
}

TEST_F(ANewCase, ComesWithTheMapsThatItNames) {
  const Finished first = make("landslide", "my.toml");
  EXPECT_EQ(first.code, 0);
  EXPECT_TRUE(has(first.output, "  landslide/terrain.asc\n")) << first.output;
  for (const auto& file : fs::directory_iterator(TALUS_SOURCE_DIR "/cases/landslide"))
    EXPECT_EQ(contents(folder_ / "landslide" / file.path().filename()), contents(file)) << file;
  EXPECT_EQ(program::talus("check " + in("my.toml")).code, 0);
  // What is there is the user's.
  std::ofstream(folder_ / "landslide" / "terrain.asc") << "mine";
  const Finished second = make("landslide", "my.toml");
  EXPECT_EQ(second.code, 0);
  EXPECT_TRUE(has(second.output, "landslide/, which is there already")) << second.output;
  EXPECT_EQ(contents(folder_ / "landslide" / "terrain.asc"), "mine");
}

TEST_F(ANewCase, IsKnownToEditorsByASchema) {
  ASSERT_EQ(program::talus("schema > " + in("schema.json")).code, 0);
  std::string names;
  int n = 0;
  for (const char* folder : {"/cases", "/validation"})
    for (const fs::path& file : shipped(folder)) {
      names += " " + file.string();
      ++n;
    }
  // What an editor must mark: the same mistakes that the reader refuses.
  const std::string slump = contents(TALUS_SOURCE_DIR "/cases/slump_2d.toml");
  const std::pair<std::string, std::string> mistakes[] = {
      {"cell = \"2 mm\"", "cell = 2"}, {"cell = \"2 mm\"", "cells = \"2 mm\""},
      {"nu = 0.2", "nu = 0.5"},        {"Phi_c = 0.70\n", ""},
      {"\"rough\"", "\"sticky\""},     {"law = \"granular\"", "law = \"mohr_coulomb\""},
      {"d = \"1 mm\"", "d = \"mm\""},  {"[run]\nend = \"0.5 s\"", ""}};
  int m = 0;
  for (const auto& [what, with] : mistakes) {
    std::string text = slump;
    ASSERT_NE(text.find(what), text.npos) << what;
    std::ofstream(in("mistake_" + std::to_string(m) + ".toml")) << text.replace(text.find(what), what.size(), with);
    names += " " + in("mistake_" + std::to_string(m++) + ".toml");
  }
  const std::string said = in("said.txt");
  ASSERT_EQ(std::system(("/usr/bin/python3 " TALUS_SOURCE_DIR "/tests/app/check_schema.py " + in("schema.json") +
                         names + " > " + said + " 2>&1")
                            .c_str()),
            0)
      << contents(said);
  std::istringstream lines(contents(said));
  int n_valid = 0, n_mistaken = 0;
  for (std::string line; std::getline(lines, line);) {
    const bool mistaken = has(line, "/mistake_"), valid = has(line, ".toml: valid");
    EXPECT_NE(mistaken, valid) << line;
    ++(mistaken ? n_mistaken : n_valid);
  }
  EXPECT_EQ(n_valid, n);
  EXPECT_EQ(n_mistaken, m);
}

TEST_F(ANewCase, HasEveryLawWithAllItsKeysInItsSchema) {
  ASSERT_EQ(program::talus("schema > " + in("schema.json")).code, 0);
  const auto schema = nlohmann::json::parse(contents(in("schema.json")));
  for (const auto& input : schema["anyOf"]) {
    if (input["title"] == "a calibration") continue;  // there a parameter may be tied instead
    const auto& properties = input["properties"];
    const auto& material = properties["material"]["additionalProperties"].is_object()
                               ? properties["material"]["additionalProperties"]
                               : properties["material"];
    talus::Laws::for_each([&]<class Law>() {
      if (!talus::is_named<Law>) return;
      std::set<std::string> required;
      for (const auto& branch : material["allOf"])
        if (branch["if"]["properties"]["law"]["const"] == Law::name)
          for (const auto& key : branch["then"]["required"]) required.insert(key);
      for (const auto& p : Law::parameters()) EXPECT_TRUE(required.contains(std::string(p.key))) << Law::name << p.key;
      for (const auto& o : Law::options()) EXPECT_TRUE(material["properties"].contains(std::string(o.key)));
    });
  }
  // Every way through the readers was taken: keys that only some of them ask for.
  const std::string all = schema.dump();
  for (const char* key :
       {"flip_share", "tau", "tolerance", "half_space", "normal", "displacements", "threshold", "times", "until",
        "separates", "reversals", "first_row", "volumetric_strain", "shear_strain_rate", "background_pressure",
        "collisional_stress", "checkpoint_wall", "corners", "drainage"})
    EXPECT_TRUE(has(all, "\"" + std::string(key) + "\"")) << key;
}

}  // namespace new_test
