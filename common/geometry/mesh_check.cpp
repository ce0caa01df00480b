// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/mesh_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "common/geometry/mesh_text.hpp"

namespace handsel::mesh {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw ConfigError(file.string() + ": " + what);
}

/// Counts the triangles of the faces read so far; throws if there are too many.
class TriangleCount {
 public:
  explicit TriangleCount(const fs::path& file) : file_(file) {}
  void add(std::size_t corners) {
    count_ += corners > 2 ? corners - 2 : 0;
    if (count_ > kMaxTriangles) fail(file_, "more than 500000 triangles, the maximum of a mesh");
  }

 private:
  const fs::path& file_;
  std::size_t count_{0};
};

/// Checks the vertex index of an OBJ face: "7", "7/1", "7//3" or "-1/..".
void check_obj_index(const Lines& lines, std::string_view word, long long before, long long all) {
  const auto index = whole_of(word.substr(0, word.find('/')));
  if (!index) lines.fail("a face has " + shown(word) + " where the number of a vertex should be");
  if (*index == 0 || *index > all || *index < -before)
    lines.fail("a face has vertex " + std::to_string(*index) + ", out of range: the file has " +
               std::to_string(all) + " vertices, counted from 1");
}

constexpr std::size_t kStlHead = 84, kStlTriangle = 50;  // [bytes]

std::uint32_t stl_count(const std::string& content) {
  std::uint32_t count = 0;
  if (content.size() >= kStlHead) std::memcpy(&count, content.data() + 80, sizeof count);
  return count;
}

void check_binary_stl(const fs::path& file, const std::string& content, std::uint32_t count) {
  if (count > kMaxTriangles) fail(file, "more than 500000 triangles, the maximum of a mesh");
  for (std::uint32_t t = 0; t < count; ++t) {
    float corners[9];
    std::memcpy(corners, content.data() + kStlHead + t * kStlTriangle + 12, sizeof corners);
    for (const float value : corners)
      if (!std::isfinite(value) || std::abs(value) > kLargestCoordinate)
        fail(file, "triangle " + std::to_string(t + 1) +
                       " has a vertex that is not finite or beyond 1e9");
  }
}

void check_text_stl(const fs::path& file, const std::string& content) {
  Lines lines(file, content);
  TriangleCount triangles(file);
  std::size_t corners = 0;
  bool in_solid = false;
  while (lines.next()) {
    const std::string_view word = lines.word();
    if (word.empty()) continue;
    if (word == "solid") {
      in_solid = true;
    } else if (word == "vertex") {
      for (const char* axis : {"x of a vertex", "y of a vertex", "z of a vertex"})
        lines.coordinate(axis);
      ++corners;
    } else if (word == "facet") {
      corners = 0;
    } else if (word == "endfacet") {
      if (corners != 3)
        lines.fail("a facet has " + std::to_string(corners) + " vertices, must have 3");
      triangles.add(corners);
    } else if (word == "endsolid") {
      in_solid = false;
    } else if (word != "outer" && word != "endloop") {
      lines.fail(shown(word) + " is no word of an STL in text");
    }
  }
  if (in_solid) lines.fail("the file ends before endsolid");
}

}  // namespace

std::string checked_obj(const fs::path& file, std::string content) {
  long long all = 0;
  for (Lines lines(file, content); lines.next();) {
    const std::string_view word = lines.word();
    all += word == "v" ? 1 : 0;
    if (word == "mtllib") content[static_cast<std::size_t>(word.data() - content.data())] = '#';
  }
  if (all > static_cast<long long>(kMaxVertices))
    fail(file, "more than 1500000 vertices, the maximum of a mesh");
  long long before = 0;
  TriangleCount triangles(file);
  for (Lines lines(file, content); lines.next();) {
    if (lines.is_continued())
      lines.fail("a line that continues in the next one (\\); it must be one line");
    const std::string_view kind = lines.word();
    if (kind == "v") {
      ++before;
      for (const char* axis : {"x of a vertex", "y of a vertex", "z of a vertex"})
        lines.coordinate(axis);
    } else if (kind == "f" || kind == "l" || kind == "p") {
      std::size_t corners = 0;
      for (std::string_view word = lines.word(); !word.empty() && word[0] != '#';
           word = lines.word()) {
        check_obj_index(lines, word, before, all);
        if (++corners > kMaxFaceVertices) lines.fail("a face has more than 1000 vertices");
      }
      triangles.add(corners);
    }
  }
  return content;
}

void check_stl(const fs::path& file, const std::string& content) {
  const std::uint32_t count = stl_count(content);
  if (content.size() >= kStlHead &&
      content.size() == kStlHead + count * static_cast<std::uint64_t>(kStlTriangle))
    return check_binary_stl(file, content, count);
  const std::size_t begin = content.find_first_not_of(" \t\r\n");
  if (begin != std::string::npos && content.compare(begin, 5, "solid") == 0 &&
      content.find('\0') == std::string::npos)
    return check_text_stl(file, content);
  if (content.size() < kStlHead)
    fail(file, "is no STL: neither text that begins with solid nor a binary head of 84 bytes");
  fail(file, "is no STL: its head announces " + std::to_string(count) +
                 " triangles, for which it must have " +
                 std::to_string(kStlHead + count * static_cast<std::uint64_t>(kStlTriangle)) +
                 " bytes; it has " + std::to_string(content.size()));
}

std::string checked(const fs::path& file, std::string content) {
  std::string kind = file.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (content.empty()) fail(file, "is empty");
  if (kind == ".dae") return checked_dae(file, content);
  if (kind == ".obj") return checked_obj(file, std::move(content));
  if (kind == ".stl") {
    check_stl(file, content);
  } else if (kind == ".ply") {
    check_ply(file, content);
  } else {
    fail(file, "not a mesh that can be read: its name must end in .obj, .stl, .ply or .dae");
  }
  return content;
}

}  // namespace handsel::mesh
