// Grasps the planner chooses hold by contact and friction alone: lifted, tilted by 90 degrees, shaken at 2 Hz. What falls is printed.
#include <set>

#include "tests/system/grasp_execution.hpp"

namespace handsel {
namespace {

using namespace grasp_planner;
using namespace test;

struct Case {
  const char* object;
  int least;  // of ten that must hold; so many did when this was written
};

class GraspHolds : public testing::TestWithParam<Case> {};

TEST_P(GraspHolds, ten_grasps_by_contact_alone_through_lift_tilt_and_shake) {
  const std::string model = GetParam().object;
  const auto robot = std::make_shared<const RobotModel>(RobotModel::load(kDeploy / "robots/jido/jido.txtpb"));
  const auto kit = std::make_shared<const HandKit>(HandModel::load(kDeploy / "hands/sah/sah.txtpb"));
  GraspBook book(kit, {}, GraspStore(""));
  const auto page = book.page(*library(model));
  const GraspChooser chooser(robot, kit, library, {});
  sim::SimSettings settings = sim::load_settings(kDeploy / "config");
  settings.constraint = false;
  int tried = 0, held = 0;
  std::set<std::uint64_t> used;
  std::printf("%-8s %4s %6s %8s %8s %8s %9s %8s %8s %6s  %s\n", "object", "yaw", "grasp", "epsilon", "knocked", "lifted", "pressure",
              "slip", "turn", "rtf", "outcome");
  for (const double yaw : {0.0, 2.0, 4.0, 1.0, 3.0, 5.0}) {
    Scene scene;
    scene.robot_known = true;
    scene.robot_position = robot->rest_posture();
    scene.boxes.push_back({"table", make_pose(kTable), kTableSize, true});
    const Vector3 place(0.68, -0.42, 0.72 + library(model)->height_above_support);
    scene.objects.push_back(
        {"it", model, make_pose(place, Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3::UnitZ()))), Holder::surface, "table", 0});
    GraspRequest request;
    request.object = "it";
    request.start = robot->rest_posture();
    request.max_grasps = 6;
    const Choice choice = chooser.choose(request, page->list, *page->object, scene, {});
    for (const Grasp& g : choice.grasps) {
      if (tried == 10 || !used.insert(g.id).second) continue;
      const Outcome o = Execution(*robot, model, place.x(), place.y(), yaw, g, settings).run(Handling::lift_tilt_shake);
      ++tried;
      held += o.held();
      std::printf("%-8s %4.0f %6llu %8.3f %5.1f mm %6.3f m %7.1f N %5.1f mm %4.1f deg %6.1f  %s %.2f\n", model.c_str(), yaw,
                  static_cast<unsigned long long>(g.id), g.epsilon, 1e3 * o.knocked, o.lifted, o.pressure, 1e3 * o.slip,
                  o.turn * 180 / M_PI, o.real_time, o.held() ? "held" : ("lost: " + o.lost).c_str(), o.constraint);
    }
  }
  std::printf("%s: %d of %d held\n", model.c_str(), held, tried);
  EXPECT_EQ(tried, 10);
  EXPECT_GE(held, GetParam().least);
}

INSTANTIATE_TEST_SUITE_P(Objects, GraspHolds, testing::Values(Case{"mug", 3}, Case{"bottle", 1}, Case{"box", 2}),
                         [](const auto& c) { return std::string(c.param.object); });

}  // namespace
}  // namespace handsel
