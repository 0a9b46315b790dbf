#include "task/mesh_file.h"

#include <sstream>

#include "core/error.h"
#include "recording/text/bounds.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

/// A corner of a face: "7", "7/1" or "7/1/3", counted from 1, or backwards from -1.
int CornerOf(const std::string& word, std::size_t points) {
  std::size_t used = 0;
  long index = 0;
  try {
    index = std::stol(word, &used);
  } catch (const std::exception&) {
    throw InputError(fmt::format("found '{}', expected the number of a vertex", word));
  }
  const long count = static_cast<long>(points);
  if (index < 0) index += count + 1;
  if ((used < word.size() && word[used] != '/') || index < 1 || index > count) {
    throw InputError(
        fmt::format("found '{}', expected one of the {} vertices before it", word, count));
  }
  return static_cast<int>(index - 1);
}

void AddVertex(std::istream& line, TriangleMesh& mesh) {
  Eigen::Vector3d p;
  if (!(line >> p[0] >> p[1] >> p[2])) throw InputError("expected three numbers after v");
  for (const double value : p) {
    const std::string within = ExpectedWithin(BoundsOf("v_m"), value);
    if (!within.empty()) throw InputError(fmt::format("found {}, expected {}", value, within));
  }
  mesh.points.push_back(p);
}

void AddFace(std::istream& line, TriangleMesh& mesh) {
  std::vector<int> corners;
  for (std::string word; line >> word;) corners.push_back(CornerOf(word, mesh.points.size()));
  if (corners.size() < 3) throw InputError("a face needs three corners or more");
  for (std::size_t i = 2; i < corners.size(); ++i)
    mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

}  // namespace

TriangleMesh ReadMesh(const std::filesystem::path& file) {
  TriangleMesh mesh;
  std::istringstream text(ReadTextFile(file));
  long number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    try {
      if (kind == "v") AddVertex(words, mesh);
      if (kind == "f") AddFace(words, mesh);
    } catch (const InputError& error) {
      throw InputError::At(file.string(), number, error.what());
    }
  }
  return mesh;
}

}  // namespace flextip
