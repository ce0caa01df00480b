// SPDX-License-Identifier: Apache-2.0
#include "components/manipulation_planner/placing/destination_search.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <numbers>

#include "components/manipulation_planner/parts.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kPassedTurns[] = {0, 0.5 * std::numbers::pi, std::numbers::pi,
                                   -0.5 * std::numbers::pi};  // about the vertical [rad]

/// What a job needs of arm and scene, as values.
struct PlacingJob {
  std::shared_ptr<const RobotModel> robot;
  std::shared_ptr<CollisionWorld> world;
  ObjectLibrary objects;
  Scene scene;
  HumanState people;
  Group arm, fingers;
  PlacingMotion motion;
  double margin;  // preferred
  Vector q;
  PlacingSettings placing;         // with the reach of the arm that is to reach the places well
  std::size_t max_places;          // of a surface that are tried first
  std::size_t max_all_places;      // of a surface that are tried where none of those serves
  std::size_t max_configurations;  // that motions are planned to
};

/// Returns the settings for places that the arm in use is to reach well.
PlacingSettings placing_for(const Parts& parts) {
  PlacingSettings placing = placing_settings(parts.settings);
  placing.reach = arm_reach(parts.arm.robot(), &parts.arm.group(), parts.arm.palm());
  return placing;
}

PlacingJob placing_job(Parts& parts) {
  return {parts.arm.shared_robot(),
          parts.worker.world(parts.arm.robot(), parts.now.objects()),
          parts.now.objects(),
          parts.now.scene(),
          parts.now.people(),
          parts.arm.group(),
          parts.arm.fingers(),
          {.from_above = parts.settings.lift_height},
          parts.settings.place_margin,
          parts.arm.configuration(),
          placing_for(parts),
          parts.settings.surface_places,
          parts.settings.all_surface_places,
          parts.settings.place_goals};
}

/// Searches for places that an arm of this name reaches well, from now on.
void search_for(const Parts& parts, const std::string& arm, PlacingJob& job) {
  for (const Manipulator& m : parts.arm.manipulators())
    if (m.name == arm) job.placing.reach = arm_reach(parts.arm.robot(), m.arm, m.palm);
}

void set_world(const PlacingJob& job) {
  job.world->set_scene(job.scene);
  job.world->set_people(job.people);
  job.world->set_moving_axes({});
}

std::vector<Pose> places_on(const PlacingJob& job, const SceneBox& surface,
                            const std::string& object, const Pose& T_now, std::size_t max_places,
                            const PlacingSettings& placing) {
  const PlacingScene in{*job.robot, job.scene, job.people, job.objects};
  return free_places(in, object, surface, T_now, max_places, placing);
}

/// Returns the best free places of the surface, where there are none with room for the hand beside
/// other things, those without.
std::vector<Pose> best_places_on(const PlacingJob& job, const SceneBox& surface,
                                 const std::string& object, const Pose& T_now,
                                 std::size_t max_places) {
  std::vector<Pose> places = places_on(job, surface, object, T_now, max_places, job.placing);
  PlacingSettings crowded = job.placing;
  crowded.gap = job.placing.min_gap;
  if (places.empty()) places = places_on(job, surface, object, T_now, max_places, crowded);
  return places;
}

/// Returns every free place of the surface; where one was chosen, the object is turned as there and
/// at that height, and the nearest places come first. `gap`: distance to other things [m].
std::vector<Pose> all_places_on(const PlacingJob& job, const SceneBox& surface,
                                const std::string& object, const Pose& T_now,
                                const std::optional<Destination>& chosen, double gap) {
  PlacingSettings every = job.placing;
  every.apart = 0;
  every.gap = gap;
  std::vector<Pose> places = places_on(job, surface, object, T_now, job.max_all_places, every);
  if (!chosen) return places;
  const auto distance = [&](const Pose& T) {
    return (T.translation() - chosen->T_world_object.translation()).norm();
  };
  std::stable_sort(places.begin(), places.end(),
                   [&](const Pose& a, const Pose& b) { return distance(a) < distance(b); });
  for (Pose& T : places) {
    T.linear() = chosen->T_world_object.linear();
    T.translation().z() = chosen->T_world_object.translation().z();
  }
  return places;
}

/// Places of one surface for one object.
struct SurfaceOffer {
  std::string object, surface;
  RestingPlaces places;
};

/// Adds the grasps that serve at these places with a margin for the hand; returns why others do
/// not.
std::string search(const PlacingJob& in, const SurfaceOffer& offer, double margin,
                   const std::vector<Grasp>& grasps, const DestinationLimits& limits,
                   ServingGrasps& found) {
  Putting putting(*in.world, *in.robot, in.arm, in.scene.T_world_base, offer.places,
                  {in.motion.from_above, margin});
  for (std::size_t i = 0; i < grasps.size() && found.at.size() < limits.max_grasps; ++i) {
    if (found.at.count(i) > 0) continue;
    const Grasp& grasp = grasps[i];
    const Vector reached = RobotModel::with(in.q, in.arm, grasp.arm_joints);
    const Vector closed = RobotModel::with(reached, in.fingers, grasp.hand_joints);
    const Vector opened = RobotModel::with(closed, in.fingers, grasp.pregrasp_joints);
    const auto all =
        putting.anywhere(closed, opened, {offer.object, grasp.T_object_hand.inverse()}, 1);
    if (!all.empty())
      found.at[i] = {grasp.id, offer.object, offer.surface, all.front().T_world_object,
                     all.front().arm_at};
  }
  return putting.objections();
}

}  // namespace

Routine<ServingGrasps> find_destinations(Parts& parts, const std::string& object,
                                         const std::string& onto, const std::vector<Grasp>& grasps,
                                         const DestinationLimits& limits) {
  auto found = std::make_shared<ServingGrasps>();
  const SceneObject* thing = parts.now.object(object);
  std::vector<SceneBox> surfaces;
  for (const SceneBox& box : parts.now.scene().boxes)
    if (box.supports && (onto.empty() || box.id == onto)) surfaces.push_back(box);
  if (thing == nullptr || surfaces.empty()) co_return *found;
  const std::function<void()> job = [found, surfaces, object, grasps, limits,
                                     model = parts.now.model_of(object), in = placing_job(parts),
                                     T_now = thing->T_world_object] {
    set_world(in);
    std::vector<std::vector<Pose>> upright;
    upright.reserve(surfaces.size());
    for (const SceneBox& box : surfaces)
      upright.push_back(best_places_on(in, box, object, T_now, limits.max_places));
    for (const double margin : {in.margin, 0.0}) {
      for (std::size_t s = 0; s < surfaces.size(); ++s)
        found->objections =
            search(in, {object, surfaces[s].id, {upright[s]}}, margin, grasps, limits, *found);
      if (!found->at.empty()) return;
    }
    // Held upside down or from below, the object can only be laid on another side.
    for (std::size_t s = 0; s < surfaces.size() && found->at.empty() && model != nullptr; ++s)
      search(in, {object, surfaces[s].id, lying_places(upright[s], *model, in.placing.min_tipping)},
             0.0, grasps, limits, *found);
  };
  found->outcome = co_await parts.worker.run(job);
  co_return *found;
}

Routine<std::vector<Pose>> find_standing_places(Parts& parts, const SceneBox& surface,
                                                const std::string& taker, const std::string& object,
                                                const Pose& T_world_object) {
  PlacingJob placing = placing_job(parts);
  search_for(parts, taker, placing);
  auto found = std::make_shared<std::vector<Pose>>();
  const std::function<void()> job = [found, box = surface, object, in = std::move(placing),
                                     T_now = T_world_object,
                                     max_places = parts.settings.passed_places] {
    for (const Pose& place : best_places_on(in, box, object, T_now, max_places)) {
      for (const double turn : kPassedTurns) {
        Pose T = place;
        T.linear() = Eigen::AngleAxisd(turn, Vector3::UnitZ()) * place.linear();
        found->push_back(T);
      }
    }
  };
  const Outcome worked = co_await parts.worker.run(job);
  co_return worked.good ? *found : std::vector<Pose>{};
}

Routine<FoundPlaces> find_places(Parts& parts, const SceneBox& surface, const Vector& opening,
                                 const std::string& taker) {
  PlacingJob placing = placing_job(parts);
  search_for(parts, taker, placing);
  const Attachment held = parts.held.attachment();
  const auto& grasp = parts.held.grasp();
  const std::optional<Destination> chosen =
      grasp ? parts.destinations.find(grasp->id, held.object, surface.id)
            : std::optional<Destination>();
  auto found = std::make_shared<FoundPlaces>();
  const std::function<void()> job = [found, chosen, opening, held, box = surface,
                                     model = parts.now.model_of(held.object),
                                     in = std::move(placing), T_now = parts.held.T_world_object(),
                                     place_drop = parts.settings.place_drop] {
    set_world(in);
    std::vector<Pose> places = best_places_on(in, box, held.object, T_now, in.max_places);
    if (chosen) places.insert(places.begin(), chosen->T_world_object);
    const std::vector<Pose> coarse = places;
    const Vector opened = RobotModel::with(in.q, in.fingers, opening);
    const auto stand = [&](const std::vector<Pose>& at) {
      Putting upright(*in.world, *in.robot, in.arm, in.scene.T_world_base, {at}, in.motion);
      if (chosen) upright.search_near(chosen->arm_at);
      found->configurations = upright.anywhere(in.q, opened, held, in.max_configurations);
      found->objections = upright.objections();
      return !found->configurations.empty();
    };
    // What has slipped in the hand may fit only beside the chosen place, or a little higher.
    if (stand(places)) return;
    places = all_places_on(in, box, held.object, T_now, chosen, in.placing.gap);
    if (stand(places)) return;
    places = all_places_on(in, box, held.object, T_now, chosen, in.placing.min_gap);
    if (stand(places)) return;
    for (Pose& T : places) T.translation().z() += place_drop;
    if (stand(places)) return;
    // Taken from where the object lay, the hand may be below the object when that stands.
    Putting lying(*in.world, *in.robot, in.arm, in.scene.T_world_base,
                  lying_places(coarse, *model, in.placing.min_tipping), in.motion);
    found->configurations = lying.anywhere(in.q, opened, held, in.max_configurations);
    found->is_lying = !found->configurations.empty();
  };
  found->outcome = co_await parts.worker.run(job);
  co_return *found;
}

}  // namespace handsel::manipulation_planner
