// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/placing/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/placement.hpp"
#include "common/model/human/human_body.hpp"
#include "common/model/object_extent.hpp"

namespace handsel::manipulation_planner {

namespace {

constexpr double kUpright = 0.9998;  // cosine of the tilt up to which an object stands upright
// Of the object from how the arm would turn it by itself [half turns].
constexpr double kTurns[] = {0,     0.25,   -0.25, 0.5,    -0.5, 1,     0.125, -0.125,
                             0.375, -0.375, 0.625, -0.625, 0.75, -0.75, 0.875, -0.875};

/// Of the circle about its frame's vertical axis that it stands inside [m].
double footprint(const ObjectModel* model, const Primitive& primitive) {
  const Eigen::AlignedBox3d extent = object_extent(model, primitive);
  if (extent.isEmpty()) return 0.1;
  return extent.min().cwiseAbs().cwiseMax(extent.max().cwiseAbs()).head<2>().norm();
}

}  // namespace

PlacingSettings placing_settings(const settings::ManipulationPlannerSettings& s) {
  return {s.place_gap,  s.place_min_gap, s.place_max_gap, s.place_far_person,  s.place_edge,
          s.place_grid, s.place_apart,   s.place_reach,   s.place_min_tipping, {}};
}

std::vector<Pose> free_places(const PlacingScene& in, const std::string& object,
                              const SceneBox& surface, const Pose& T_world_object,
                              std::size_t max_places, const PlacingSettings& settings) {
  const auto& [robot, scene, people, library] = in;
  const auto thing = std::find_if(scene.objects.begin(), scene.objects.end(),
                                  [&](const SceneObject& o) { return o.id == object; });
  const ObjectModel* model = thing == scene.objects.end() ? nullptr : library(thing->model);
  const ArmReach reach = settings.reach ? *settings.reach : arm_reach(robot);
  if (model == nullptr || reach.shoulder < 0) return {};
  const double radius = footprint(model, {});
  const Vector& q = scene.robot_position.size() == robot.dof() ? scene.robot_position
                                                               : robot.rest_configuration();
  const Vector3 p_shoulder =
      (scene.T_world_base * robot.link_pose(q, reach.shoulder)).translation();
  const double top = surface.size.z() / 2;
  const auto bearing = [&](const Vector3& p) {
    return std::atan2(p.y() - p_shoulder.y(), p.x() - p_shoulder.x());
  };

  struct Place {
    Pose T_world_object;
    double cost;
  };
  std::vector<Place> places;
  const Vector3 room = surface.size / 2 - Vector3::Constant(settings.edge + std::min(radius, 0.06));
  const int nx = static_cast<int>(std::floor(room.x() / settings.grid)),
            ny = static_cast<int>(std::floor(room.y() / settings.grid));
  for (int ix = -nx; ix <= nx && room.x() >= 0; ++ix) {
    for (int iy = -ny; iy <= ny && room.y() >= 0; ++iy) {
      const Vector3 p =
          surface.T_world_box * Vector3(ix * settings.grid, iy * settings.grid,
                                        top + model->height_above_support + kAbovePlace);
      double nearest = settings.max_gap, person = settings.far_person;
      bool taken = false;
      for (const SceneObject& other : scene.objects) {
        if (other.id == object || std::abs(other.T_world_object.translation().z() - p.z()) > 0.5)
          continue;
        const double gap = (other.T_world_object.translation() - p).head<2>().norm() - radius -
                           footprint(library(other.model), other.primitive);
        taken = taken || gap < settings.gap;
        nearest = std::min(nearest, gap);
      }
      for (const SceneBox& box : scene.boxes) {
        const Vector3 beyond = (box.T_world_box.inverse() * p).cwiseAbs() - box.size / 2;
        taken = taken || (box.id != surface.id && beyond.maxCoeff() < radius);
      }
      for (const Person& who : people.people)
        person = std::min(
            person, (who.joints[static_cast<std::size_t>(body_joint_index("torso"))].position - p)
                        .head<2>()
                        .norm());
      const double away = (p - p_shoulder).norm() / reach.length;
      if (taken || away > 1) continue;
      const double turn = bearing(p) - bearing(T_world_object.translation());
      places.push_back(
          {make_pose(
               p,
               Eigen::Quaterniond(Eigen::AngleAxisd(
                   std::atan2(T_world_object.linear()(1, 0), T_world_object.linear()(0, 0)) + turn,
                   Vector3::UnitZ()))),
           std::abs(away - settings.best_reach) + (settings.max_gap - nearest) +
               0.5 * (settings.far_person - person)});
    }
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.cost < b.cost; });
  std::vector<Pose> out;
  for (const Place& place : places) {
    if (out.size() >= max_places) break;
    const bool beside = std::any_of(out.begin(), out.end(), [&](const Pose& T) {
      return (T.translation() - place.T_world_object.translation()).norm() < settings.apart;
    });
    if (!beside) out.push_back(place.T_world_object);
  }
  return out;
}

RestingPlaces lying_places(const std::vector<Pose>& upright_places, const ObjectModel& model,
                           double min_tipping) {
  RestingPlaces out{{}, model.com};
  for (const Placement& side : stable_placements(model.mesh, model.com, min_tipping)) {
    if ((side.T_support_object.linear() * Vector3::UnitZ()).z() > kUpright) continue;
    for (const Pose& upright : upright_places) {
      Pose T_world_support = upright;
      T_world_support.translation().z() -= model.height_above_support;
      out.T_world_object.push_back(T_world_support * side.T_support_object);
    }
  }
  return out;
}

Putting::Putting(CollisionWorld& world, const RobotModel& robot, const Group& arm,
                 const Pose& T_world_base, RestingPlaces places, const PlacingMotion& motion)
    : world_(world),
      robot_(robot),
      arm_(arm),
      T_base_world_(T_world_base.inverse()),
      places_(std::move(places)),
      motion_(motion),
      seeds_{RobotModel::part(robot.rest_configuration(), arm)} {}

/// Returns configurations near `q_seed` that reach the place, whether they are free or not.
std::optional<PlacingConfiguration> Putting::reach(const Pose& T_world_object, const Vector& q_seed,
                                                   const Attachment& held) {
  IkOptions options;
  options.restarts = 0;
  const Pose T_object_tool = held.T_tool_object.inverse();
  const auto at =
      robot_.inverse(arm_, T_base_world_ * T_world_object * T_object_tool, q_seed, options);
  Pose T_above = T_world_object;
  T_above.translation().z() += motion_.from_above;
  const auto above = at ? robot_.inverse(arm_, T_base_world_ * T_above * T_object_tool,
                                         RobotModel::with(q_seed, arm_, *at), options)
                        : std::optional<Vector>();
  if (above) return PlacingConfiguration{T_world_object, *above, *at, false};
  ++objections_["out of reach"];
  return std::nullopt;
}

/// Returns whether nothing touches on the straight path of the joints down; counts what does.
bool Putting::is_free(const Vector& q, const PlacingConfiguration& down) {
  const CollisionVerdict verdict = world_.check_motion(RobotModel::with(q, arm_, down.arm_above),
                                                       RobotModel::with(q, arm_, down.arm_at));
  if (!verdict.free) ++objections_["because " + verdict.first + " would touch " + verdict.second];
  return verdict.free;
}

/// Returns whether the hand can also be lower at the place, by the margin.
bool Putting::has_margin(const Vector& q, const PlacingConfiguration& down,
                         const Attachment& held) {
  if (motion_.margin <= 0) return true;
  Attachment lower = held;
  const Vector3 up = down.T_world_object.linear().transpose() * Vector3::UnitZ();
  lower.T_tool_object.translate(Vector3(motion_.margin * up));
  const auto at = reach(down.T_world_object, RobotModel::with(q, arm_, down.arm_at), lower);
  if (!at) return false;
  world_.set_attachment(lower, {held.object});
  const bool free = is_free(q, *at);
  world_.set_attachment(held, {held.object});
  return free;
}

std::optional<PlacingConfiguration> Putting::at(const Pose& place, const Vector& q,
                                                const Vector& opened, const Attachment& held) {
  std::optional<PlacingConfiguration> closed_only;
  world_.set_attachment(held, {held.object});
  for (const double turn : kTurns) {
    Pose T = place;
    T.linear() = Eigen::AngleAxisd(turn * std::numbers::pi, Vector3::UnitZ()) * place.linear();
    T.translation() += (place.linear() - T.linear()) * places_.p_object_turn;
    for (std::size_t seed = 0; seed <= seeds_.size(); ++seed) {
      const Vector q_seed = seed == 0 ? q : RobotModel::with(q, arm_, seeds_[seed - 1]);
      auto found = reach(T, q_seed, held);
      if (!found || !is_free(q, *found) || !has_margin(q, *found, held)) continue;
      found->opens = world_.check(RobotModel::with(opened, arm_, found->arm_at)).free;
      if (found->opens) return found;
      if (!closed_only) closed_only = std::move(found);
    }
  }
  return closed_only;
}

std::vector<PlacingConfiguration> Putting::anywhere(const Vector& q, const Vector& opened,
                                                    const Attachment& held, std::size_t max_count) {
  std::vector<PlacingConfiguration> out, closed_only;
  for (const Pose& place : places_.T_world_object) {
    if (out.size() >= max_count) break;
    if (auto posture = at(place, q, opened, held))
      (posture->opens ? out : closed_only).push_back(std::move(*posture));
  }
  for (PlacingConfiguration& posture : closed_only)
    if (out.size() < max_count) out.push_back(std::move(posture));
  return out;
}

std::string Putting::objections() const {
  if (places_.T_world_object.empty()) return "all of it is taken or too far away";
  constexpr std::size_t kMaxReasons = 3;
  std::vector<std::pair<std::string, int>> often(objections_.begin(), objections_.end());
  std::stable_sort(often.begin(), often.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  for (std::size_t i = 0; i < std::min(often.size(), kMaxReasons); ++i)
    text += (i > 0 ? ", " : "") + std::to_string(often[i].second) + " " + often[i].first;
  return text + (often.size() > kMaxReasons ? ", ..." : "");
}

}  // namespace handsel::manipulation_planner
