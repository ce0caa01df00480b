// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "common/config/text_file.hpp"
#include "common/model/description/robot_model_builder.hpp"
#include "common/model/description/xml_file.hpp"

namespace handsel {
namespace {

using tinyxml2::XMLElement;

std::string attribute(const XMLElement& e, const char* key) {
  const char* value = e.Attribute(key);
  return value != nullptr ? value : "";
}

template <class Visit>
void each_child(const XMLElement& parent, const char* name, const Visit& visit) {
  for (const auto* e = parent.FirstChildElement(name); e != nullptr;
       e = e->NextSiblingElement(name))
    visit(*e);
}

}  // namespace

/// Reads one SRDF into the model of a builder.
class SrdfReader {
 public:
  SrdfReader(RobotModelBuilder& builder, const std::filesystem::path& srdf, const XMLElement& robot,
             bool strict)
      : builder_(builder), srdf_(srdf), robot_(robot), strict_(strict) {}

  void read_disabled_pairs() {
    each_child(robot_, "disable_collisions", [&](const XMLElement& e) {
      const int a = link(e, "link1"), b = link(e, "link2");
      if (a >= 0 && b >= 0) builder_.disable(a, b);
    });
  }

  void read_groups() {
    constexpr int kMaxGroups = 500;
    int groups = 0;
    each_child(robot_, "group", [&](const XMLElement&) { ++groups; });
    if (groups > kMaxGroups)
      throw ConfigError(srdf_.string() + ": has " + std::to_string(groups) +
                        " groups, must have at most 500");
    each_child(robot_, "group", [&](const XMLElement& e) {
      const std::string name = attribute(e, "name");
      joints_.clear();
      tip_.clear();
      visits_.clear();
      collect_named(name, e);
      if (joints_.empty() || name.empty()) return;
      if (tip_.empty())
        tip_ = builder_.model_
                   .links()[builder_.model_.joints()[builder_.joint_index(joints_.back())].child]
                   .name;
      builder_.add_group(name, joints_, tip_, srdf_);
    });
  }

 private:
  enum class Visit { open, done };

  std::string where(const XMLElement& e) const {
    return srdf_.string() + ":" + std::to_string(e.GetLineNum()) + ": ";
  }

  int link(const XMLElement& e, const char* key) const {
    const int index = builder_.model_.link_index(attribute(e, key));
    if (index < 0 && strict_ && !builder_.left_out_.contains(attribute(e, key)))
      throw ConfigError(where(e) + "no link \"" + attribute(e, key) + "\" in " +
                        builder_.urdf_.string());
    return index;
  }

  /// Collects the joints of a group and its subgroups, each subgroup once.
  void collect_named(const std::string& name, const XMLElement& group) {
    visits_[name] = Visit::open;
    for (const auto* e = group.FirstChildElement(); e != nullptr; e = e->NextSiblingElement())
      collect(*e);
    visits_[name] = Visit::done;
  }

  void collect(const XMLElement& e) {
    const std::string tag = e.Name();
    if (tag == "joint") {
      const int joint = builder_.joint_index(attribute(e, "name"));
      if (joint < 0 && strict_)
        throw ConfigError(where(e) + "no joint \"" + attribute(e, "name") + "\" in " +
                          builder_.urdf_.string());
      add(joint);
    } else if (tag == "link") {
      if (const int index = link(e, "name"); index >= 0)
        add(builder_.model_.links()[index].parent_joint);
    } else if (tag == "chain") {
      add_chain(e);
    } else if (tag == "group") {
      const std::string name = attribute(e, "name");
      const auto visit = visits_.find(name);
      if (visit != visits_.end() && visit->second == Visit::open)
        throw ConfigError(where(e) + "group \"" + name +
                          "\" contains itself; a group may only contain others");
      if (visit == visits_.end())
        each_child(robot_, "group", [&](const XMLElement& g) {
          if (attribute(g, "name") == name) collect_named(name, g);
        });
    }
  }

  void add(int joint) {
    const RobotModel& model = builder_.model_;
    if (joint < 0 || builder_.axis_of(model.joints()[joint].name) < 0 ||
        model.joints()[joint].is_mimic)
      return;
    const std::string& name = model.joints()[joint].name;
    for (const auto& known : joints_)
      if (known == name) return;
    joints_.push_back(name);
  }

  void add_chain(const XMLElement& e) {
    const RobotModel& model = builder_.model_;
    const int base = link(e, "base_link"), end = link(e, "tip_link");
    std::vector<int> chain;
    int at = end;
    for (; at >= 0 && at != base && model.links()[at].parent_joint >= 0;
         at = model.joints()[chain.back()].parent)
      chain.push_back(model.links()[at].parent_joint);
    if (at != base) throw ConfigError(where(e) + "tip_link does not descend from base_link");
    for (auto joint = chain.rbegin(); joint != chain.rend(); ++joint) add(*joint);
    tip_ = attribute(e, "tip_link");
  }

  RobotModelBuilder& builder_;
  const std::filesystem::path& srdf_;
  const XMLElement& robot_;
  bool strict_;
  std::vector<std::string> joints_;  // joints of the group being read
  std::string tip_;
  std::map<std::string, Visit> visits_;  // visits of its subgroups
};

void RobotModelBuilder::read_srdf(const std::filesystem::path& srdf, bool groups, bool strict) {
  tinyxml2::XMLDocument xml;
  parse_xml(xml, srdf, read_text_file(srdf));
  const auto* robot = xml.FirstChildElement("robot");
  if (robot == nullptr) throw ConfigError(srdf.string() + ": has no <robot> element");
  SrdfReader reader(*this, srdf, *robot, strict);
  reader.read_disabled_pairs();
  if (groups) reader.read_groups();
}

}  // namespace handsel
