// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/own_robot/srdf_pairs.hpp"

#include <fstream>

#include "common/config/text_file.hpp"
#include "common/model/description/xml_file.hpp"

namespace handsel {

std::vector<SrdfPair> read_srdf_pairs(const std::filesystem::path& srdf) {
  tinyxml2::XMLDocument xml;
  parse_xml(xml, srdf, read_text_file(srdf));
  const auto* robot = xml.FirstChildElement("robot");
  if (robot == nullptr) throw ConfigError(srdf.string() + ": has no <robot> element");
  std::vector<SrdfPair> pairs;
  for (const auto* e = robot->FirstChildElement("disable_collisions"); e != nullptr;
       e = e->NextSiblingElement("disable_collisions")) {
    const auto text = [&](const char* key) {
      const char* value = e->Attribute(key);
      return std::string(value != nullptr ? value : "");
    };
    pairs.push_back({text("link1"), text("link2"), text("reason")});
  }
  return pairs;
}

std::set<std::string> links_of(const std::vector<SrdfPair>& pairs) {
  std::set<std::string> names;
  for (const SrdfPair& pair : pairs) names.insert({pair.a, pair.b});
  return names;
}

void write_srdf(const std::filesystem::path& file, const std::string& robot,
                const std::string& comment, const std::vector<SrdfPair>& pairs) {
  tinyxml2::XMLDocument xml;
  xml.InsertEndChild(xml.NewDeclaration());
  xml.InsertEndChild(xml.NewComment((" " + comment + " ").c_str()));
  auto* top = xml.NewElement("robot");
  top->SetAttribute("name", robot.c_str());
  xml.InsertEndChild(top);
  for (const SrdfPair& pair : pairs) {
    auto* e = top->InsertNewChildElement("disable_collisions");
    e->SetAttribute("link1", pair.a.c_str());
    e->SetAttribute("link2", pair.b.c_str());
    e->SetAttribute("reason", pair.reason.c_str());
  }
  if (xml.SaveFile(file.c_str()) != tinyxml2::XML_SUCCESS)
    throw ConfigError("cannot write " + file.string() + "; --out names another folder");
}

}  // namespace handsel
