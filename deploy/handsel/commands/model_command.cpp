// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/commands/model_command.hpp"

#include <Eigen/Eigenvalues>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>

#include "common/config/described.hpp"
#include "common/config/resources.hpp"
#include "common/model/description/robot_text.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/manipulator.hpp"
#include "deploy/handsel/cli/json_lines.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/own_robot/collision_matrix.hpp"
#include "deploy/handsel/own_robot/model_sweep.hpp"
#include "deploy/handsel/own_robot/srdf_pairs.hpp"

namespace handsel {
namespace {

using nlohmann::json;
using namespace command;

bool is_urdf(const std::string& robot) {
  return robot.ends_with(".urdf") || robot.ends_with(".xml");
}

/// Loads a URDF file, a description file or the robot of a name.
RobotModel load_any(const std::string& robot, Meshes meshes) {
  if (is_urdf(robot)) return RobotModel::load_urdf(robot, {}, meshes);
  return RobotModel::load(robot_description(robot));
}

const char* kind_name(JointKind kind) {
  switch (kind) {
    case JointKind::fixed:
      return "fixed";
    case JointKind::revolute:
      return "revolute";
    case JointKind::continuous:
      return "continuous";
    case JointKind::prismatic:
      return "prismatic";
  }
  return "unknown";
}

void check_rest(const RobotModel& robot, std::vector<std::string>& lacks) {
  const auto name = [&](int link) { return robot.links()[static_cast<std::size_t>(link)].name; };
  for (const auto& [a, b] : overlapping_hulls(robot, robot.rest_configuration()))
    lacks.push_back("the rest configuration brings the hulls of links " + name(a) + " and " +
                    name(b) + " together; if they cannot collide, disable the pair in the SRDF");
}

/// Returns whether the pads of a pinching hand oppose each other in some configuration.
bool pads_face(const HandModel& hand) {
  std::vector<Pose> T;
  for (int i = 0; i <= 10; ++i) {
    hand.model().forward(
        hand.lower_contact() + 0.1 * i * (hand.upper_contact() - hand.lower_contact()), T);
    const auto direction = [&](const Finger& finger) {
      return Vector3(
          T[static_cast<std::size_t>(hand.model().link_index(finger.tip_link))].linear() *
          finger.pad->T_tip_pad.linear().col(2));
    };
    if (direction(hand.fingers()[0]).dot(direction(hand.fingers()[1])) < -0.985) return true;
  }
  return false;
}

void check_masses(const RobotModel& robot, std::vector<std::string>& lacks) {
  for (const auto& link : robot.links()) {
    if (link.mass == 0) {
      if (!link.collision.empty() && link.parent_joint >= 0)
        lacks.push_back("link " + link.name + " has shapes but no mass");
      continue;
    }
    const Vector3 i =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(link.inertia, Eigen::EigenvaluesOnly)
            .eigenvalues();
    if (!(i[0] > 0) || i[0] + i[1] < i[2] * (1 - 1e-3))
      lacks.push_back("link " + link.name + " has an inertia no body can have");
  }
}

}  // namespace

std::vector<std::string> lacks_of(const RobotModel& robot) {
  std::vector<std::string> lacks;
  const auto need = [&](bool there, const std::string& what) {
    if (!there) lacks.push_back(what);
  };
  need(robot.group("arm") != nullptr, "group \"arm\" is missing: the axes that carry the tool");
  need(robot.group("hand") != nullptr, "group \"hand\" is missing: the actuated finger joints");
  need(robot.group("arm") == nullptr || robot.group("arm")->tip >= 0,
       "group \"arm\" has no tip_link");
  need(robot.tool_link() >= 0, "tool_link is missing: the frame grasps are given in");
  need(!robot.hand().empty(), "hand is missing: which hand description the robot carries");
  need(robot.gaze_link() >= 0 || robot.group("head") == nullptr,
       "gaze_link is missing: the camera that the head turns");
  need(robot.redundancy_axis() >= 0 || robot.group("arm") == nullptr ||
           robot.group("arm")->axes.size() < 7,
       "redundancy_joint is missing for an arm of seven axes");
  for (const auto& axis : robot.axes()) {
    need(axis.upper > axis.lower, "joint " + axis.name + " has no range");
    need(axis.max_effort > 0, "joint " + axis.name + " has no effort limit");
  }
  if (!robot.hand().empty() && robot.group("hand") != nullptr) {
    try {
      const HandModel hand = HandModel::load(hand_description(robot.hand()));
      const auto& group = *robot.group("hand");
      bool same = hand.model().axes().size() == group.axes.size();
      for (std::size_t i = 0; same && i < group.axes.size(); ++i)
        same = hand.model().axes()[i].name == robot.axes()[group.axes[i]].name;
      need(!hand.pinches() || pads_face(hand),
           "the pads of hand " + hand.name() + " never face each other");
      need(same,
           "group \"hand\" does not have the joints of hand " + hand.name() + " in its order");
    } catch (const std::exception& error) {
      lacks.push_back(std::string("hand: ") + error.what());
    }
  }
  check_masses(robot, lacks);
  check_rest(robot, lacks);
  return lacks;
}

namespace {

/// Checks the hand descriptions and joints of further arms.
void check_other_arms(const std::filesystem::path& description, const RobotModel& robot,
                      std::vector<std::string>& lacks) {
  for (const Manipulator& m : manipulators(description, robot)) {
    if (m.name == "arm") continue;
    try {
      const HandModel hand = HandModel::load(hand_description(m.hand));
      const auto& axes = hand.model().axes();
      bool same = axes.size() == m.fingers->axes.size();
      for (std::size_t i = 0; same && i < axes.size(); ++i)
        same = axes[i].name == robot.axes()[static_cast<std::size_t>(m.fingers->axes[i])].name;
      if (!same)
        lacks.push_back("group \"" + m.fingers->name + "\" does not have the joints of hand " +
                        hand.name() + " in its order");
    } catch (const std::exception& error) {
      lacks.push_back("hand of arm \"" + m.name + "\": " + error.what());
    }
  }
}

/// Adds what sampled configurations show to be wrong.
void check_sweep(const RobotModel& robot, std::vector<std::string>& lacks) {
  std::optional<HandModel> hand;
  try {
    if (!robot.hand().empty()) hand = HandModel::load(hand_description(robot.hand()));
  } catch (const ConfigError&) {  // lacks_of() reports it
  }
  for (const std::string& fault : sweep_faults(robot, hand ? &*hand : nullptr))
    lacks.push_back(fault);
}

/// Names the links of the SRDF that the robot does not have, because the description leaves them
/// out.
void note_left_out(const std::filesystem::path& description, const RobotModel& robot) {
  const config::RobotDescription text = read_robot_text(description);
  if (text.srdf().empty()) return;
  for (const std::string& link :
       links_of(read_srdf_pairs(described_path(description, text.srdf()))))
    if (robot.link_index(link) < 0)
      std::fprintf(
          stderr,
          "note: the SRDF names link %s, which is left out; pairs with it are passed over\n",
          link.c_str());
}

int check(const std::string& name, bool as_json, bool sweep) {
  std::vector<std::string> lacks;
  try {
    const RobotModel robot = load_any(name, Meshes::load);
    lacks = lacks_of(robot);
    if (!is_urdf(name)) {
      check_other_arms(robot_description(name), robot, lacks);
      note_left_out(robot_description(name), robot);
    }
    if (sweep) check_sweep(robot, lacks);
  } catch (const ConfigError& error) {
    lacks.push_back(error.what());
  }
  if (as_json) {
    std::cout << json{{"robot", name}, {"ok", lacks.empty()}, {"lacks", lacks}}.dump() << '\n';
  } else {
    for (const auto& lack : lacks) std::cout << lack << '\n';
    if (lacks.empty()) std::cout << name << " lacks nothing\n";
  }
  return lacks.empty() ? 0 : 1;
}

json limits_of(const RobotModel& robot, int axis) {
  const auto triple = [axis](const KinematicLimits& l) {
    return json{l.velocity[axis], l.acceleration[axis], l.jerk[axis]};
  };
  return {{"comfort", triple(robot.comfort_limits())},
          {"guard", triple(robot.guard_limits())},
          {"stop", triple(robot.stop_limits())}};
}

json describe(const RobotModel& robot) {
  json axes = json::array(), groups = json::array();
  double mass = 0;
  std::size_t shapes = 0;
  for (const auto& link : robot.links()) {
    mass += link.mass;
    shapes += link.collision.size();
  }
  for (int i = 0; i < robot.dof(); ++i) {
    const Axis& axis = robot.axes()[i];
    axes.push_back({{"name", axis.name},
                    {"kind", kind_name(robot.joints()[axis.joint].kind)},
                    {"lower", axis.lower},
                    {"upper", axis.upper},
                    {"effort", axis.max_effort},
                    {"rest", robot.rest_configuration()[i]},
                    {"limits", limits_of(robot, i)}});
  }
  for (const auto& group : robot.groups())
    groups.push_back({{"name", group.name},
                      {"axes", group.axes},
                      {"tip", group.tip < 0 ? "" : robot.links()[group.tip].name}});
  return {{"name", robot.name()},
          {"links", robot.links().size()},
          {"joints", robot.joints().size()},
          {"shapes", shapes},
          {"root", robot.links()[0].name},
          {"mass", mass},
          {"axes", axes},
          {"groups", groups}};
}

void print_model(const json& info) {
  std::printf("%s: %zu links from %s, %zu joints, %zu axes, %zu shapes, %.2f kg\n",
              info["name"].get<std::string>().c_str(), info["links"].get<std::size_t>(),
              info["root"].get<std::string>().c_str(), info["joints"].get<std::size_t>(),
              info["axes"].size(), info["shapes"].get<std::size_t>(), info["mass"].get<double>());
  std::printf("%-24s %-10s %8s %8s %8s %8s %8s %8s %8s\n", "axis", "kind", "lower", "upper", "rest",
              "v", "a", "j", "effort");
  for (const auto& a : info["axes"]) {
    const json& c = a["limits"]["comfort"];
    std::printf("%-24s %-10s %8.3f %8.3f %8.3f %8.3f %8.3f %8.3f %8.1f\n",
                a["name"].get<std::string>().c_str(), a["kind"].get<std::string>().c_str(),
                a["lower"].get<double>(), a["upper"].get<double>(), a["rest"].get<double>(),
                c[0].get<double>(), c[1].get<double>(), c[2].get<double>(),
                a["effort"].get<double>());
  }
  for (const auto& g : info["groups"])
    std::printf("group %s: %zu axes%s%s\n", g["name"].get<std::string>().c_str(), g["axes"].size(),
                g["tip"] == "" ? "" : ", tip ", g["tip"].get<std::string>().c_str());
}

class ForwardKinematics {
 public:
  explicit ForwardKinematics(RobotModel robot) : robot_(std::move(robot)) {}

  json operator()(const json& line) {
    const json& given = field(line, "q");
    if (!given.is_object()) throw LineError("\"q\" must be an object of joint values");
    Vector q = Vector::Zero(robot_.dof());
    for (const auto& [name, value] : given.items()) {
      const int axis = axis_of(name);
      if (axis < 0) throw LineError("\"" + name + "\" is no joint that can be set");
      q[axis] = number(given, name.c_str());
    }
    robot_.forward(q, poses_);
    json T = json::object();
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      json rows = json::array();
      for (int r = 0; r < 3; ++r)
        rows.push_back({poses_[i](r, 0), poses_[i](r, 1), poses_[i](r, 2), poses_[i](r, 3)});
      T[robot_.links()[i].name] = rows;
    }
    return {{"T", T}};
  }

 private:
  int axis_of(const std::string& name) const {
    for (int i = 0; i < robot_.dof(); ++i)
      if (robot_.axes()[i].name == name) return i;
    return -1;
  }
  RobotModel robot_;
  std::vector<Pose> poses_;
};

}  // namespace

void add_model_commands(CLI::App& app, int& exit_code) {
  struct Options {
    std::string robot;
    bool as_json{}, sweep{};
  };
  const auto options = std::make_shared<Options>();
  CLI::App* model = app.add_subcommand(
      "model",
      "creates, checks and prints robot descriptions and URDFs; computes forward kinematics");
  model->require_subcommand(1);
  add_model_new_command(*model, exit_code);
  const auto add = [&](const char* name, const char* what) {
    CLI::App* command = model->add_subcommand(name, what);
    command
        ->add_option("robot", options->robot, "name of a robot, or file of a description or URDF")
        ->required();
    command->add_flag("--json", options->as_json, "print JSON Lines");
    return command;
  };
  CLI::App* checked = add(
      "check", "prints what is missing in a robot description; exit code 1: something is missing");
  checked->add_flag("--sweep", options->sweep,
                    "also check sampled configurations: pairs of links that always touch, signs of "
                    "mimic joints, the tool frame, limits");
  checked->callback([options, &exit_code] {
    exit_code = check(options->robot, json_wanted(options->as_json), options->sweep);
  });
  add("info", "prints links, axes, limits and groups")->callback([options, &exit_code] {
    const json info = describe(load_any(options->robot, Meshes::load));
    if (json_wanted(options->as_json))
      std::cout << info.dump() << '\n';
    else
      print_model(info);
    exit_code = 0;
  });
  CLI::App* fk =
      add("fk", "computes the poses of all links in the root frame for joint values from stdin");
  fk->footer(
      R"(Input line: {"q": {joint: value}}, 0 for joints not named. Output line: {"T": {link: three
rows of four}})");
  fk->callback([options, &exit_code] {
    exit_code = for_each_line(std::cin, std::cout,
                              ForwardKinematics(load_any(options->robot, Meshes::skip)));
  });
}

}  // namespace handsel
