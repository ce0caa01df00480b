// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/catalogue.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "common/config/resources.hpp"
#include "common/config/search_path.hpp"
#include "common/model/description/robot_text.hpp"
#include "common/model/platform.hpp"
#include "common/topics/topics.hpp"
#include "common/wire/schema.hpp"
#include "components/bridge/drawn_urdf.hpp"

namespace handsel::bridge {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;

bool queued(Profile profile) {
  return profile == Profile::command || profile == Profile::goal || profile == Profile::request ||
         profile == Profile::reply;
}
bool kept(Profile profile) { return profile == Profile::state || profile == Profile::latch; }

struct Description {
  std::string folder;  ///< for example "robots/jido"; empty if the robot's URDF is not among the
                       ///< resources, or not unchanged
  config::RobotDescription robot;
};

Description describe(const RobotModel& robot, const fs::path& resources) {
  Description out;
  const std::string folder = "robots/" + robot.name();
  const fs::path file = resources / folder / (robot.name() + ".txtpb");
  if (!fs::exists(file)) return out;
  out.robot = read_robot_text(file);
  const bool whole = !drives(robot) && !out.robot.has_mount() && out.robot.without().empty();
  if (whole && fs::is_regular_file(resources / folder / out.robot.urdf())) out.folder = folder;
  return out;
}

/// Returns the URDF for viewers: meshes by their address on this server.
std::string robot_description(const RobotModel& robot, const Description& description,
                              const fs::path& resources) {
  if (description.folder.empty()) return drawn_urdf(robot);
  std::ostringstream text;
  text << std::ifstream(resources / description.folder / description.robot.urdf()).rdbuf();
  static const std::regex relative(R"re(filename="([^":]+)")re");
  return std::regex_replace(text.str(), relative,
                            "filename=\"package://handsel/" + description.folder + "/$1\"");
}

/// Returns an object of the page with the address of its mesh; empty if there is none.
Json drawn(const config::ObjectDescription& object, const std::string& address) {
  Json one = Json::object();
  if (!address.empty()) one["mesh"] = address;
  one["scale"] = {1.0, 1.0, 1.0};
  if (object.has_scale())
    one["scale"] = {object.scale().x(), object.scale().y(), object.scale().z()};
  return one;
}

Json objects(const fs::path& resources) {
  Json out = Json::object();
  for (const auto& entry : fs::directory_iterator(resources / "objects")) {
    const std::string folder = entry.path().filename();
    const fs::path file = entry.path() / (folder + ".txtpb");
    if (!fs::exists(file)) continue;
    config::ObjectDescription object;
    load_text_proto(file, object);
    out[object.name()] = drawn(
        object, object.mesh().empty() ? "" : "/assets/objects/" + folder + "/" + object.mesh());
  }
  for (const OwnMesh& own : own_meshes(resources)) {
    config::ObjectDescription object;
    load_text_proto(own.description, object);
    out[object.name()] = drawn(object, own.address);
  }
  return out;
}

}  // namespace

std::vector<OwnMesh> own_meshes(const fs::path& resources) {
  std::vector<OwnMesh> out;
  std::error_code ignored;
  const std::string root = (fs::canonical(resources, ignored) / "").string();
  for (const fs::path& file : all_files(FileKind::object)) {
    if (file.string().starts_with(root)) continue;
    try {
      config::ObjectDescription object;
      load_text_proto(file, object);
      const fs::path mesh = file.parent_path() / object.mesh();
      if (object.name().empty() || object.mesh().empty() || !fs::is_regular_file(mesh)) continue;
      std::string kind = mesh.extension().string();
      std::transform(kind.begin(), kind.end(), kind.begin(),
                     [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
      const bool is_drawn = kind == ".stl" || kind == ".obj";  // formats the page can read
      out.push_back(
          {file, mesh, is_drawn ? "/assets/own/" + std::to_string(out.size()) + kind : ""});
    } catch (const ConfigError&) {  // an invalid description that no component uses
    }
  }
  return out;
}

Catalogue make_catalogue(const RobotModel& robot, const fs::path& resources,
                         const SystemFacts& facts) {
  Catalogue catalogue;
  catalogue.name = "handsel " + robot.name();
  catalogue.session = facts.session;
  catalogue.metadata = {{"robot", robot.name()},
                        {"scenario", facts.scenario},
                        {"domain", std::to_string(facts.domain)},
                        {"version", facts.version}};
  catalogue.parameters = catalogue.metadata;
  catalogue.parameters["/robot_description"] =
      robot_description(robot, describe(robot, resources), resources);
  for (const TopicRow& row : topics()) {
    Channel channel;
    channel.topic = row.topic;
    channel.encoding = "cdr";
    channel.schema_name = idl_name(row);
    channel.schema = idl_schema(row);
    channel.schema_encoding = "omgidl";
    channel.queued = queued(row.profile);
    channel.kept = kept(row.profile);
    catalogue.channels.push_back(std::move(channel));
  }
  return catalogue;
}

std::string config_json(const RobotModel& robot, const fs::path& resources,
                        const SystemFacts& facts) {
  Json json{{"robot", robot.name()},
            {"scenario", facts.scenario},
            {"domain", facts.domain},
            {"version", facts.version}};
  const Description description = describe(robot, resources);
  if (!description.folder.empty()) {
    json["urdf"] = "/assets/" + description.folder + "/" + description.robot.urdf();
    json["srdf"] = "/assets/" + description.folder + "/" + description.robot.srdf();
  } else {
    json["urdf"] = "";
    json["urdf_text"] = drawn_urdf(robot);
  }
  const auto link = [&](int index) {
    return index < 0 ? std::string() : robot.links()[static_cast<std::size_t>(index)].name;
  };
  json["tool_link"] = link(robot.tool_link());
  json["gaze_link"] = link(robot.gaze_link());
  for (const Group& group : robot.groups())
    for (const int axis : group.axes)
      json["groups"][group.name].push_back(robot.axes()[static_cast<std::size_t>(axis)].name);
  json["axes"] = Json::array();
  for (const Axis& axis : robot.axes()) json["axes"].push_back(axis.name);
  const KinematicLimits& guard = robot.guard_limits();
  for (std::size_t i = 0; i < robot.axes().size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    json["limits"].push_back({{"lower", robot.axes()[i].lower},
                              {"upper", robot.axes()[i].upper},
                              {"velocity", guard.velocity[k]},
                              {"acceleration", guard.acceleration[k]},
                              {"jerk", guard.jerk[k]}});
  }
  json["zones"] = facts.zones;
  json["attentive_angle"] = facts.attentive_angle;
  json["objects"] = objects(resources);
  json["topics"] = Json::array();
  for (const TopicRow& row : topics())
    json["topics"].push_back({{"topic", row.topic},
                              {"type", idl_name(row)},
                              {"profile", name(row.profile)},
                              {"rate", row.rate}});
  return json.dump();
}

}  // namespace handsel::bridge
