#include <tinyxml2.h>

#include <functional>

#include "common/model/robot_model_builder.hpp"

namespace handsel {
namespace {

std::string attribute(const tinyxml2::XMLElement& e, const char* key) {
  const char* value = e.Attribute(key);
  return value != nullptr ? value : "";
}

}  // namespace

void RobotModelBuilder::read_srdf(const std::filesystem::path& srdf, bool groups, bool strict) {
  if (!std::filesystem::is_regular_file(srdf)) throw MissingError("no file " + srdf.string());
  tinyxml2::XMLDocument xml;
  if (xml.LoadFile(srdf.c_str()) != tinyxml2::XML_SUCCESS)
    throw ConfigError(srdf.string() + ":" + std::to_string(xml.ErrorLineNum()) + ": not well-formed XML");
  const auto* robot = xml.FirstChildElement("robot");
  if (robot == nullptr) throw ConfigError(srdf.string() + ": has no <robot> element");
  const auto where = [&](const tinyxml2::XMLElement& e) { return srdf.string() + ":" + std::to_string(e.GetLineNum()) + ": "; };
  const auto link = [&](const tinyxml2::XMLElement& e, const char* key) {
    const int index = model_.link_index(attribute(e, key));
    if (index < 0 && strict) throw ConfigError(where(e) + "no link \"" + attribute(e, key) + "\" in " + urdf_.string());
    return index;
  };

  for (const auto* e = robot->FirstChildElement("disable_collisions"); e != nullptr; e = e->NextSiblingElement("disable_collisions")) {
    const int a = link(*e, "link1"), b = link(*e, "link2");
    if (a >= 0 && b >= 0) disable(a, b);
  }
  if (!groups) return;

  std::function<void(const tinyxml2::XMLElement&, std::vector<std::string>&, std::string&, int)> collect;
  collect = [&](const tinyxml2::XMLElement& group, std::vector<std::string>& joints, std::string& tip, int depth) {
    const auto add = [&](int joint) {
      if (joint < 0 || axis_of(model_.joints_[joint].name) < 0 || model_.joints_[joint].is_mimic) return;
      const std::string& name = model_.joints_[joint].name;
      for (const auto& known : joints)
        if (known == name) return;
      joints.push_back(name);
    };
    for (const auto* e = group.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      const std::string tag = e->Name();
      if (tag == "joint") {
        const int joint = joint_index(attribute(*e, "name"));
        if (joint < 0 && strict) throw ConfigError(where(*e) + "no joint \"" + attribute(*e, "name") + "\" in " + urdf_.string());
        add(joint);
      } else if (tag == "link") {
        if (const int index = link(*e, "name"); index >= 0) add(model_.links_[index].parent_joint);
      } else if (tag == "chain") {
        const int base = link(*e, "base_link"), end = link(*e, "tip_link");
        std::vector<int> chain;
        int at = end;
        for (; at >= 0 && at != base && model_.links_[at].parent_joint >= 0; at = model_.joints_[chain.back()].parent)
          chain.push_back(model_.links_[at].parent_joint);
        if (at != base) throw ConfigError(where(*e) + "tip_link does not descend from base_link");
        for (auto joint = chain.rbegin(); joint != chain.rend(); ++joint) add(*joint);
        tip = attribute(*e, "tip_link");
      } else if (tag == "group" && depth < 8) {
        for (const auto* g = robot->FirstChildElement("group"); g != nullptr; g = g->NextSiblingElement("group"))
          if (attribute(*g, "name") == attribute(*e, "name")) collect(*g, joints, tip, depth + 1);
      }
    }
  };
  for (const auto* e = robot->FirstChildElement("group"); e != nullptr; e = e->NextSiblingElement("group")) {
    std::vector<std::string> joints;
    std::string tip;
    collect(*e, joints, tip, 0);
    if (joints.empty() || attribute(*e, "name").empty()) continue;
    if (tip.empty()) tip = model_.links_[model_.joints_[joint_index(joints.back())].child].name;
    add_group(attribute(*e, "name"), joints, tip, srdf);
  }
}

}  // namespace handsel
