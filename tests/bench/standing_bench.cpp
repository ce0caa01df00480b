// SPDX-License-Identifier: Apache-2.0
// Search of the platform places from which the arm hands a mug to a person in a furnished room, as
// in the action drive, and the part spent on the check that the handover is reachable. One process;
// thread time. Usage: bench_standing [rooms]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "common/config/located.hpp"
#include "common/config/resources.hpp"
#include "common/cost/cost_settings.hpp"
#include "common/cost/person_frame.hpp"
#include "common/model/object_model.hpp"
#include "common/model/platform.hpp"
#include "components/manipulation_planner/driving/handover_place.hpp"
#include "components/manipulation_planner/driving/standing_search.hpp"
#include "tests/support/person_grasps.hpp"
#include "tests/support/processes/thread_times.hpp"

namespace handsel::manipulation_planner {
namespace {

using test::seconds;
using test::Times;

constexpr unsigned kSeed = 37;

int run(int rooms) {
  const RobotModel robot = RobotModel::load(robot_description("jido_mobile"));
  const Group& arm = robot.require_group("arm");
  const ObjectModel mug = ObjectModel::load(object_description("mug"));
  const auto settings =
      settings::read_manipulation_planner_settings(resource("config/manipulation_planner.txtpb"));
  const CostSettings weights = load_cost_settings(resource("config"));
  const ObjectLibrary objects = [&mug](const std::string& name) {
    return name == "mug" ? &mug : nullptr;
  };
  std::mt19937_64 random(kSeed);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  Attachment attachment;
  attachment.object = "mug";
  attachment.T_tool_object = make_pose({0.08, 0.02, 0.23});
  Times search, in_checks;
  int found = 0;
  std::size_t checks = 0;
  for (int i = 0; i < rooms; ++i) {
    Scene scene;
    scene.robot_known = true;
    scene.boxes = {
        {"table", make_pose({between(1.5, 3.5), between(1.2, 2.0), 0.36}), {1.2, 0.7, 0.72}, true},
        {"sideboard",
         make_pose({between(1.5, 3.5), between(-2.0, -1.2), 0.45}),
         {0.9, 0.4, 0.9},
         true}};
    const Vector q = with_platform_at(robot, robot.rest_configuration(),
                                      {0, between(-0.5, 0.5), between(-M_PI, M_PI)});
    scene.robot_position = q;
    scene.objects.push_back({"mug", "mug", Pose::Identity(), Holder::robot, "", 0});
    Person anna;
    anna.id = "anna";
    anna.joints = standing_body({between(2, 4), between(-0.8, 0.8), 0}, between(-M_PI, M_PI), 1.75);
    HumanState people;
    people.people = {anna};
    const HandoverNeeds needs{anna,
                              q,
                              {},
                              arm.tip,
                              attachment.T_tool_object,
                              {},
                              test::grasps_of_both_hands(),
                              Vector3(-Vector3::UnitZ())};
    StandingTarget target;
    for (const Side side : {Side::right, Side::left})
      target.points.push_back(comfortable_reach(anna, side));
    target.front = torso_axes(anna).col(0).cwiseProduct(Vector3(1, 1, 0)).stableNormalized();
    double checking = 0;
    StandingSearch result;
    search.add(seconds([&] {
      PlatformFloor floor(robot, objects, scene, people,
                          {settings.standing_room, settings.furniture_room});
      floor.carry(attachment);
      NavigationCost navigation(robot, weights);
      navigation.set_people(people, scene.T_world_base);
      result = find_standing_places(
          {robot, arm, q, scene.T_world_base, navigation}, target, floor, settings,
          [&](const StandingPlace& place) {
            bool can = false;
            ++checks;
            checking += seconds(
                [&] { can = can_hand_over_from(place.place, needs, robot, arm, scene, settings); });
            return can;
          });
    }));
    in_checks.add(checking);
    found += !result.places.empty();
  }
  std::printf("%d rooms, places found in %d; %.1f checks each\n", rooms, found,
              static_cast<double>(checks) / rooms);
  search.print("search of places");
  in_checks.print("  in checks of handovers");
  return 0;
}

}  // namespace
}  // namespace handsel::manipulation_planner

int main(int argc, char** argv) {
  return handsel::manipulation_planner::run(argc > 1 ? std::atoi(argv[1]) : 40);
}
