// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/urdf_correction.hpp"

#include <tinyxml2.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdio>
#include <map>
#include <sstream>

#include "common/base/errors.hpp"
#include "common/config/text_file.hpp"
#include "common/model/description/mesh_file.hpp"
#include "common/model/description/xml_file.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel {
namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

constexpr double kMillimetre = 1e-3;

std::string attribute_of(const XMLElement* e, const char* key) {
  const char* value = e != nullptr ? e->Attribute(key) : nullptr;
  return value != nullptr ? value : "";
}

/// Returns the numbers of an attribute, or `otherwise` when there are not three.
Vector3 three(const XMLElement* e, const char* key, const Vector3& otherwise) {
  std::istringstream words(attribute_of(e, key));
  Vector3 v;
  return words >> v.x() >> v.y() >> v.z() ? v : otherwise;
}

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string text_of(const Vector3& v) {
  return text_of(v.x()) + " " + text_of(v.y()) + " " + text_of(v.z());
}

XMLElement* child_of(XMLElement& parent, const char* name) {
  if (XMLElement* found = parent.FirstChildElement(name)) return found;
  return parent.InsertNewChildElement(name);
}

/// Returns "a, b and 3 more".
std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 4;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kShown; ++i) text += (i ? ", " : "") + names[i];
  if (names.size() > kShown) text += " and " + std::to_string(names.size() - kShown) + " more";
  return text;
}

class Corrector {
 public:
  explicit Corrector(const UrdfSource& source) : source_(source) {
    const std::string text = read_text_file(source.file);
    refuse_xacro(text);
    parse_xml(xml_, source.file, text);
    RobotModel::load_urdf(source.file, {}, Meshes::skip);  // refuses broken trees and numbers
    robot_ = xml_.FirstChildElement("robot");
  }

  CorrectedUrdf correct() {
    check_joints();
    complete_shapes();
    correct_meshes();
    if (changed_) save();
    complete_masses();
    if (changed_) save();
    return {changed_ ? source_.copy : source_.file, notes_};
  }

 private:
  struct MeshUse {
    XMLElement* element;
    fs::path file;
    Vector3 scale;
    double extent;  // longest side, scaled [m]
  };

  template <class Visit>
  void each(const char* tag, const Visit& visit) {
    for (auto* e = robot_->FirstChildElement(tag); e != nullptr; e = e->NextSiblingElement(tag))
      visit(*e);
  }

  std::string at(const XMLElement& e) const {
    return source_.file.string() + ":" + std::to_string(e.GetLineNum()) + ": ";
  }

  void refuse_xacro(const std::string& text) const {
    for (const char* sign : {"<xacro:", "${", "$(arg", "$(find"}) {
      const auto found = text.find(sign);
      if (found == std::string::npos) continue;
      const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(found), '\n');
      throw ConfigError(source_.file.string() + ":" + std::to_string(line) + ": has \"" + sign +
                        "\", a command of xacro; expand the file with `xacro " +
                        source_.file.string() + " > robot.urdf` and name robot.urdf");
    }
  }

  void check_joints() {
    const UrdfAssumptions& assumed = source_.assumed;
    each("joint", [&](XMLElement& joint) {
      const std::string name = attribute_of(&joint, "name"), type = attribute_of(&joint, "type");
      const double offset =
          three(joint.FirstChildElement("origin"), "xyz", Vector3::Zero()).cwiseAbs().maxCoeff();
      if (offset > assumed.max_origin)
        throw ConfigError(at(joint) + "joint " + name + " is " + text_of(offset) +
                          " m from its parent, which looks like millimetres; a URDF is in metres: "
                          "divide all lengths by 1000");
      if (type == "fixed" || type == "floating" || type == "planar") return;
      XMLElement* limit = joint.FirstChildElement("limit");
      if (type == "revolute" && limit != nullptr) check_range(joint, *limit, name);
      if (joint.FirstChildElement("mimic") != nullptr) return;
      limit = child_of(joint, "limit");
      const bool slides = type == "prismatic";
      assume(*limit, "velocity", slides ? assumed.sliding_speed : assumed.turning_speed,
             no_velocity_, name);
      assume(*limit, "effort", assumed.effort, no_effort_, name);
    });
    note(no_velocity_, "no velocity limit",
         "assumed " + text_of(assumed.turning_speed) + " rad/s or " +
             text_of(assumed.sliding_speed) + " m/s");
    note(no_effort_, "no effort limit", "assumed " + text_of(assumed.effort) + " Nm or N");
  }

  void check_range(XMLElement& joint, XMLElement& limit, const std::string& name) {
    const double lower = limit.DoubleAttribute("lower"), upper = limit.DoubleAttribute("upper");
    const double max = std::max(std::abs(lower), std::abs(upper));
    if (max <= source_.assumed.max_angle) return;
    if (max < source_.assumed.unlimited)
      throw ConfigError(at(limit) + "joint " + name + " has limits of " + text_of(lower) + " and " +
                        text_of(upper) +
                        " rad, which look like degrees; a URDF is in radians: multiply by pi/180");
    joint.SetAttribute("type", "continuous");
    changed_ = true;
    notes_.push_back("joint " + name + " has limits beyond " + text_of(source_.assumed.unlimited) +
                     " rad: taken as continuous");
  }

  void assume(XMLElement& limit, const char* key, double value, std::vector<std::string>& names,
              const std::string& joint) {
    if (limit.DoubleAttribute(key) > 0) return;
    limit.SetAttribute(key, text_of(value).c_str());
    names.push_back(joint);
    changed_ = true;
  }

  void note(const std::vector<std::string>& names, const std::string& lack,
            const std::string& cure) {
    if (names.empty()) return;
    notes_.push_back(
        (names.size() == 1 ? "joint " + names[0] + " has " : "joints " + listed(names) + " have ") +
        lack + ": " + cure);
  }

  /// Links that are only drawn collide with what is drawn.
  void complete_shapes() {
    std::vector<std::string> drawn;
    each("link", [&](XMLElement& link) {
      if (link.FirstChildElement("collision") != nullptr) return;
      bool any = false;
      for (auto* v = link.FirstChildElement("visual"); v != nullptr;
           v = v->NextSiblingElement("visual")) {
        const auto* geometry = v->FirstChildElement("geometry");
        if (geometry == nullptr) continue;
        XMLElement* collision = link.InsertNewChildElement("collision");
        if (const auto* origin = v->FirstChildElement("origin"))
          collision->InsertEndChild(origin->DeepClone(&xml_));
        collision->InsertEndChild(geometry->DeepClone(&xml_));
        any = true;
      }
      if (any) drawn.push_back(attribute_of(&link, "name"));
    });
    if (drawn.empty()) return;
    changed_ = true;
    notes_.push_back("no collision shape in links " + listed(drawn) +
                     ": the visual shapes are used");
  }

  /// Finds the meshes, notices millimetres, and names meshes by paths that hold from the copy.
  void correct_meshes() {
    std::vector<MeshUse> uses;
    each("link", [&](XMLElement& link) {
      for (auto* c = link.FirstChildElement("collision"); c != nullptr;
           c = c->NextSiblingElement("collision"))
        if (auto* geometry = c->FirstChildElement("geometry"))
          if (auto* mesh = geometry->FirstChildElement("mesh")) uses.push_back(measured(*mesh));
    });
    std::vector<Vector3> scales;  // of meshes in millimetres
    for (const MeshUse& use : uses)
      if (use.extent > source_.assumed.max_mesh) scales.push_back(use.scale);
    std::vector<std::string> millimetres;
    for (const MeshUse& use : uses) {
      if (std::find(scales.begin(), scales.end(), use.scale) == scales.end()) continue;
      if (use.extent * kMillimetre > source_.assumed.max_mesh)
        throw ConfigError(use.file.string() + ": the longest side is " + text_of(use.extent) +
                          " units, neither metres nor millimetres of a robot; scale the mesh");
      use.element->SetAttribute("scale", text_of(Vector3(kMillimetre * use.scale)).c_str());
      const std::string file = use.file.filename().string();
      if (std::find(millimetres.begin(), millimetres.end(), file) == millimetres.end())
        millimetres.push_back(file);
    }
    if (!millimetres.empty()) {
      changed_ = true;
      notes_.push_back("meshes in millimetres: " + listed(millimetres) + "; scaled by 0.001");
    }
    for (const MeshUse& use : uses)
      if (changed_ || !source_.packages.empty())
        use.element->SetAttribute("filename", fs::absolute(use.file).c_str());
    changed_ = changed_ || (!source_.packages.empty() && !uses.empty());
  }

  MeshUse measured(XMLElement& element) {
    MeshUse use{&element,
                find_mesh(source_.file, attribute_of(&element, "filename"), source_.packages),
                three(&element, "scale", Vector3::Ones()), 0};
    const auto known = extents_.find(use.file.string());
    const double longest =
        known != extents_.end()
            ? known->second
            : extents_.emplace(use.file.string(), longest_side(use)).first->second;
    use.extent = longest * use.scale.cwiseAbs().maxCoeff();
    return use;
  }

  /// Returns the longest side in units of the file: the reader refuses meshes above 100 m.
  static double longest_side(const MeshUse& use) {
    const auto side = [&](double scale) {
      const TriangleMesh mesh = load_mesh(use.file, Vector3::Constant(scale));
      Eigen::AlignedBox3d box;
      for (const Vector3& v : mesh.vertices) box.extend(v);
      return box.sizes().maxCoeff() / scale;
    };
    try {
      return side(1);
    } catch (const ConfigError&) {
      return side(kMillimetre);
    }
  }

  /// Gives a mass to links that have shapes or move something and have none.
  void complete_masses() {
    const RobotModel robot =
        RobotModel::load_urdf(changed_ ? source_.copy : source_.file, {}, Meshes::load);
    refuse_y_up(robot);
    const auto capsules = robot_capsules(robot);
    std::vector<double> carried(robot.links().size());
    std::vector<std::string> massless, impossible;
    for (std::size_t l = robot.links().size(); l-- > 0;) {
      const Link& link = robot.links()[l];
      const bool needs = moves(robot, link) && carried[l] == 0;
      if (link.mass == 0 && link.parent_joint >= 0 && (needs || !link.collision.empty())) {
        carried[l] += assume_mass(link, capsules, static_cast<int>(l), 0);
        massless.push_back(link.name);
      } else if (link.mass > 0 && !possible(link.inertia)) {
        assume_mass(link, capsules, static_cast<int>(l), link.mass);
        impossible.push_back(link.name);
      }
      carried[l] += link.mass;
      if (link.parent_joint < 0) continue;
      const Joint& joint = robot.joints()[static_cast<std::size_t>(link.parent_joint)];
      if (joint.kind == JointKind::fixed)
        carried[static_cast<std::size_t>(joint.parent)] += carried[l];
    }
    if (!massless.empty())
      notes_.push_back("no mass in links " + listed(massless) + ": assumed " +
                       text_of(source_.assumed.density) + " kg/m^3 in the capsules around them");
    if (!impossible.empty())
      notes_.push_back("inertias that no body can have, in links " + listed(impossible) +
                       ": replaced by those of the capsules around them");
    changed_ = changed_ || !massless.empty() || !impossible.empty();
  }

  static bool moves(const RobotModel& robot, const Link& link) {
    return link.parent_joint >= 0 &&
           robot.joints()[static_cast<std::size_t>(link.parent_joint)].kind != JointKind::fixed;
  }

  static bool possible(const Eigen::Matrix3d& inertia) {
    const Vector3 i =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly)
            .eigenvalues();
    return i[0] > 0 && i[0] + i[1] >= i[2] * (1 - 1e-3);
  }

  /// Writes mass and inertia of the box around the capsules; returns the mass. `mass`: kept when
  /// above 0.
  double assume_mass(const Link& link, const std::vector<LinkCapsule>& capsules, int index,
                     double mass) {
    Eigen::AlignedBox3d box;
    double volume = 0;
    for (const LinkCapsule& c : capsules) {
      if (c.link != index) continue;
      for (const Vector3& end : {c.a, c.b}) {
        box.extend(Vector3(end.array() - c.radius));
        box.extend(Vector3(end.array() + c.radius));
      }
      volume += M_PI * c.radius * c.radius * ((c.b - c.a).norm() + 4.0 / 3.0 * c.radius);
    }
    constexpr double kSmallSide = 0.02;  // of links without shapes [m]
    if (box.isEmpty())
      box = Eigen::AlignedBox3d(Vector3::Constant(-kSmallSide / 2),
                                Vector3::Constant(kSmallSide / 2));
    if (!(mass > 0)) mass = std::max(source_.assumed.min_mass, source_.assumed.density * volume);
    const Vector3 s = box.sizes().cwiseAbs2() * mass / 12;
    each("link", [&](XMLElement& e) {
      if (attribute_of(&e, "name") != link.name) return;
      XMLElement* inertial = child_of(e, "inertial");
      const Vector3 middle = link.mass > 0 ? link.com : Vector3(box.center());
      child_of(*inertial, "origin")->SetAttribute("xyz", text_of(middle).c_str());
      child_of(*inertial, "origin")->SetAttribute("rpy", "0 0 0");
      child_of(*inertial, "mass")->SetAttribute("value", text_of(mass).c_str());
      XMLElement* inertia = child_of(*inertial, "inertia");
      for (const char* key : {"ixy", "ixz", "iyz"}) inertia->SetAttribute(key, "0");
      inertia->SetAttribute("ixx", text_of(s.y() + s.z()).c_str());
      inertia->SetAttribute("iyy", text_of(s.x() + s.z()).c_str());
      inertia->SetAttribute("izz", text_of(s.x() + s.y()).c_str());
    });
    return mass;
  }

  /// Meshes that were exported with y up do not contain the mass centres of their links.
  void refuse_y_up(const RobotModel& robot) const {
    constexpr double kSlack = 0.1;  // of the longest side of the box around a link
    std::vector<std::string> turned;
    std::size_t inside = 0;
    for (const Link& link : robot.links()) {
      if (link.mass == 0 || link.com.norm() < 1e-6) continue;
      Eigen::AlignedBox3d as_is, y_up;
      for (const PlacedShape& placed : link.collision) {
        const auto* mesh = std::get_if<MeshPtr>(&placed.shape);
        if (mesh == nullptr) continue;
        for (const Vector3& v : (*mesh)->vertices) {
          as_is.extend(placed.T_parent_shape * v);
          y_up.extend(placed.T_parent_shape * Vector3(v.x(), -v.z(), v.y()));
        }
      }
      if (as_is.isEmpty()) continue;
      const double slack = kSlack * as_is.sizes().maxCoeff();
      if (as_is.exteriorDistance(link.com) <= slack)
        ++inside;
      else if (y_up.exteriorDistance(link.com) <= slack)
        turned.push_back(link.name);
    }
    if (turned.size() > 1 && turned.size() > inside)
      throw ConfigError(source_.file.string() + ": the mass centres of links " + listed(turned) +
                        " are outside their meshes and inside when y of the meshes is up; export "
                        "the meshes with z up, or add rpy=\"1.5708 0 0\" to their origins");
  }

  void save() {
    std::string comment = " Corrected copy of " + source_.file.filename().string() +
                          ", written by `handsel model new`: ";
    for (const std::string& n : notes_) comment += "\n  " + n;
    for (auto at = comment.find("--"); at != std::string::npos; at = comment.find("--"))
      comment.replace(at, 2, "==");
    if (comment_ != nullptr) xml_.DeleteNode(comment_);
    comment_ = xml_.NewComment((comment + "\n").c_str());
    xml_.InsertAfterChild(xml_.FirstChild(), comment_);
    if (xml_.SaveFile(source_.copy.c_str()) != tinyxml2::XML_SUCCESS)
      throw ConfigError("cannot write " + source_.copy.string() + "; --out names another folder");
  }

  const UrdfSource& source_;
  tinyxml2::XMLDocument xml_;
  XMLElement* robot_{};
  tinyxml2::XMLComment* comment_{};
  bool changed_{};
  std::vector<std::string> notes_, no_velocity_, no_effort_;
  std::map<std::string, double> extents_;  // longest side by file, in units of the file
};

}  // namespace

CorrectedUrdf correct_urdf(const UrdfSource& source) { return Corrector(source).correct(); }

}  // namespace handsel
