// SPDX-License-Identifier: Apache-2.0
#include "common/model/object_model.hpp"

#include <cmath>

#include "common/config/resources.hpp"
#include "common/config/schema/robot.pb.h"
#include "common/model/description/description_parts.hpp"

namespace handsel {
namespace fs = std::filesystem;
namespace {

Shape to_shape(const config::ObjectPart& part, const fs::path& file, const Vector3& scale) {
  const auto positive = [&](double value, const char* key) {
    if (!(value > 0) || !std::isfinite(value))
      throw ConfigError(locate(file, key) + ": " + key + " of a part must be > 0");
    return value;
  };
  switch (part.shape_case()) {
    case config::ObjectPart::kBox:
      return Box{{positive(part.box().x(), "box"), positive(part.box().y(), "box"),
                  positive(part.box().z(), "box")}};
    case config::ObjectPart::kCylinder:
      return Cylinder{positive(part.cylinder().radius(), "cylinder"),
                      positive(part.cylinder().length(), "cylinder")};
    case config::ObjectPart::kCapsule:
      return Capsule{positive(part.capsule().radius(), "capsule"),
                     positive(part.capsule().length(), "capsule")};
    case config::ObjectPart::kSphere:
      return Sphere{positive(part.sphere(), "sphere")};
    case config::ObjectPart::kConvexMesh:
      return std::make_shared<const TriangleMesh>(
          load_mesh(file.parent_path() / part.convex_mesh(), scale));
    case config::ObjectPart::SHAPE_NOT_SET:
      break;
  }
  throw ConfigError(locate(file, "parts") +
                    ": a part needs a shape: box, cylinder, capsule, sphere or convex_mesh");
}

PlacedShape to_placed(const config::ObjectPart& part, const fs::path& file, const Vector3& scale) {
  return {to_shape(part, file, scale), handsel::to_pose(part.pose())};
}

std::vector<PlacedShape> walls(const config::ObjectPart& part, const fs::path& file,
                               const Vector3& scale) {
  std::vector<PlacedShape> out;
  for (const config::ObjectPart& wall : part.walls()) {
    if (wall.walls_size() > 0)
      throw ConfigError(locate(file, "walls") + ": a wall is convex and has no walls of its own");
    out.push_back(to_placed(wall, file, scale));
  }
  return out;
}

}  // namespace

ObjectModel ObjectModel::load(const fs::path& description) {
  config::ObjectDescription text;
  load_text_proto(description, text);
  const auto fail = [&](const char* key, const std::string& what) {
    return ConfigError(locate(description, key) + ": " + what);
  };
  if (text.name().empty()) throw fail("name", "name is missing");
  if (text.mesh().empty()) throw fail("mesh", "mesh is missing");
  if (!(text.mass() > 0) || !std::isfinite(text.mass())) throw fail("mass", "mass must be > 0");
  if (!(text.friction() >= 0) || !std::isfinite(text.friction()))
    throw fail("friction", "friction must be >= 0");

  ObjectModel object;
  object.name = text.name();
  object.mass = text.mass();
  object.com = to_vector(text.com());
  object.max_tilt = text.max_tilt();
  if (text.friction() > 0) object.friction = text.friction();
  const Vector3 scale = text.has_scale() ? to_vector(text.scale()) : Vector3::Ones();
  object.mesh = load_mesh(description.parent_path() / text.mesh(), scale);
  Vector3 low = object.mesh.vertices.front(), high = low;
  for (const auto& v : object.mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  object.height_above_support =
      text.height_above_support() != 0 ? text.height_above_support() : -low.z();
  for (const auto& part : text.parts())
    object.parts.push_back({to_placed(part, description, scale), walls(part, description, scale)});
  if (object.parts.empty())
    object.parts.push_back({{Box{high - low}, make_pose((low + high) / 2)}, {}});
  return object;
}

std::vector<PlacedShape> ObjectModel::solids() const {
  std::vector<PlacedShape> out;
  for (const ObjectPart& part : parts) {
    if (part.walls.empty()) out.push_back(part);
    out.insert(out.end(), part.walls.begin(), part.walls.end());
  }
  return out;
}

}  // namespace handsel
