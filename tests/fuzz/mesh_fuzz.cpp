// SPDX-License-Identifier: Apache-2.0
// Fuzzes mesh files of users. For libFuzzer: clang++ -fsanitize=fuzzer,address with the
// sources of common/geometry; here a corpus and its seeded mutations are replayed.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "common/base/errors.hpp"
#include "common/geometry/mesh_check.hpp"

namespace handsel {

/// Returns whether the mesh was read. Aborts on an invalid index or number in the result.
bool read_mesh(const std::string& name, const std::string& content) {
  try {
    const TriangleMesh mesh = mesh::parse(name, content, Vector3::Ones());
    if (mesh.triangles.empty()) std::abort();
    for (const Vector3& vertex : mesh.vertices)
      if (!vertex.allFinite()) std::abort();
    for (const auto& triangle : mesh.triangles)
      for (const int index : triangle)
        if (index < 0 || static_cast<std::size_t>(index) >= mesh.vertices.size()) std::abort();
    return true;
  } catch (const ConfigError& error) {
    const std::string what = error.what();
    if (what.rfind(name, 0) != 0 || what.find('\n') != std::string::npos || what.size() > 400) {
      std::fprintf(stderr, "no sentence: %s\n", what.c_str());
      std::abort();
    }
    return false;
  }
}

}  // namespace handsel

#ifdef HANDSEL_LIBFUZZER
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const char* const kNames[] = {"a.obj", "a.stl", "a.ply", "a.dae"};
  if (size > 0)
    handsel::read_mesh(kNames[data[0] % 4], {reinterpret_cast<const char*>(data) + 1, size - 1});
  return 0;
}
#else
#include "tests/fuzz/replay.hpp"

namespace handsel {
namespace {

TEST(MeshFuzz, no_file_crashes_and_each_refusal_is_one_sentence) {
  fuzz::replay("mesh", read_mesh,
               {"f 1 2 3\n",
                "f -1 2 3",
                "v 0 0 0\n",
                "usemtl a\n",
                "g\n",
                "o\n",
                "facet",
                "vertex 0 0 0\n",
                "endsolid",
                "element vertex 4\n",
                "property list uchar int vertex_index\n",
                "end_header\n",
                "<node>",
                "</node>",
                "<instance_geometry url=\"#g\"/>",
                "count=\"1\"",
                "stride=\"0\"",
                "offset=\"9\"",
                "<polylist>",
                "<vcount>1 2</vcount>",
                "<input semantic=\"NORMAL\" source=\"#s\" offset=\"1\"/>",
                "<instance_node url=\"#n\"/>",
                "<tristrips count=\"1\">",
                "<unit meter=\"0\"/>"},
               60);
}

}  // namespace
}  // namespace handsel
#endif
