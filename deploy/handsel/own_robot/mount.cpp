// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/mount.hpp"

#include <stdexcept>

#include "common/config/text_file.hpp"
#include "common/model/description/mesh_file.hpp"
#include "common/model/description/xml_file.hpp"
#include "deploy/handsel/own_robot/gripper_pads.hpp"

namespace handsel {
namespace {

namespace fs = std::filesystem;

/// Meshes that are only drawn may be missing: their names stay as they are.
void make_meshes_absolute(tinyxml2::XMLElement& e, const fs::path& urdf) {
  if (std::string(e.Name()) == "mesh" && e.Attribute("filename") != nullptr) try {
      e.SetAttribute("filename", find_mesh(urdf, e.Attribute("filename"), {}).c_str());
    } catch (const MissingError&) {
    }
  for (auto* child = e.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
    make_meshes_absolute(*child, urdf);
}

}  // namespace

Pose mount_pose(const RobotModel& robot, const RobotParts& parts) {
  constexpr double kBeside = 0.04;  // of shapes that count, from the axis [m]
  constexpr double kMinOffset = 1e-3;
  std::vector<Pose> T;
  robot.forward(robot.rest_configuration(), T);
  const auto joint_of = [&](const std::string& name) -> const Joint& {
    for (const Joint& joint : robot.joints())
      if (joint.name == name) return joint;
    throw std::logic_error("no joint " + name);
  };
  const Joint &last = joint_of(parts.arm.back()),
              &before = joint_of(parts.arm[parts.arm.size() - 2]);
  const Pose T_flange = T[static_cast<std::size_t>(parts.flange)];
  const auto place = [&](const Joint& joint) { return T[static_cast<std::size_t>(joint.child)]; };
  Vector3 outward = T_flange.linear().transpose() * place(last).linear() * last.axis;
  const auto below = descends_from(robot, last.child);
  double end = 0, sum = 0;
  const auto measure = [&] {
    end = sum = 0;
    for (std::size_t l = 0; l < below.size(); ++l) {
      if (!below[l]) continue;
      for (const PlacedShape& placed : robot.links()[l].collision)
        for (const Vector3& corner : corners_of(placed.shape)) {
          const Vector3 p = T_flange.inverse() * T[l] * placed.T_parent_shape * corner;
          sum += p.dot(outward);
          if (outward.cross(p).norm() < kBeside) end = std::max(end, p.dot(outward));
        }
    }
  };
  const double along =
      outward.dot(-(T_flange.inverse() * place(before).translation()));  // from the wrist
  measure();
  if (along < -kMinOffset || (std::abs(along) <= kMinOffset && sum < 0)) {
    outward = -outward;
    measure();
  }
  return make_pose(end * outward, Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), outward));
}

void write_hand_urdf(const fs::path& urdf, const RobotModel& robot, const RobotParts& parts,
                     const fs::path& to) {
  tinyxml2::XMLDocument from, out;
  parse_xml(from, urdf, read_text_file(urdf));
  const auto below = descends_from(robot, parts.flange);
  const auto wanted = [&](const char* link) {
    const int index = link != nullptr ? robot.link_index(link) : -1;
    return index >= 0 && below[static_cast<std::size_t>(index)];
  };
  out.InsertEndChild(out.NewDeclaration());
  out.InsertEndChild(out.NewComment(
      (" The hand of " + urdf.filename().string() + ", written by `handsel model new` ").c_str()));
  auto* top = out.NewElement("robot");
  top->SetAttribute("name", to.stem().c_str());
  out.InsertEndChild(top);
  for (auto* e = from.FirstChildElement("robot")->FirstChildElement(); e != nullptr;
       e = e->NextSiblingElement()) {
    const std::string tag = e->Name();
    const auto* parent = e->FirstChildElement("parent");
    if (tag == "material" || (tag == "link" && wanted(e->Attribute("name"))) ||
        (tag == "joint" && parent != nullptr && wanted(parent->Attribute("link")))) {
      auto* copy = e->DeepClone(&out)->ToElement();
      make_meshes_absolute(*copy, urdf);
      top->InsertEndChild(copy);
    }
  }
  if (out.SaveFile(to.c_str()) != tinyxml2::XML_SUCCESS)
    throw ConfigError("cannot write " + to.string() + "; --out names another folder");
}

}  // namespace handsel
