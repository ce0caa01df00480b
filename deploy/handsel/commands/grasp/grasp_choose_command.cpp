// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <iostream>

#include "common/collision/platform_places.hpp"
#include "common/model/platform.hpp"
#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/grasp/grasp_pair_command.hpp"
#include "deploy/handsel/offline/grasp_stage.hpp"
#include "deploy/handsel/pictures/pair_picture.hpp"

namespace handsel {
namespace {

using nlohmann::json;
using namespace grasp_planner;

struct ChooseOptions : StageOptions {
  ChooseOptions() { robot = "jido"; }
  std::vector<double> at{0.68, -0.42}, goal, person, obstacles;
  double stature{1.75}, min_visible{0};
  std::uint32_t number{5};
  bool move_platform{};
};

json line_of(const Choice& choice, std::size_t i) {
  const Grasp& g = choice.grasps[i];
  json line{{"id", g.id},
            {"quality", g.quality},
            {"visible", g.visible},
            {"T_object_hand", pose_line(g.T_object_hand)},
            {"arm_joints", numbers(g.arm_joints)},
            {"approach_joints", numbers(g.approach_joints)},
            {"hand_joints", numbers(g.hand_joints)},
            {"pregrasp_joints", numbers(g.pregrasp_joints)}};
  if (g.has_platform) line["platform"] = {g.platform.x(), g.platform.y(), g.platform.z()};
  if (i < choice.goals.size()) {
    const PuttingDown& down = choice.goals[i];
    line["goal"] = {
        {"above", numbers(down.above)}, {"at", numbers(down.at)}, {"off", numbers(down.off)}};
  }
  return line;
}

/// Draws the robot at the grasp and, if there is a goal, at the placement of the object.
Picture picture_of(const Stage& stage, const Scene& scene, const GraspRequest& request,
                   const Choice& choice, int size) {
  const Grasp& g = choice.grasps.front();
  const Manipulator& m = stage.arms.front().arm;
  Scene there = scene;
  if (g.has_platform) there.T_world_base = standing_at({g.platform, 0}, scene.T_world_base);
  const auto with = [&](const Vector& arm_q) {
    return RobotModel::with(RobotModel::with(request.start, *m.arm, arm_q), *m.fingers,
                            g.hand_joints);
  };
  RegraspPlan plan;
  plan.steps.resize(choice.goals.empty() ? 1 : 2);
  plan.steps[0].T_world_object = scene.objects.front().T_world_object;
  plan.steps[0].q = with(g.arm_joints);
  if (!choice.goals.empty()) {
    plan.steps[1].T_world_object = request.T_world_goal;
    plan.steps[1].q = with(choice.goals.front().at);
  }
  return regrasp_picture(*stage.robot, there, *stage.lists.front().object, plan, size);
}

int choose(const ChooseOptions& o) {
  const Stage stage(o);
  const Listed& robot = stage.lists.front();
  Scene scene = stage.scene;
  scene.objects.push_back(
      {"object", stage.object.name, stage.standing(o.at[0], o.at[1]), Holder::surface, "table", 0});
  if (o.obstacles.size() % 6 != 0)
    throw ConfigError("--obstacle: six numbers each, the middle x,y,z and the size x,y,z [m]");
  for (std::size_t i = 0; i < o.obstacles.size(); i += 6) {
    const double* b = &o.obstacles[i];
    scene.boxes.push_back({"obstacle " + std::to_string(i / 6 + 1),
                           make_pose({b[0], b[1], b[2]}),
                           {b[3], b[4], b[5]},
                           false});
  }
  HumanState people;
  GraspRequest request;
  request.object = "object";
  request.start = stage.robot->rest_configuration();
  request.max_grasps = o.number;
  request.min_visible = o.min_visible;
  request.move_platform = o.move_platform;
  if (!o.person.empty()) {
    people.people.push_back(somebody(o.person[0], o.person[1], o.stature));
    request.for_human = "person";
  }
  if (!o.goal.empty()) {
    request.has_goal = true;
    request.T_world_goal =
        stage.standing(o.goal[0], o.goal[1], o.goal.size() > 2 ? o.goal[2] * kDegree : 0.0);
  }
  auto mobile = o.move_platform ? on_platform(*stage.robot, stage.file) : std::nullopt;
  const GraspChooser chooser(
      stage.robot, robot.hand_geometry, stage.library(), {}, "arm",
      mobile ? std::make_shared<const RobotModel>(std::move(*mobile)) : nullptr);
  const auto begin = std::chrono::steady_clock::now();
  const Choice choice = chooser.choose({request, robot.list, *robot.object, scene, people});
  const double ms =
      1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::fprintf(stderr, "%zu grasps chosen in %.1f ms, %llu inverse kinematics\n",
               choice.grasps.size(), ms, whole(choice.reaches));
  print_refusals(choice.refusals());
  if (choice.grasps.empty()) std::fprintf(stderr, "%s\n", choice.why_none(robot.list).c_str());

  const bool text = !json_wanted(o.as_json);
  if (text && !choice.grasps.empty())
    std::printf("%8s %8s %8s %8s  %s\n", "id", "quality", "margin", "visible",
                "platform x, y, heading");
  for (std::size_t i = 0; i < choice.grasps.size(); ++i) {
    const Grasp& g = choice.grasps[i];
    if (!text) {
      std::cout << line_of(choice, i).dump() << '\n';
      continue;
    }
    std::printf("%8llu %8.3f %8.2f %8.2f  ", whole(g.id), g.quality, g.margin, g.visible);
    if (g.has_platform) {
      std::printf("%.2f %.2f m, %.0f deg\n", g.platform.x(), g.platform.y(),
                  g.platform.z() / kDegree);
    } else {
      std::printf("stays\n");
    }
  }
  if (!o.png.empty() && !choice.grasps.empty())
    write(picture_of(stage, scene, request, choice, o.size), o.png);
  return choice.grasps.empty() ? 1 : 0;
}

}  // namespace

void add_grasp_choose(CLI::App& grasp, int& exit_code) {
  CLI::App* choosing =
      grasp.add_subcommand("choose",
                           "chooses the grasps that a robot in front of a table can use, best "
                           "first; prints why the others are rejected");
  auto o = std::make_shared<ChooseOptions>();
  add_stage_options(*choosing, *o);
  choosing->add_option("--at", o->at, "position of the object on the table, x,y [m]")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  choosing
      ->add_option("--goal", o->goal,
                   "position x,y [m], and optionally heading [deg], where the object will be put "
                   "on the table; the grasp must be usable there too")
      ->delimiter(',')
      ->expected(2, 3);
  choosing
      ->add_option(
          "--person", o->person,
          "position x,y [m] of a person, facing the robot, to whom the object will be given")
      ->delimiter(',')
      ->expected(2);
  choosing->add_option("--stature", o->stature, "stature of the person [m]")
      ->check(CLI::Range(0.8, 2.4))
      ->capture_default_str();
  choosing
      ->add_option("--min-visible", o->min_visible,
                   "min fraction of the object that is visible past the hand, to the person or "
                   "else to the robot's head")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  choosing->add_flag("--move-platform", o->move_platform,
                     "if no grasp is in reach, search for places of the platform");
  choosing
      ->add_option("--obstacle", o->obstacles,
                   "box: centre x,y,z and size x,y,z [m]; may be repeated")
      ->delimiter(',');
  choosing->add_option("--number", o->number, "max number of grasps printed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  choosing->callback([o, &exit_code] { exit_code = choose(*o); });
}

}  // namespace handsel
