// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/drawing.hpp"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include "common/model/human/human_body.hpp"
#include "common/model/object_extent.hpp"
#include "components/bridge/drawing.pb.h"

namespace handsel::bridge {
namespace {

struct Shade {
  double r, g, b, a;
};
constexpr Shade kRobot{0.92, 0.55, 0.16, 1}, kPerson{0.35, 0.55, 0.85, 0.9},
    kLost{0.35, 0.55, 0.85, 0.35}, kObject{0.85, 0.3, 0.3, 1}, kUnknown{0.8, 0.5, 0.75, 1},
    kMislaid{0.85, 0.3, 0.3, 0.35}, kFurniture{0.6, 0.58, 0.54, 1};
constexpr int kFades = 1;            // time until an entity vanishes without an update [s]
constexpr double kSurePlace = 0.02;  // max uncertainty of an object drawn solid, not pale [m]

void set(const Vector3& from, foxglove::Vector3& to) {
  to.set_x(from.x());
  to.set_y(from.y());
  to.set_z(from.z());
}

void set(const Eigen::Quaterniond& from, foxglove::Quaternion& to) {
  to.set_x(from.x());
  to.set_y(from.y());
  to.set_z(from.z());
  to.set_w(from.w());
}

void set(const Pose& from, foxglove::Pose& to) {
  set(Vector3(from.translation()), *to.mutable_position());
  set(Eigen::Quaterniond(from.linear()), *to.mutable_orientation());
}

void set(Stamp from, google::protobuf::Timestamp& to) {
  to.set_seconds(from / 1'000'000'000);
  to.set_nanos(static_cast<std::int32_t>(from % 1'000'000'000));
}

template <class Primitive>
void put(Primitive& to, const Pose& pose, const Vector3& size, const Shade& shade) {
  set(pose, *to.mutable_pose());
  set(size, *to.mutable_size());
  foxglove::Color& color = *to.mutable_color();
  color.set_r(shade.r);
  color.set_g(shade.g);
  color.set_b(shade.b);
  color.set_a(shade.a);
}

void add_cylinder(foxglove::SceneEntity& entity, const Pose& pose, double radius, double length,
                  const Shade& shade) {
  auto& cylinder = *entity.add_cylinders();
  put(cylinder, pose, {2 * radius, 2 * radius, length}, shade);
  cylinder.set_bottom_scale(1);
  cylinder.set_top_scale(1);
}

void add_sphere(foxglove::SceneEntity& entity, const Pose& pose, double radius,
                const Shade& shade) {
  put(*entity.add_spheres(), pose, Vector3::Constant(2 * radius), shade);
}

void add_capsule(foxglove::SceneEntity& entity, const Pose& pose, double radius, double length,
                 const Shade& shade) {
  add_cylinder(entity, pose, radius, length, shade);
  for (const double end : {-length / 2, length / 2}) {
    Pose T = pose;
    T.translation() += pose.linear() * Vector3(0, 0, end);
    add_sphere(entity, T, radius, shade);
  }
}

void add_shape(foxglove::SceneEntity& entity, const Pose& pose, const Shape& shape,
               const Shade& shade) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    add_sphere(entity, pose, sphere->radius, shade);
  } else if (const auto* box = std::get_if<Box>(&shape)) {
    put(*entity.add_cubes(), pose, box->size, shade);
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    add_cylinder(entity, pose, cylinder->radius, cylinder->length, shade);
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    add_capsule(entity, pose, capsule->radius, capsule->length, shade);
  } else if (const MeshPtr& mesh = std::get<MeshPtr>(shape); mesh && !mesh->vertices.empty()) {
    Eigen::AlignedBox3d bounds;  // box around the mesh, which itself comes with the URDF
    for (const Vector3& vertex : mesh->vertices) bounds.extend(vertex);
    Pose T = pose;
    T.translation() += pose.linear() * bounds.center();
    put(*entity.add_cubes(), T, bounds.sizes(), shade);
  }
}

/// Returns a frame centred between a and b, with its z axis from a to b.
Pose between(const Vector3& a, const Vector3& b) {
  Pose T = Pose::Identity();
  T.translation() = (a + b) / 2;
  if ((b - a).norm() > 1e-9)
    T.linear() = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), b - a).toRotationMatrix();
  return T;
}

foxglove::SceneEntity& add_entity(foxglove::SceneUpdate& update, Stamp now, const std::string& id,
                                  const std::string& frame) {
  foxglove::SceneEntity& entity = *update.add_entities();
  set(now, *entity.mutable_timestamp());
  entity.set_id(id);
  entity.set_frame_id(frame);
  entity.set_frame_locked(true);
  entity.mutable_lifetime()->set_seconds(kFades);
  return entity;
}

std::string base64(const std::string& bytes) {
  constexpr const char* kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k > bytes.size() ? '=' : kLetters[group >> (18 - 6 * k) & 63u];
  }
  return out;
}

void add_files(const google::protobuf::FileDescriptor* file,
               google::protobuf::FileDescriptorSet& set) {
  for (const auto& known : set.file())
    if (known.name() == file->name()) return;
  for (int i = 0; i < file->dependency_count(); ++i) add_files(file->dependency(i), set);
  file->CopyTo(set.add_file());
}

}  // namespace

Drawing::Drawing(std::shared_ptr<const RobotModel> robot, Objects objects)
    : robot_(std::move(robot)), objects_(std::move(objects)) {}

std::vector<Channel> Drawing::channels() {
  google::protobuf::FileDescriptorSet files;
  add_files(foxglove::SceneUpdate::descriptor()->file(), files);
  const std::string schema = base64(files.SerializeAsString());
  std::vector<Channel> out(2);
  out[0].topic = "view/transforms";
  out[0].schema_name = "foxglove.FrameTransforms";
  out[1].topic = "view/scene";
  out[1].schema_name = "foxglove.SceneUpdate";
  for (Channel& channel : out) {
    channel.encoding = channel.schema_encoding = "protobuf";
    channel.schema = schema;
  }
  return out;
}

bool Drawing::robot_known() const {
  return state_.position.size() == static_cast<Eigen::Index>(robot_->axes().size()) &&
         state_.position.allFinite();
}

std::string Drawing::transforms(Stamp now) const {
  foxglove::FrameTransforms out;
  if (!robot_known()) return {};
  std::vector<Pose> T_root_link;
  robot_->forward(state_.position, T_root_link);
  const auto add = [&](const std::string& parent, const std::string& child, const Pose& T) {
    foxglove::FrameTransform& transform = *out.add_transforms();
    set(now, *transform.mutable_timestamp());
    transform.set_parent_frame_id(parent);
    transform.set_child_frame_id(child);
    set(Vector3(T.translation()), *transform.mutable_translation());
    set(Eigen::Quaterniond(T.linear()), *transform.mutable_rotation());
  };
  for (std::size_t i = 0; i < robot_->links().size(); ++i) {
    const Link& link = robot_->links()[i];
    if (link.parent_joint < 0) {
      add("world", link.name, state_.T_world_base);
    } else {
      const auto parent = static_cast<std::size_t>(
          robot_->joints()[static_cast<std::size_t>(link.parent_joint)].parent);
      add(robot_->links()[parent].name, link.name, T_root_link[parent].inverse() * T_root_link[i]);
    }
  }
  return out.SerializeAsString();
}

std::string Drawing::scene(Stamp now) const {
  foxglove::SceneUpdate out;
  if (robot_known()) {
    for (const Link& link : robot_->links()) {
      if (link.collision.empty()) continue;
      foxglove::SceneEntity& entity = add_entity(out, now, "robot/" + link.name, link.name);
      for (const PlacedShape& part : link.collision)
        add_shape(entity, part.T_parent_shape, part.shape, kRobot);
    }
  }
  for (const Person& person : people_.people) {
    foxglove::SceneEntity& entity = add_entity(out, now, "person/" + person.id, "world");
    for (const BodyCapsule& part : body_capsules(person))
      add_capsule(entity, between(part.a, part.b), part.radius, (part.b - part.a).norm(),
                  person.inflation > 0 ? kLost : kPerson);
  }
  for (const OtherRobot& robot : people_.robots) {
    foxglove::SceneEntity& entity = add_entity(out, now, "other_robot/" + robot.name, "world");
    for (const MovingPart& part : robot.parts)
      add_capsule(entity, between(part.a, part.b), part.radius, (part.b - part.a).norm(), kRobot);
  }
  for (const SceneObject& object : scene_.objects) {
    const ObjectModel* model = objects_(object.model);
    const std::optional<Shape> unknown = primitive_shape(object.primitive);
    if (!model && !unknown) continue;
    foxglove::SceneEntity& entity = add_entity(out, now, "object/" + object.id, "world");
    const Shade& shade = object.uncertainty > kSurePlace ? kMislaid : model ? kObject : kUnknown;
    if (!model) add_shape(entity, object.T_world_object, *unknown, shade);
    if (model)
      for (const PlacedShape& part : model->parts)
        add_shape(entity, object.T_world_object * part.T_parent_shape, part.shape, shade);
  }
  for (const SceneBox& box : scene_.boxes)
    put(*add_entity(out, now, "furniture/" + box.id, "world").add_cubes(), box.T_world_box,
        box.size, kFurniture);
  return out.SerializeAsString();
}

}  // namespace handsel::bridge
