#include "talus/input/mesh_file.hpp"

#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "talus/base/text.hpp"
#include "talus/input/geodata.hpp"

namespace talus {

namespace {

constexpr const char* how_to_make_smaller = "let the program that wrote it use larger triangles";

/// Collects the errors that Assimp logs while this object exists. Assimp continues after them: a file that ends too early is a
/// warning.
class ComplaintsOfAssimp {
 public:
  ComplaintsOfAssimp() {
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(new Stream(first_), Assimp::Logger::Warn | Assimp::Logger::Err);
  }
  ~ComplaintsOfAssimp() { Assimp::DefaultLogger::kill(); }
  ComplaintsOfAssimp(const ComplaintsOfAssimp&) = delete;
  ComplaintsOfAssimp& operator=(const ComplaintsOfAssimp&) = delete;

  const std::string& first() const { return first_; }

 private:
  class Stream : public Assimp::LogStream {
   public:
    explicit Stream(std::string& first) : first_(first) {}
    void write(const char* message) override {
      if (!first_.empty()) return;
      first_ = message;
      while (!first_.empty() && std::isspace(static_cast<unsigned char>(first_.back()))) first_.pop_back();
    }

   private:
    std::string& first_;
  };
  std::string first_;
};

/// The shortest decimal number that rounds to a float.
double shortest_decimal(float x) {
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), x).ptr;
  double value = x;
  std::from_chars(text.data(), end, value);
  return value;
}

void expect_stl(const std::string& path) {
  expect_geodata(path, how_to_make_smaller, most_mesh_bytes);
  std::string ending = std::filesystem::path(path).extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  if (ending != ".stl")
    throw std::runtime_error(fmt::format("{} is no STL by its name; write one that ends with .stl", path));
}

}  // namespace

std::vector<Vec<3>> read_stl(const std::string& path, double metres_per_unit) {
  expect_stl(path);
  const ComplaintsOfAssimp complaints;
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(std::filesystem::absolute(path).string(), 0);
  const std::string why = scene ? complaints.first() : importer.GetErrorString();
  if (!why.empty())
    throw std::runtime_error(
        fmt::format("{} cannot be read as an STL; it is damaged or incomplete ({})", path, printable(why)));
  std::vector<Vec<3>> corners;
  for (unsigned m = 0; scene && m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3)
        throw std::runtime_error(fmt::format("{} has a face of {} corners, number {}, and triangles are read", path,
                                             face.mNumIndices, f + 1));
      for (unsigned k = 0; k < 3; ++k) {
        const aiVector3D& v = mesh.mVertices[face.mIndices[k]];
        const std::array<float, 3> xyz{v.x, v.y, v.z};
        Vec<3> x{};
        for (int a = 0; a < 3; ++a) {
          if (!std::isfinite(xyz[std::size_t(a)]))
            throw std::runtime_error(fmt::format("{} has a coordinate that is no finite number, in triangle {}", path,
                                                 corners.size() / 3 + 1));
          x[a] = metres_per_unit * shortest_decimal(xyz[std::size_t(a)]);
        }
        corners.push_back(x);
      }
    }
  }
  if (corners.empty()) throw std::runtime_error(fmt::format("{} has no triangles", path));
  return corners;
}

}  // namespace talus
