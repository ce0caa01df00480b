// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/commands/grasp/grasp_pair_command.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>

#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "deploy/handsel/cli/above_zero.hpp"
#include "deploy/handsel/cli/finite_options.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/offline/grasp_stage.hpp"
#include "deploy/handsel/pictures/pair_picture.hpp"

namespace handsel {
namespace {

using nlohmann::json;
using namespace grasp_planner;

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// ---- double

struct PairOptions : ListOptions {
  std::string hand2{"sah"}, png;
  std::size_t max_of_each{200}, number{1};
  double clearance{0.005}, opposition{0};
  bool passed{}, spread{};
  int size{480};
};

int pairs(const PairOptions& o) {
  const Listed a = list_with(o.hand, o), b = list_with(o.hand2, o);
  DoubleSettings settings;
  settings.max_of_each = o.max_of_each;
  settings.clearance = o.clearance;
  settings.min_opposition = o.opposition * kDegree;
  settings.taken = o.spread ? Taken::spread : Taken::best;
  settings.p_object_middle = a.object->box().center();
  settings.passed = o.passed ? a.object.get() : nullptr;
  const auto start = Clock::now();
  const DoubleList found = list_double_grasps({a.hand_geometry.get(), &a.list, {}},
                                              {b.hand_geometry.get(), &b.list, {}}, settings);
  const double seconds = since(start);
  const bool table = !json_wanted(o.as_json);
  if (table)
    std::printf("%8s %8s %8s %12s %8s\n", "first", "second", "quality", "opposed[deg]", "score");
  for (const DoubleGrasp& d : found.grasps) {
    const std::uint64_t first = a.list.grasps[d.first].grasp.id,
                        second = b.list.grasps[d.second].grasp.id;
    if (table) {
      std::printf("%8llu %8llu %8.3f %12.0f %8.3f\n", whole(first), whole(second), d.quality,
                  d.opposition / kDegree, d.score);
    } else {
      std::cout << json{{"first", first},
                        {"second", second},
                        {"quality", d.quality},
                        {"opposition", d.opposition},
                        {"score", d.score}}
                       .dump()
                << '\n';
    }
  }
  std::fprintf(stderr, "%zu double grasps of %llu pairs in %.2f s\n", found.grasps.size(),
               whole(found.pairs), seconds);
  print_refusals(found.refusals());
  if (!o.png.empty() && !found.grasps.empty()) {
    if (o.number > found.grasps.size()) {
      throw ConfigError("--number " + std::to_string(o.number) + ": there are " +
                        std::to_string(found.grasps.size()) + " double grasps");
    }
    const DoubleGrasp& d = found.grasps[o.number - 1];
    write(double_grasp_picture(*a.object, *a.hand_geometry, a.list.grasps[d.first].grasp,
                               *b.hand_geometry, b.list.grasps[d.second].grasp, o.size),
          o.png);
  }
  return found.grasps.empty() ? 1 : 0;
}

// ---- transfer

struct TransferOptions : StageOptions {
  TransferOptions() { robot = "jido"; }
  std::string taker{"human_right"};
  std::vector<double> at{0.68, -0.42}, person{1.35, 0.3};
  double stature{1.75}, tilt{0};
  std::uint32_t number{3};
};

void print_transfer(const Grasp& g, const Grasp& h, const TransferPose& t, bool text) {
  const double tilt = std::acos(std::clamp(t.T_world_object.linear()(2, 2), -1.0, 1.0));
  if (text) {
    std::printf("%8llu %8llu %8.3f %8.0f %8.2f %8.0f %8.0f %8.3f\n", whole(g.id), whole(h.id),
                g.quality, t.partner.opposition / kDegree, t.wrist.strain, t.aim / kDegree,
                tilt / kDegree, t.score);
  } else {
    std::cout << json{{"robot_grasp", g.id},
                      {"human_grasp", h.id},
                      {"quality", g.quality},
                      {"opposition", t.partner.opposition},
                      {"wrist",
                       {{"flexion", t.wrist.flexion},
                        {"radial", t.wrist.radial},
                        {"pronation", t.wrist.pronation},
                        {"elevation", t.wrist.elevation},
                        {"strain", t.wrist.strain}}},
                      {"aim", t.aim},
                      {"tilt", tilt},
                      {"T_world_object", pose_line(t.T_world_object)},
                      {"arm_joints", numbers(t.arm_joints)},
                      {"score", t.score}}
                     .dump()
              << '\n';
  }
}

int transfer(const TransferOptions& o) {
  const Stage stage(o);
  const Listed human = list_with(o.taker, o);
  const Listed& robot = stage.lists.front();
  TransferSettings settings;
  settings.max_tilt = o.tilt * kDegree;
  auto start = Clock::now();
  const TransferTable table({robot.hand_geometry.get(), &robot.list, {}},
                            {human.hand_geometry.get(), &human.list, {}}, *robot.object, settings);
  std::fprintf(stderr, "pairs of robot and person: %llu in %.3f s\n", whole(table.doubles().pairs),
               since(start));
  print_refusals(table.doubles().refusals());

  Scene scene = stage.scene;
  scene.objects.push_back(
      {"object", stage.object.name, stage.standing(o.at[0], o.at[1]), Holder::surface, "table", 0});
  const Person person = somebody(o.person[0], o.person[1], o.stature);
  HumanState people;
  people.people.push_back(person);
  GraspRequest request;
  request.object = "object";
  request.for_human = "person";
  request.start = stage.robot->rest_configuration();
  request.max_grasps = o.number;
  settings::GraspPlannerSettings weights;
  weights.rank_transfer = 3;  // the person has priority
  const GraspChooser chooser(stage.robot, robot.hand_geometry, stage.library(), weights);
  start = Clock::now();
  const Choice choice =
      chooser.choose({request, robot.list, *robot.object, scene, people, {}, &table});
  std::fprintf(stderr, "chosen in %.1f ms\n", 1e3 * since(start));
  print_refusals(choice.refusals());

  const bool text = !json_wanted(o.as_json);
  if (text)
    std::printf("%8s %8s %8s %8s %8s %8s %8s %8s\n", "robot", "person", "quality", "opposed",
                "strain", "aim", "tilt", "score");
  bool any = false;
  for (std::size_t i = 0; i < choice.grasps.size(); ++i) {
    if (i >= choice.transfers.size() || !choice.transfers[i]) continue;
    const TransferPose& t = *choice.transfers[i];
    const Grasp &g = choice.grasps[i], &h = human.list.grasps[t.partner.human].grasp;
    print_transfer(g, h, t, text);
    if (!any && !o.png.empty()) {
      const Manipulator& m = stage.arms.front().arm;
      const Vector q = RobotModel::with(RobotModel::with(request.start, *m.arm, t.arm_joints),
                                        *m.fingers, g.hand_joints);
      write(transfer_picture({*stage.robot, q}, scene, {person, *human.hand_geometry, h},
                             *robot.object, t, o.size),
            o.png);
    }
    any = true;
  }
  if (choice.grasps.empty()) std::fprintf(stderr, "%s\n", choice.why_none(robot.list).c_str());
  if (!choice.grasps.empty() && !any)
    std::fprintf(stderr,
                 "it can be picked up, but in no grasp that leaves the person a comfortable one\n");
  return any ? 0 : 1;
}

// ---- regrasp

struct RegraspOptions : StageOptions {
  RegraspOptions() {
    robot = "duo";
    table = {0.65, 0, 0.6, 1.6, 0.75};
  }
  std::vector<double> from{0.5, -0.55}, to{0.5, 0.55};
  int to_arm{-1};
  bool again{};
};

void print_plan(const RegraspPlan& plan, const Stage& stage, bool text) {
  const auto arm = [&](int index) {
    return index < 0 ? std::string() : stage.arms[static_cast<std::size_t>(index)].arm.name;
  };
  const auto id = [&](int index, std::size_t grasp) {
    return stage.arms[static_cast<std::size_t>(index)].list->grasps[grasp].grasp.id;
  };
  if (!text) {
    json steps = json::array(), rejected = json::array();
    for (const grasp_planner::RegraspStep& s : plan.steps) {
      json step{{"step", name(s.kind)},
                {"T_world_object", pose_line(s.T_world_object)},
                {"q", numbers(s.q)}};
      if (s.from >= 0) step["from"] = {{"arm", arm(s.from)}, {"grasp", id(s.from, s.grasp_from)}};
      if (s.to >= 0) step["to"] = {{"arm", arm(s.to)}, {"grasp", id(s.to, s.grasp_to)}};
      steps.push_back(step);
    }
    for (const Refusal& r : plan.rejected)
      rejected.push_back({{"what", r.what}, {"reason", r.reason}});
    std::cout << json{{"solved", plan.solved},
                      {"reason", plan.reason},
                      {"steps", steps},
                      {"rejected", rejected}}
                     .dump()
              << '\n';
    return;
  }
  for (std::size_t n = 0; n < plan.steps.size(); ++n) {
    const grasp_planner::RegraspStep& s = plan.steps[n];
    const Vector3 p = s.T_world_object.translation();
    std::string hands =
        s.from >= 0 ? arm(s.from) + " (grasp " + std::to_string(id(s.from, s.grasp_from)) + ")"
                    : "";
    if (s.to >= 0)
      hands += (hands.empty() ? "" : " to ") + arm(s.to) + " (grasp " +
               std::to_string(id(s.to, s.grasp_to)) + ")";
    std::printf("%zu. %-5s %s, object at %.2f %.2f %.2f\n", n + 1, name(s.kind), hands.c_str(),
                p.x(), p.y(), p.z());
  }
  if (plan.steps.empty())
    std::printf("%s\n", plan.solved ? "nothing has to change" : plan.reason.c_str());
}

int regrasp(const RegraspOptions& o) {
  const Stage stage(o);
  if (o.to_arm >= static_cast<int>(stage.arms.size())) {
    throw ConfigError("--hold-with " + std::to_string(o.to_arm) + ": robot " + stage.robot->name() +
                      " has " + std::to_string(stage.arms.size()) + " arms, counted from 0");
  }
  RegraspPlanner planner(*stage.robot, stage.arms, *stage.lists.front().object, stage.library(),
                         stage.scene, "object");
  RegraspTask task;
  task.start.T_world_object = stage.standing(o.from[0], o.from[1]);
  if (o.to_arm >= 0) {
    task.goal.arm = o.to_arm;
  } else {
    task.goal.T_world_object = stage.standing(o.to[0], o.to[1]);
  }
  if (o.again)
    task.placements = stage.resting(0.5 * (o.from[0] + o.to[0]), 0.5 * (o.from[1] + o.to[1]));
  const auto start = Clock::now();
  const RegraspPlan plan = planner.plan(task);
  std::fprintf(stderr, "%zu steps; %llu double grasps, %llu steps checked in %.2f s\n",
               plan.steps.size(), whole(plan.double_grasps), whole(plan.checked), since(start));
  print_refusals(plan.rejected);
  print_plan(plan, stage, !json_wanted(o.as_json));
  if (!o.png.empty() && !plan.steps.empty())
    write(regrasp_picture(*stage.robot, stage.scene, *stage.lists.front().object, plan, o.size),
          o.png);
  return plan.solved ? 0 : 1;
}

void add_double(CLI::App& grasp, int& exit_code) {
  CLI::App* doubling = grasp.add_subcommand(
      "double", "computes pairs of grasps of two hands that do not collide, best first");
  auto d = std::make_shared<PairOptions>();
  add_list_options(*doubling, *d);
  doubling->add_option("--hand2", d->hand2, "the other hand's description: name or file")
      ->capture_default_str();
  doubling
      ->add_option("--best", d->max_of_each, "number of grasps taken from the list of each hand")
      ->check(kAboveZero)
      ->capture_default_str();
  doubling->add_flag(
      "--spread", d->spread,
      "take the best grasp of each orientation and side in turn instead of the best of all");
  doubling->add_option("--clearance", d->clearance, "min distance between the hands [m]")
      ->check(kNotNegative)
      ->capture_default_str();
  doubling
      ->add_option("--opposed", d->opposition,
                   "min angle between the directions of the two wrists [deg]")
      ->check(CLI::Range(0.0, 180.0));
  doubling->add_flag(
      "--pass", d->passed,
      "only pairs in which either hand can approach and retreat while the other one holds");
  doubling->add_option("--png", d->png, "file for a picture of one pair from three sides");
  doubling->add_option("--number", d->number, "rank of the pair to draw; 1: the best")
      ->check(kAboveZero)
      ->capture_default_str();
  doubling->add_option("--size", d->size, "size of each view of the picture [pixels]")
      ->check(CLI::Range(64, 2000))
      ->capture_default_str();
  doubling->callback([d, &exit_code] { exit_code = pairs(*d); });
}

void add_transfer(CLI::App& grasp, int& exit_code) {
  CLI::App* giving =
      grasp.add_subcommand("transfer",
                           "computes grasps from which a person can take the object comfortably, "
                           "and the pose in which the object is offered");
  auto t = std::make_shared<TransferOptions>();
  add_stage_options(*giving, *t);
  giving->add_option("--taker", t->taker, "description of the person's right hand: name or file")
      ->capture_default_str();
  giving->add_option("--at", t->at, "position of the object on the table, x,y [m]")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  giving->add_option("--person", t->person, "position of the person, facing the robot, x,y [m]")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  giving->add_option("--stature", t->stature, "stature of the person [m]")
      ->check(CLI::Range(0.8, 2.4))
      ->capture_default_str();
  giving->add_option("--tilt", t->tilt, "max tilt of the object [deg]")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  giving->add_option("--number", t->number, "max number of grasps printed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  giving->callback([t, &exit_code] { exit_code = transfer(*t); });
}

void add_regrasp(CLI::App& grasp, int& exit_code) {
  CLI::App* changing =
      grasp.add_subcommand("regrasp",
                           "computes the shortest sequence of picks, passes from hand to hand and "
                           "placements that brings an object to a goal");
  auto r = std::make_shared<RegraspOptions>();
  add_stage_options(*changing, *r);
  changing->add_option("--from", r->from, "position of the object on the table, x,y [m]")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  changing->add_option("--to", r->to, "position of the object on the table at the end, x,y [m]")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  changing->add_option(
      "--hold-with", r->to_arm,
      "instead of --to: number of the arm that holds the object at the end, from 0");
  changing->add_flag("--put-down", r->again,
                     "permit to put the object down in between, in any stable placement");
  changing->callback([r, &exit_code] { exit_code = regrasp(*r); });
}

}  // namespace

void add_grasp_pairs(CLI::App& grasp, int& exit_code) {
  add_double(grasp, exit_code);
  add_transfer(grasp, exit_code);
  add_regrasp(grasp, exit_code);
}

}  // namespace handsel
