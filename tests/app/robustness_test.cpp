/// The program where something is missing, full, too small, or not as a user thinks.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "app/program.hpp"
#include "folder_of_its_own.hpp"

namespace robustness_test {

namespace fs = std::filesystem;

using program::contents, program::Finished, program::has, program::talus;

class Robustness : public talus::FolderOfItsOwn {
 protected:
  std::string in(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return in(name);
  }
  /// A folder as PATH that has only these programs.
  std::string path_with(const std::vector<std::string>& programs) const {
    fs::create_directories(folder_ / "bin");
    for (const std::string& p : programs) fs::create_symlink("/usr/bin/" + p, folder_ / "bin" / p);
    return in("bin");
  }
  /// talus under a limit of the shell, such as "ulimit -f 10".
  static Finished limited(const std::string& limit, const std::string& arguments) {
    return talus(arguments + "'", "bash -c '" + limit + "; exec");
  }
};
const std::string cases = TALUS_SOURCE_DIR "/cases/";

TEST_F(Robustness, ARunWithoutPicturesHasItsChartsAndNoWordOfGnuplot) {
  const Finished run =
      talus("run " + cases + "free_fall.toml --until '20 ms' --set 'output.pictures=[]' --out " + in("out"));
  ASSERT_EQ(run.code, 0) << run.output;
  EXPECT_FALSE(has(run.output, "gnuplot")) << run.output;
  EXPECT_TRUE(fs::exists(folder_ / "out/pictures/energy.svg"));
  EXPECT_TRUE(fs::exists(folder_ / "out/report.html"));
}

TEST_F(Robustness, ARunWithoutGnuplotSucceedsAndSaysWhatIsMissing) {
  const Finished run =
      talus("run " + cases + "free_fall.toml --until '20 ms' --out " + in("out"), "PATH=" + path_with({"true"}));
  EXPECT_EQ(run.code, 0) << run.output;
  EXPECT_TRUE(has(run.output, "no pictures: gnuplot is not installed")) << run.output;
  EXPECT_FALSE(fs::exists(folder_ / "out/pictures/energy.svg"));
  EXPECT_TRUE(has(contents(folder_ / "out/report.html"), "id=\"history\""));
}

TEST_F(Robustness, MoreThreadsThanProcessorsAreReducedUnlessTheyAreForced) {
  const int processors = int(std::thread::hardware_concurrency());
  const std::string run =
      "run " + cases + "free_fall.toml --until '5 ms' --overwrite --out " + in("out") + " --threads ";
  const auto threads = [&] {
    return nlohmann::json::parse(contents(folder_ / "out/record.json"))["machine"]["threads"].get<int>();
  };
  const Finished many = talus(run + "999");
  ASSERT_EQ(many.code, 0) << many.output;
  EXPECT_TRUE(has(many.output, "warning: --threads 999 is more than the ")) << many.output;
  EXPECT_TRUE(has(many.output, "--force-threads")) << many.output;
  EXPECT_EQ(threads(), processors);
  const Finished forced = talus(run + std::to_string(processors + 1) + " --force-threads");
  ASSERT_EQ(forced.code, 0) << forced.output;
  EXPECT_TRUE(has(forced.output, "threads will wait for each other")) << forced.output;
  EXPECT_EQ(threads(), processors + 1);
  EXPECT_FALSE(has(talus(run + "1").output, "warning: --threads"));
}

TEST_F(Robustness, OutOfMemoryIsAMessage) {
  // The program and its libraries take some 300 MB of addresses; the million particles of this case do not fit into the rest.
  const Finished run =
      limited("ulimit -v 600000",
              "run " + cases + "slump_2d.toml --threads 1 --set \"body.column.spacing=0.06 mm\" --out " + in("out"));
  EXPECT_EQ(run.code, 3) << run.output;
  EXPECT_TRUE(has(run.output, "not enough memory")) << run.output;
  // HDF5 uses memory that it did not get, or leaves. Libraries that get none before the program begins say so in words of
  // their own.
  for (int kilobytes = 150000; kilobytes < 300000; kilobytes += 7000) {
    const Finished small =
        limited("ulimit -v " + std::to_string(kilobytes),
                "run " + cases + "free_fall.toml --threads 2 --until \"10 ms\" --overwrite --out " + in("small"));
    const bool could_not_start = small.code == 127 || has(small.output, "emory") || has(small.output, "bad_alloc");
    EXPECT_TRUE(small.code == 0 || small.code == 3 || could_not_start) << kilobytes << " kB\n" << small.output;
    EXPECT_FALSE(small.output.empty());
  }
}

TEST_F(Robustness, AFileBeyondTheLimitOfTheShellIsAMessageWithTheFile) {
  const Finished run = limited("ulimit -f 8", "run " + cases + "elastic_bar.toml --out " + in("out"));
  EXPECT_EQ(run.code, 3) << run.output;
  EXPECT_TRUE(has(run.output, "cannot be written")) << run.output;
}

TEST_F(Robustness, AFullStandardOutputIsAFailure) {
  for (const std::string& command :
       {std::string("list"), std::string("new slump_2d"), "check " + cases + "free_fall.toml", std::string("--version"),
        "run " + cases + "free_fall.toml --until \"5 ms\" --out " + in("out")}) {
    const Finished full = talus(command + " >/dev/full'", "bash -c 'exec");
    EXPECT_EQ(full.code, 3) << command << "\n" << full.output;
  }
  EXPECT_TRUE(has(talus("list >/dev/full'", "bash -c 'exec").output, "standard output cannot be written"));
}

TEST_F(Robustness, MaterialTooSoftForItsWeightIsNamedAsTheCause) {
  const Finished run =
      talus("run " + cases + "free_fall.toml --set 'domain.gravity=[\"0 m/s2\", \"0 m/s2\", \"-1e6 m/s2\"]' --out " +
            in("out") + " --overwrite");
  EXPECT_EQ(run.code, 3) << run.output;
  EXPECT_TRUE(has(run.output, "Use a stiffer material or less gravity.")) << run.output;
  EXPECT_FALSE(has(run.output, "larger domain")) << run.output;
}

// 1 Pa is too soft to stand, but nothing stands in free fall, where single steps are half a cell long.
TEST_F(Robustness, SoftMaterialFallsFreely) {
  const Finished run = talus("run " + cases + "free_fall.toml --set 'material.sand.E=1 Pa' --out " + in("out"));
  EXPECT_EQ(run.code, 0) << run.output;
}

TEST_F(Robustness, TitlesThatCannotBeMeantAreRefusedAndNotEchoed) {
  std::string text = contents(cases + "free_fall.toml");
  const auto with_title = [&](const std::string& title) {
    return "title = \"" + title + "\"" + text.substr(text.find('\n'));
  };
  const Finished turned = talus("check " + write("turned.toml", with_title("fall \xe2\x80\xae llaf")));
  EXPECT_EQ(turned.code, 2) << turned.output;
  EXPECT_TRUE(has(turned.output, "turned.toml:1:9: title = \"fall \\u202e llaf\" contains a control character"))
      << turned.output;
  const Finished large = talus("check " + write("large.toml", with_title(std::string(900000, 'x'))));
  EXPECT_EQ(large.code, 2);
  EXPECT_TRUE(has(large.output, "has 900000 characters; at most 200 are read")) << large.output.substr(0, 500);
  EXPECT_LT(large.output.size(), 500u);
}

TEST_F(Robustness, PointsAtTheSamePlaceAreRefusedWithTheirLines) {
  std::ostringstream points;
  points << "x,y\n";
  for (int i = 0; i < 9; ++i) points << 0.1 + 0.01 * i << ",0.5\n";
  points << "0.12,0.5\n";  // line 11, as line 4
  write("points.csv", points.str());
  const Finished check = talus("check " + write("case.toml", R"(title = "points"
[domain]
kind = "plane_strain"
min = ["0 m", "0 m"]
max = ["1 m", "1 m"]
cell = "20 mm"
gravity = ["0 m/s2", "-9.81 m/s2"]
[material.m]
law = "linear_elastic"
E = "1 MPa"
nu = 0.3
density = "1600 kg/m3"
[body.b]
material = "m"
points = { file = "points.csv" }
spacing = "10 mm"
initial_stress = "zero"
[run]
end = "10 ms"
)"));
  EXPECT_EQ(check.code, 2) << check.output;
  EXPECT_TRUE(has(check.output, "points.csv:11: the point is at the same place as that of line 4")) << check.output;
}

TEST_F(Robustness, ListMarksTheDefaultsThatRunsHave) {
  const std::string list = talus("list").output;
  const auto line = [&](const std::string& word) {
    const auto at = list.find("\n  " + word + " ");
    return at == list.npos ? "" : list.substr(at, list.find('\n', at + 1) - at);
  };
  for (const char* word : {"return_mapping", "affine_tau", "quadratic", "usf", "standard", "open", "cells"})
    EXPECT_TRUE(has(line(word), "[default]")) << line(word);
  for (const char* word : {"modified_euler", "k0", "zero", "x_min", "linear", "corner"})
    EXPECT_FALSE(has(line(word), "[default]")) << line(word);
}

TEST_F(Robustness, ValuesAreReplacedOnTheCommandLineAndTheResultsHoldTheCaseThatWasRun) {
  const std::string set = " --set 'material.sand.density=2000 kg/m3' --set run.end='5 ms'";
  const Finished check = talus("check " + cases + "free_fall.toml" + set);
  ASSERT_EQ(check.code, 0) << check.output;
  EXPECT_TRUE(has(check.output, "2000 kg/m3")) << check.output;
  const Finished run = talus("run " + cases + "free_fall.toml" + set + " --out " + in("out"));
  ASSERT_EQ(run.code, 0) << run.output;
  const std::string written = contents(folder_ / "out/case.toml");
  EXPECT_TRUE(has(written, "2000 kg/m3"));
  const Finished again = talus("run " + in("out/case.toml") + " --out " + in("again"));
  ASSERT_EQ(again.code, 0) << again.output;
  EXPECT_EQ(contents(folder_ / "again/history.csv"), contents(folder_ / "out/history.csv"));
  EXPECT_EQ(talus("run " + cases + "free_fall.toml" + set + " --resume --out " + in("out")).code, 0);
  const Finished other = talus("run " + cases + "free_fall.toml --resume --out " + in("out"));
  EXPECT_EQ(other.code, 2);
  EXPECT_TRUE(has(other.output, "is of another case")) << other.output;
  const Finished wrong = talus("check " + cases + "free_fall.toml --set material.sand.densty=1");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(has(wrong.output, "--set material.sand.densty=1: ")) << wrong.output;
  EXPECT_TRUE(has(wrong.output, "did you mean `density`")) << wrong.output;
}

TEST_F(Robustness, TheProgressOfARunFitsIntoANarrowTerminal) {
  // `script` gives the program a terminal, whose width stty sets.
  const Finished run = talus("run " + cases + "free_fall.toml --threads 1 --out " + in("out") + "\" /dev/null",
                             "script -qec \"stty cols 40; exec");
  ASSERT_EQ(run.code, 0) << run.output;
  int live = 0;
  for (std::size_t at = 0; (at = run.output.find("\r\033[K", at)) != run.output.npos; ++live) {
    at += 4;
    const std::size_t end = run.output.find_first_of("\r\n", at);
    const bool is_live = run.output.compare(end, 4, "\r\033[K") == 0;  // else it is the last line, which stays
    EXPECT_TRUE(!is_live || end - at < 40) << run.output.substr(at, end - at);
  }
  EXPECT_GT(live, 0) << run.output;
  // The last lines are broken between words, where the words permit it.
  const std::size_t last = run.output.rfind("\r\033[K") + 4, paths = run.output.find("picture:", last);
  ASSERT_NE(paths, run.output.npos) << run.output;
  std::istringstream end(run.output.substr(last, paths - last));
  for (std::string line; std::getline(end, line);) {
    if (line.ends_with('\r')) line.pop_back();
    EXPECT_TRUE(line.size() <= 40 || line.find(' ') == line.npos) << line;
  }
  EXPECT_TRUE(has(run.output, "\r\nwarning: ")) << run.output;
}

}  // namespace robustness_test
