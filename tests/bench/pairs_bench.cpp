// SPDX-License-Identifier: Apache-2.0
// Times of double grasps of two lists of 200, and of the choice of a grasp for a person from cached
// lists. Medians and minima of repeated runs; there is no peer to compare with. Usage: bench_pairs
// [rounds]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "common/model/human/human_body.hpp"
#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "tests/support/duo_stage.hpp"

namespace handsel::grasp_planner {
namespace {

void row(const char* what, const std::string& object, int rounds, double limit_ms,
         const std::function<std::size_t()>& work) {
  std::vector<double> ms;
  std::size_t count = 0;
  for (int k = 0; k < rounds; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    count = work();
    ms.push_back(1e3 *
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  std::sort(ms.begin(), ms.end());
  std::printf("%-40s %-8s median %8.1f ms, least %8.1f ms, at most %6.0f ms allowed (%zu found)\n",
              what, object.c_str(), ms[ms.size() / 2], ms.front(), limit_ms, count);
}

int run(int rounds) {
  const auto robot = std::make_shared<const RobotModel>(
      RobotModel::load(deploy_folder() / "robots/jido/jido.txtpb"));
  const GraspChooser chooser(robot, hand_kit("sah"),
                             [](const std::string& name) { return object_model(name); }, {});
  HumanState people;
  Person anna;
  anna.id = "anna";
  anna.joints = standing_body({1.35, 0.3, 0}, std::atan2(-0.3, -1.35), 1.75);
  people.people.push_back(anna);
  GraspRequest request;
  request.object = "thing";
  request.for_human = "anna";
  request.start = robot->rest_configuration();
  request.max_grasps = 1;
  for (const char* object : {"mug", "bottle", "box", "can", "ball"}) {
    const HandOnObject &right = hand_on_object("sah", object, 60, 144),
                       &left = hand_on_object("sah_left", object, 60, 144),
                       &human = hand_on_object("human_right", object);
    const HandSide a{right.hand_geometry.get(), &right.list},
        b{left.hand_geometry.get(), &left.list}, h{human.hand_geometry.get(), &human.list};
    DoubleSettings settings;
    settings.clearance = 0.004;
    row("double grasps, the 200 best of each", object, rounds, 1000,
        [&] { return list_double_grasps(a, b, settings).grasps.size(); });
    settings.taken = Taken::spread;
    settings.p_object_middle = right.object->box().center();
    settings.passed = right.object.get();
    row("to pass on, 200 spread over all sides", object, rounds, 1000,
        [&] { return list_double_grasps(a, b, settings).grasps.size(); });
    const TransferTable table(a, h, *right.object);
    Scene scene;
    scene.robot_known = true;
    scene.robot_position = robot->rest_configuration();
    scene.boxes.push_back({"table", make_pose({0.85, -0.62, 0.36}), {0.7, 0.7, 0.72}, true});
    scene.objects.push_back(
        {"thing", object,
         make_pose({0.68, -0.42, 0.72 + object_model(object)->height_above_support}),
         Holder::surface, "table", 0});
    row("grasp for a person, lists cached", object, rounds, 20, [&] {
      return chooser.choose({request, right.list, *right.object, scene, people, {}, &table})
          .grasps.size();
    });
  }
  return 0;
}

}  // namespace
}  // namespace handsel::grasp_planner

int main(int argc, char** argv) {
  return handsel::grasp_planner::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 9);
}
