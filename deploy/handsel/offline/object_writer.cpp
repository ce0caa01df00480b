// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/offline/object_writer.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "common/base/errors.hpp"

namespace handsel {
namespace fs = std::filesystem;
namespace {

void write_bytes(const fs::path& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  out << bytes;
  if (!out.flush())
    throw ConfigError("cannot write " + file.string() + "; --out names another place");
}

/// Returns a binary STL.
std::string stl_of(const TriangleMesh& mesh) {
  std::string out(80, ' ');
  const auto add = [&](const auto& value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.append(bytes, sizeof value);
  };
  add(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const auto at = [&](std::size_t k) -> const Vector3& {
      return mesh.vertices[static_cast<std::size_t>(t[k])];
    };
    const Vector3 normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (const Vector3& v : {normal, at(0), at(1), at(2)})
      for (int axis = 0; axis < 3; ++axis) add(static_cast<float>(v[axis]));
    add(std::uint16_t{0});
  }
  return out;
}

std::string digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", std::abs(value) < 1e-9 ? 0.0 : value);
  return text;
}

std::string xyz_text(const Vector3& v) {
  return "x: " + digits(v.x()) + " y: " + digits(v.y()) + " z: " + digits(v.z());
}

/// Returns roll, pitch and yaw of a rotation [rad].
Vector3 rpy_of(const Eigen::Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
          std::atan2(R(1, 0), R(0, 0))};
}

bool is_drawn(const fs::path& mesh) {
  std::string kind = mesh.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return kind == ".stl" || kind == ".obj";
}

class Writer {
 public:
  Writer(const MadeObject& made, const ObjectFiles& files)
      : made_(made), files_(files), folder_(files.description.parent_path()) {}

  std::vector<fs::path> write() {
    std::error_code error;
    if (!files_.replace && fs::exists(files_.description, error))
      throw ConfigError(files_.description.string() +
                        " is there already; --replace writes the file anew, --name another one");
    written_ = {files_.description};
    std::string text = head() + mesh_lines();
    for (const ObjectPart& part : made_.model.parts) text += part_line(part, "");
    text += "mass: " + digits(made_.model.mass) + "\nfriction: " + digits(made_.model.friction) +
            "\ncom { " + xyz_text(made_.model.com) + " }\n";
    if (made_.model.max_tilt > 0)
      text += "max_tilt: " + digits(made_.model.max_tilt) + "  # carried upright\n";
    write_bytes(files_.description, text);
    return written_;
  }

 private:
  std::string head() const {
    std::string text = "# " + files_.name + ", made of " + files_.mesh.filename().string() +
                       " by `handsel object new`; edit as you like.\n";
    for (const std::string& note : made_.notes) text += "# " + note + "\n";
    text += "# inertia about the mass centre " + digits(made_.inertia.x()) + " " +
            digits(made_.inertia.y()) + " " + digits(made_.inertia.z()) +
            " kg m^2; volume of the solid " + digits(1e3 * made_.volume) + " l\n";
    if (made_.cavity > 0)
      text += "# a container of " + digits(1e3 * made_.cavity) + " l, open with z up\n";
    return text + "name: \"" + files_.name + "\"\n";
  }

  std::string mesh_lines() {
    if (made_.moved || !is_drawn(files_.mesh))
      return "mesh: \"" + parts_file("mesh", made_.model.mesh) + "\"\n";
    std::error_code error;
    fs::path mesh = fs::relative(files_.mesh, folder_.empty() ? fs::path(".") : folder_, error);
    if (error || mesh.empty()) mesh = fs::absolute(files_.mesh);
    std::string text = "mesh: \"" + mesh.string() + "\"\n";
    if (made_.scale != 1) text += "scale { " + xyz_text(Vector3::Constant(made_.scale)) + " }\n";
    return text;
  }

  /// Writes a mesh into the folder of the parts, in metres; returns its name in the description.
  std::string parts_file(const std::string& stem, const TriangleMesh& mesh) {
    const std::string folder = files_.name + "_parts";
    std::error_code error;
    fs::create_directories(folder_ / folder, error);
    const fs::path file = folder_ / folder / (stem + ".stl");
    write_bytes(file, stl_of(mesh));
    written_.push_back(file);
    return folder + "/" + file.filename().string();
  }

  std::string shape_text(const PlacedShape& placed) {
    std::string text;
    const Vector3 rpy = rpy_of(placed.T_parent_shape.linear());
    if (!placed.T_parent_shape.isApprox(Pose::Identity()))
      text = "pose { xyz { " + xyz_text(placed.T_parent_shape.translation()) + " }" +
             (rpy.norm() > 1e-9 ? " rpy { " + xyz_text(rpy) + " }" : "") + " } ";
    if (const auto* box = std::get_if<Box>(&placed.shape))
      return text + "box { " + xyz_text(box->size) + " }";
    if (const auto* cylinder = std::get_if<Cylinder>(&placed.shape))
      return text + "cylinder { radius: " + digits(cylinder->radius) +
             " length: " + digits(cylinder->length) + " }";
    // The loader scales parts by `scale`, as it does the mesh.
    TriangleMesh hull = *std::get<MeshPtr>(placed.shape);
    const bool scaled = !made_.moved && is_drawn(files_.mesh);
    for (Vector3& v : hull.vertices) v /= scaled ? made_.scale : 1;
    return text + "convex_mesh: \"" + parts_file("part_" + std::to_string(++parts_), hull) + "\"";
  }

  std::string part_line(const ObjectPart& part, const std::string& indent) {
    std::string text = indent + "parts { " + shape_text(part);
    if (part.walls.empty()) return text + " }\n";
    text += "\n";
    for (const PlacedShape& wall : part.walls)
      text += indent + "  walls { " + shape_text(wall) + " }\n";
    return text + indent + "}\n";
  }

  const MadeObject& made_;
  const ObjectFiles& files_;
  fs::path folder_;
  std::vector<fs::path> written_;
  int parts_{0};
};

}  // namespace

std::string object_name(const fs::path& file) {
  std::string name = file.stem().string();
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
  return name;
}

std::vector<fs::path> write_object(const MadeObject& made, const ObjectFiles& files) {
  return Writer(made, files).write();
}

}  // namespace handsel
