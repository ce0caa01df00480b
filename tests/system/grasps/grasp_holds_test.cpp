// SPDX-License-Identifier: Apache-2.0
// Grasps of the planner hold by contact and friction alone: lifted, tilted by 90 degrees, shaken at
// 2 Hz. Prints the failures.
#include <cstdlib>
#include <set>
#include <sstream>

#include "components/grasp_planner/load.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/system/grasps/grasp_execution.hpp"

namespace handsel::grasp_holds_test {
namespace {

using namespace grasp_planner;
using namespace test;

/// The planner's ranked grasps of an object on the table, as many yaws as it takes.
class Grasping : public testing::Test {
 protected:
  /// Calls `each` with up to `count` grasps and the object's pose.
  template <class Each>
  void grasps(const std::string& model, int count, Each&& each) {
    const auto page = book_.page(*library(model));
    const GraspChooser chooser(robot_, kit_, library, {});
    std::set<std::uint64_t> used;
    for (const double yaw : {0.0, 2.0, 4.0, 1.0, 3.0, 5.0}) {
      Scene scene;
      scene.robot_known = true;
      scene.robot_position = robot_->rest_configuration();
      scene.boxes.push_back({"table", make_pose(kTable), kTableSize, true});
      const Vector3 place(0.68, -0.42, 0.72 + library(model)->height_above_support);
      scene.objects.push_back(
          {"it", model,
           make_pose(place, Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3::UnitZ()))),
           Holder::surface, "table", 0});
      GraspRequest request;
      request.object = "it";
      request.start = robot_->rest_configuration();
      request.max_grasps = 6;
      for (const Grasp& g :
           chooser.choose({request, page->list, *page->object, scene, {}}).grasps) {
        if (static_cast<int>(used.size()) < count && used.insert(g.id).second) each(g, place, yaw);
      }
    }
  }

  /// The first `count` of them lifted, tilted and shaken; the table goes to the output. How many
  /// were tried and held.
  std::pair<int, int> handle(const std::string& model, int count) {
    int tried = 0, held = 0;
    settings_.constraint = false;
    std::printf("%-14s %4s %6s %8s %8s %8s %8s %9s %8s %8s %6s  %s\n", "object", "yaw", "grasp",
                "epsilon", "margin", "knocked", "lifted", "pressure", "slip", "turn", "rtf",
                "outcome");
    grasps(model, count, [&](const Grasp& g, const Vector3& place, double yaw) {
      const HoldOutcome o = Execution(*robot_, model, place.x(), place.y(), yaw, g, settings_)
                                .run(Handling::lift_tilt_shake);
      ++tried;
      held += o.held();
      EXPECT_EQ(o.constraint, 0.0);
      std::printf(
          "%-14s %4.0f %6llu %8.3f %6.2f N %5.1f mm %6.3f m %7.1f N %5.1f mm %4.1f deg %6.1f  %s\n",
          model.c_str(), yaw, static_cast<unsigned long long>(g.id), g.epsilon, g.margin,
          1e3 * o.knocked, o.lifted, o.pressure, 1e3 * o.slip, o.turn * 180 / M_PI, o.real_time,
          o.held() ? "held" : ("lost: " + o.lost).c_str());
    });
    std::printf("%s: %d of %d held\n", model.c_str(), held, tried);
    return {tried, held};
  }

  sim::SimSettings settings_ = sim::load_settings(kDeploy / "config");
  std::shared_ptr<const RobotModel> robot_ =
      std::make_shared<const RobotModel>(RobotModel::load(kDeploy / "robots/jido/jido.txtpb"));
  std::shared_ptr<const HandGeometry> kit_ =
      std::make_shared<const HandGeometry>(HandModel::load(kDeploy / "hands/sah/sah.txtpb"));
  GraspCache book_{kit_, list_settings(grasp_planner::load_settings(kDeploy / "config"), 1),
                   GraspStore("")};
};

struct Case {
  const char* object;
  int min_held;  // min number of the ten grasps that hold
};

class GraspHolds : public Grasping, public testing::WithParamInterface<Case> {};

TEST_P(GraspHolds, ten_grasps_by_contact_alone_through_lift_tilt_and_shake) {
  const auto [tried, held] = handle(GetParam().object, 10);
  EXPECT_EQ(tried, 10);
  EXPECT_GE(held, GetParam().min_held);
}

INSTANTIATE_TEST_SUITE_P(Objects, GraspHolds,
                         testing::Values(Case{"mug", 9}, Case{"bottle", 9}, Case{"box", 9}),
                         [](const auto& c) { return std::string(c.param.object); });

struct Foreign {
  const char* name;
  double mass;   // measured mass [kg]
  int min_held;  // min number of the five grasps that hold
};

/// Third-party objects, described by mesh, convex hull and measured mass alone.
class ForeignHolds : public Grasping, public testing::WithParamInterface<Foreign> {};

TEST_P(ForeignHolds, five_grasps_by_contact_alone_through_lift_tilt_and_shake) {
  const auto folder = test::reference_data("objects/ycb");
  if (!folder) GTEST_SKIP() << "HANDSEL_DATA is not set";
  const Foreign& foreign = GetParam();
  const std::string mesh = (*folder / foreign.name).string();
  const TemporaryFolder own;
  std::ostringstream text;
  text << "name: \"" << foreign.name << "\"\nmesh: \"" << mesh << ".obj\"\nparts { convex_mesh: \""
       << mesh << "_vhacd.obj\" }\nmass: " << foreign.mass << "\n";
  ObjectModel model = ObjectModel::load(own.write("it.txtpb", text.str()));
  Eigen::AlignedBox3d box;
  for (const Vector3& v : model.mesh.vertices) box.extend(v);
  model.com = box.center();  // the origin of these meshes is not the mass centre
  models()[foreign.name] = std::move(model);
  const auto [tried, held] = handle(foreign.name, 5);
  EXPECT_EQ(tried, 5);
  EXPECT_GE(held, foreign.min_held);
}

INSTANTIATE_TEST_SUITE_P(Objects, ForeignHolds,
                         testing::Values(Foreign{"TomatoSoupCan", 0.349, 4},
                                         Foreign{"FoamBrick", 0.028, 4},
                                         Foreign{"CrackerBox", 0.411, 4},
                                         Foreign{"MustardBottle", 0.603, 4}),
                         [](const auto& c) { return std::string(c.param.name); });

class Constraint : public Grasping {};

TEST_F(Constraint, lifting_works_with_it_and_without_and_the_truth_says_which_of_them_carried) {
  grasps("box", 1, [&](const Grasp& g, const Vector3& place, double yaw) {
    settings_.constraint = true;
    const HoldOutcome helped =
        Execution(*robot_, "box", place.x(), place.y(), yaw, g, settings_).run();
    settings_.constraint = false;
    const HoldOutcome alone =
        Execution(*robot_, "box", place.x(), place.y(), yaw, g, settings_).run();
    std::printf("with the constraint: %s, it carried %.0f %% of the time; without: %s\n",
                helped.hold.c_str(), 100 * helped.constraint, alone.hold.c_str());
    for (const HoldOutcome& o : {helped, alone}) {
      EXPECT_EQ(o.lost, "");
      EXPECT_GT(o.lifted, 0.1);
    }
    EXPECT_EQ(helped.hold, "constraint")
        << "its spring is stiffer than the fingers, so it takes the load first";
    EXPECT_GT(helped.constraint, 0.3);
    EXPECT_EQ(alone.hold, "contact");
    EXPECT_EQ(alone.constraint, 0.0);
  });
}

}  // namespace
}  // namespace handsel::grasp_holds_test
