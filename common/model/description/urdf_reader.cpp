// SPDX-License-Identifier: Apache-2.0
#include <console_bridge/console.h>
#include <tinyxml2.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <set>
#include <sstream>

#include "common/config/resources.hpp"
#include "common/config/text_check.hpp"
#include "common/config/text_file.hpp"
#include "common/model/description/description_parts.hpp"
#include "common/model/description/mesh_file.hpp"
#include "common/model/description/robot_model_builder.hpp"
#include "common/model/description/xml_file.hpp"

namespace handsel {
namespace fs = std::filesystem;
namespace {

Pose to_pose(const urdf::Pose& pose) {
  const auto& r = pose.rotation;
  return make_pose({pose.position.x, pose.position.y, pose.position.z},
                   Eigen::Quaterniond(r.w, r.x, r.y, r.z));
}

/// Collects the messages of urdfdom about an invalid file instead of printing them.
class Listener : public console_bridge::OutputHandler {
 public:
  Listener() { console_bridge::useOutputHandler(this); }
  ~Listener() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && said.empty()) said = text;
  }
  std::string said;
};

constexpr std::size_t kMaxLinks = 1000;
constexpr double kLargestNumber =
    1e12;  // max number in any unit: some files write 1e10 for an unlimited axis

/// Throws ConfigError if a numeric attribute, in the element or below, has another content, or if a
/// name contains a control character.
void require_attributes(const tinyxml2::XMLElement& e, const fs::path& file) {
  static const std::set<std::string_view> numeric{
      "xyz", "rpy", "size", "radius", "length", "scale",  "ixx",      "ixy",        "ixz",
      "iyy", "iyz", "izz",  "lower",  "upper",  "effort", "velocity", "multiplier", "offset"};
  static const std::set<std::string_view> names{"name", "link", "joint", "filename", "type"};
  const bool is_mass = std::string_view(e.Name()) == "mass";
  for (const auto* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string_view key = a->Name(), value = a->Value();
    if (names.contains(key) &&
        std::any_of(value.begin(), value.end(), [](unsigned char c) { return c < 32; }))
      throw ConfigError(file.string() + ":" + std::to_string(e.GetLineNum()) + ": " + a->Name() +
                        " of <" + printable(e.Name(), 40) + "> holds a control character");
    if (!numeric.contains(key) && !(is_mass && key == "value")) continue;
    std::istringstream words(a->Value());
    for (std::string word; words >> word;) {
      char* end = nullptr;
      const double number = std::strtod(word.c_str(), &end);
      if (*end != '\0' || !std::isfinite(number) || std::abs(number) > kLargestNumber)
        throw ConfigError(file.string() + ":" + std::to_string(e.GetLineNum()) + ": " + a->Name() +
                          " of <" + printable(e.Name(), 40) + "> is \"" + printable(word, 40) +
                          "\", must be a finite number");
    }
  }
  for (const auto* child = e.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement())
    require_attributes(*child, file);
}

/// Checks what urdfdom does not report, or only without a line: XML errors, duplicates, shapes
/// unknown to URDF, links with two parents.
struct Document {
  Document(const fs::path& file, const std::string& text) {
    tinyxml2::XMLDocument xml;
    parse_xml(xml, file, text);
    const auto* robot = xml.FirstChildElement("robot");
    if (robot == nullptr) throw ConfigError(file.string() + ": has no <robot> element");
    std::set<std::string> links, children;
    for (const auto* e = robot->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      const std::string tag = e->Name(),
                        where = file.string() + ":" + std::to_string(e->GetLineNum());
      const std::string own = e->Attribute("name") != nullptr ? e->Attribute("name") : "";
      if (tag == "link" || tag == "joint") require_attributes(*e, file);
      if (tag == "link") {
        if (!links.insert(own).second)
          throw ConfigError(where + ": link " + own + " is defined twice");
        for (const char* use : {"visual", "collision"})
          for (const auto* v = e->FirstChildElement(use); v != nullptr;
               v = v->NextSiblingElement(use))
            if (const auto* g = v->FirstChildElement("geometry");
                g != nullptr && g->FirstChildElement("capsule") != nullptr)
              throw ConfigError(
                  file.string() + ":" +
                  std::to_string(g->FirstChildElement("capsule")->GetLineNum()) + ": link " + own +
                  " has a <capsule>, which is not URDF; use box, cylinder, sphere or mesh");
      } else if (tag == "joint" && e->FirstChildElement("parent") != nullptr) {
        if (!names.insert(own).second)
          throw ConfigError(where + ": joint " + own + " is defined twice");
        joints.push_back(own);
        const auto* child = e->FirstChildElement("child");
        const std::string link =
            child != nullptr && child->Attribute("link") != nullptr ? child->Attribute("link") : "";
        const auto* above = e->FirstChildElement("parent");
        parents[link] = {above->Attribute("link") != nullptr ? above->Attribute("link") : "",
                         where};
        if (!children.insert(link).second)
          throw ConfigError(where + ": link " + link + " has more than one parent joint");
      }
    }
    if (links.empty()) throw ConfigError(file.string() + ": has no link");
    if (links.size() > kMaxLinks)
      throw ConfigError(file.string() + ": has " + std::to_string(links.size()) +
                        " links, must have at most 1000");
    for (const auto& [start, joint] : parents) {
      std::size_t steps = 0;
      for (auto up = parents.find(start); up != parents.end(); up = parents.find(up->second.first))
        if (++steps > parents.size())
          throw ConfigError(joint.second + ": the joints above link " + start + " form a cycle");
    }
  }
  std::vector<std::string> joints;
  std::set<std::string> names;
  std::map<std::string, std::pair<std::string, std::string>>
      parents;  // by child link: parent link, file and line
};

class ShapeReader {
 public:
  ShapeReader(fs::path urdf, Meshes meshes, std::vector<fs::path> packages)
      : urdf_(std::move(urdf)), meshes_(meshes), packages_(std::move(packages)) {}

  void read(const urdf::Link& from, std::vector<PlacedShape>& to) {
    for (const auto& c : from.collision_array)
      if (c != nullptr && c->geometry != nullptr)
        if (auto shape = read(*c->geometry, from.name)) to.push_back({*shape, to_pose(c->origin)});
  }

 private:
  std::optional<Shape> read(const urdf::Geometry& g, const std::string& link) {
    const auto positive = [&](double x) {
      if (!(x > 0))
        throw ConfigError(locate(urdf_, "\"" + link + "\"") + ": link " + link +
                          " has a collision shape whose size is not > 0");
      return x;
    };
    switch (g.type) {
      case urdf::Geometry::SPHERE:
        return Sphere{positive(static_cast<const urdf::Sphere&>(g).radius)};
      case urdf::Geometry::BOX: {
        const auto& d = static_cast<const urdf::Box&>(g).dim;
        return Box{{positive(d.x), positive(d.y), positive(d.z)}};
      }
      case urdf::Geometry::CYLINDER: {
        const auto& c = static_cast<const urdf::Cylinder&>(g);
        return Cylinder{positive(c.radius), positive(c.length)};
      }
      case urdf::Geometry::MESH:
        break;
    }
    if (meshes_ == Meshes::skip) return std::nullopt;
    const auto& m = static_cast<const urdf::Mesh&>(g);
    const fs::path file = find_mesh(urdf_, m.filename, packages_);
    const Vector3 scale(m.scale.x, m.scale.y, m.scale.z);
    for (const auto& known : cache_)
      if (known.file == file && known.scale == scale) return known.mesh;
    cache_.push_back({file, scale, std::make_shared<const TriangleMesh>(load_mesh(file, scale))});
    return cache_.back().mesh;
  }

  struct Known {
    fs::path file;
    Vector3 scale;
    MeshPtr mesh;
  };
  fs::path urdf_;
  Meshes meshes_;
  std::vector<fs::path> packages_;
  std::vector<Known> cache_;
};

urdf::ModelInterfaceSharedPtr parse(const fs::path& file, const std::string& text) {
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  Listener listener;
  auto model = urdf::parseURDF(text);
  if (model == nullptr)
    throw ConfigError(file.string() + ": " +
                      (listener.said.empty() ? "not a URDF" : printable(listener.said, 300)));
  return model;
}

JointKind kind_of(int type) {
  switch (type) {
    case urdf::Joint::REVOLUTE:
      return JointKind::revolute;
    case urdf::Joint::CONTINUOUS:
      return JointKind::continuous;
    case urdf::Joint::PRISMATIC:
      return JointKind::prismatic;
    default:
      return JointKind::fixed;
  }
}

Joint to_joint(const urdf::Joint& from, int parent, int child, const fs::path& file) {
  Joint joint;
  joint.name = from.name;
  joint.kind = kind_of(from.type);
  joint.parent = parent;
  joint.child = child;
  joint.T_parent_joint = to_pose(from.parent_to_joint_origin_transform);
  if (joint.kind == JointKind::fixed) return joint;
  const auto where = [&] { return locate(file, "\"" + from.name + "\""); };
  joint.axis = Vector3(from.axis.x, from.axis.y, from.axis.z);
  if (!(joint.axis.norm() > 1e-6))
    throw ConfigError(where() + ": joint " + from.name + " has an axis of length 0");
  joint.axis.normalize();
  if (from.limits != nullptr) {
    joint.lower = from.limits->lower;
    joint.upper = from.limits->upper;
    joint.max_velocity = from.limits->velocity;
    joint.max_effort = from.limits->effort;
  }
  if (joint.kind == JointKind::continuous) {
    joint.lower = -2 * M_PI;
    joint.upper = 2 * M_PI;
  }
  joint.is_mimic = from.mimic != nullptr;
  if (!(joint.lower <= joint.upper))
    throw ConfigError(where() + ": joint " + from.name + " has lower limit above its upper limit");
  return joint;
}

void read_mass(const urdf::Link& from, Link& to, const fs::path& file) {
  if (from.inertial == nullptr) return;
  const auto& i = *from.inertial;
  if (!(i.mass >= 0))
    throw ConfigError(locate(file, "\"" + from.name + "\"") + ": link " + from.name +
                      " has a mass below 0");
  const Pose T = to_pose(i.origin);
  Eigen::Matrix3d inertia;
  inertia << i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz;
  to.mass = i.mass;
  to.com = T.translation();
  to.inertia = T.linear() * inertia * T.linear().transpose();
}

/// Follows mimic joints to the actuated joint and composes factor and offset. Names first, axes
/// later.
void resolve_mimic(const urdf::ModelInterface& urdf, const fs::path& file, Joint& joint,
                   std::vector<Joint>& joints) {
  double factor = 1, offset = 0;
  std::string name = joint.name;
  for (std::size_t depth = 0; depth <= joints.size(); ++depth) {
    const auto from = urdf.getJoint(name);
    if (from->mimic == nullptr) {
      for (std::size_t j = 0; j < joints.size(); ++j)
        if (joints[j].name == name) joint.dof = static_cast<int>(j);
      joint.mimic_factor = factor;
      joint.mimic_offset = offset;
      if (joint.dof < 0)
        throw ConfigError(locate(file, "\"" + joint.name + "\"") + ": joint " + joint.name +
                          " mimics " + name + ", which is left out");
      return;
    }
    offset += factor * from->mimic->offset;
    factor *= from->mimic->multiplier;
    if (urdf.getJoint(from->mimic->joint_name) == nullptr)
      throw ConfigError(locate(file, "\"" + name + "\"") + ": joint " + name + " mimics " +
                        from->mimic->joint_name + ", which does not exist");
    name = from->mimic->joint_name;
  }
  throw ConfigError(locate(file, "\"" + joint.name + "\"") + ": joint " + joint.name +
                    " mimics itself in a circle");
}

}  // namespace

RobotModelBuilder::RobotModelBuilder(const fs::path& urdf, Meshes meshes,
                                     const UrdfOptions& options)
    : urdf_(urdf) {
  const std::string text = read_text_file(urdf);
  const Document document(urdf, text);
  const auto tree = parse(urdf, text);
  model_.name_ = tree->getName();
  ShapeReader shapes(urdf, meshes, options.packages);
  std::set<std::string> without(options.without.begin(), options.without.end());
  for (const auto& name : without)
    if (tree->getLink(name) == nullptr)
      throw ConfigError(urdf.string() + ": has no link \"" + name + "\" that could be left out");
  if (without.contains(tree->getRoot()->name))
    throw ConfigError(urdf.string() + ": the root link cannot be left out");

  struct Visit {
    const urdf::Link* link;
    int parent;
  };
  std::vector<Visit> stack{{tree->getRoot().get(), -1}};
  std::size_t visited = 0;
  while (!stack.empty()) {
    const auto [from, parent] = stack.back();
    stack.pop_back();
    ++visited;
    if (without.contains(from->name)) {
      for (const auto& child : from->child_links) {
        without.insert(child->name);
        stack.push_back({child.get(), -1});
      }
      continue;
    }
    const int index = static_cast<int>(model_.links_.size());
    Link link;
    link.name = from->name;
    if (parent >= 0) {
      link.parent_joint = static_cast<int>(model_.joints_.size());
      model_.joints_.push_back(to_joint(*from->parent_joint, parent, index, urdf));
    }
    shapes.read(*from, link.collision);
    read_mass(*from, link, urdf);
    model_.links_.push_back(std::move(link));
    for (auto child = from->child_links.rbegin(); child != from->child_links.rend(); ++child)
      stack.push_back({child->get(), index});
  }
  left_out_ = without;
  if (visited != tree->links_.size())
    throw ConfigError(urdf.string() + ": some joints form a cycle apart from the root link");

  for (const auto& name : document.joints)
    if (const int joint = joint_index(name); joint >= 0) document_order_.push_back(joint);
  for (auto& joint : model_.joints_)
    if (joint.kind != JointKind::fixed) resolve_mimic(*tree, urdf, joint, model_.joints_);
}

void RobotModelBuilder::mount(RobotModelBuilder other, const config::HandMount& at,
                              const fs::path& source) {
  const int parent = require_link(at.link(), "mount.link", source);
  RobotModel& hand = other.model_;
  for (const auto& link : hand.links_)
    if (model_.link_index(link.name) >= 0)
      throw ConfigError(source.string() + ": link \"" + link.name + "\" is in " + urdf_.string() +
                        " and in " + other.urdf_.string() +
                        "; leave it out of the first (without) or do not mount the second");
  for (const auto& joint : hand.joints_)
    if (joint_index(joint.name) >= 0)
      throw ConfigError(source.string() + ": joint \"" + joint.name + "\" is in " + urdf_.string() +
                        " and in " + other.urdf_.string());
  const auto links = static_cast<int>(model_.links_.size()),
             joints = static_cast<int>(model_.joints_.size()) + 1;
  Joint flange;
  flange.name = other.model_.links_.front().name + "_mount";
  flange.parent = parent;
  flange.child = links;
  flange.T_parent_joint = to_pose(at.pose());
  model_.joints_.push_back(flange);
  for (Joint& joint : hand.joints_) {
    joint.parent += links;
    joint.child += links;
    if (joint.dof >= 0) joint.dof += joints;
    model_.joints_.push_back(std::move(joint));
  }
  for (Link& link : hand.links_) {
    link.parent_joint = link.parent_joint < 0 ? joints - 1 : link.parent_joint + joints;
    model_.links_.push_back(std::move(link));
  }
  for (const int joint : other.document_order_) document_order_.push_back(joint + joints);
}

}  // namespace handsel
