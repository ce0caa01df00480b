// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/environment/observation.hpp"

#include <cmath>

#include "common/messages/names.hpp"
#include "deploy/handsel/cli/json_lines.hpp"

namespace handsel::environment {
namespace {

using Json = nlohmann::json;

constexpr double kFar = 1e8;  // larger distances mean that there is nobody [m]

Json point_json(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

Json finite(double value) {
  return std::isfinite(value) && std::abs(value) < kFar ? Json(value) : Json(nullptr);
}

const char* name_of(MotionState state) {
  static constexpr const char* kNames[] = {"idle", "running", "finished", "refused", "stopped"};
  return kNames[static_cast<std::size_t>(state)];
}

Json robot_json(const View& view, const RobotModel& robot) {
  const ActiveTrajectory& active = view.active();
  Json out{{"name", robot.name()},
           {"position", list_json(active.position)},
           {"velocity", list_json(active.velocity)},
           {"measured", list_json(view.scene().robot_position)},
           {"base", pose_json(active.T_world_base)}};
  if (robot.tool_link() >= 0 && active.position.size() == robot.dof())
    out["tool"] =
        pose_json(active.T_world_base * robot.link_pose(active.position, robot.tool_link()));
  return out;
}

Json motion_json(const ExecutionStatus& status, bool runs) {
  return {{"state", name_of(status.motion)},
          {"moving", runs},
          {"progress", status.progress},
          {"hand", name(status.hand)},
          {"pull", status.pull},
          {"mode", name(status.mode)},
          {"causes", cause_names(status.causes)},
          {"reason", status.reason},
          {"separation", finite(status.separation)},
          {"separation_limit", status.separation_limit}};
}

Json people_json(const HumanState& state) {
  Json out = Json::array();
  for (const Person& person : state.people) {
    Json joints = Json::object();
    for (const BodyJoint& joint : person.joints) joints[joint.name] = point_json(joint.position);
    out.push_back(
        {{"id", person.id},
         {"stature", person.stature},
         {"age", person.age},
         {"joints", std::move(joints)},
         {"gaze", person.gaze_known ? point_json(person.gaze_direction) : Json(nullptr)}});
  }
  return out;
}

Json objects_json(const Scene& scene) {
  Json out = Json::array();
  for (const SceneObject& object : scene.objects)
    out.push_back({{"id", object.id},
                   {"model", object.model},
                   {"pose", pose_json(object.T_world_object)},
                   {"holder", name(object.holder)},
                   {"holder_id", object.holder_id},
                   {"age", object.age}});
  return out;
}

Json boxes_json(const Scene& scene) {
  Json out = Json::array();
  for (const SceneBox& box : scene.boxes)
    out.push_back({{"id", box.id},
                   {"pose", pose_json(box.T_world_box)},
                   {"size", point_json(box.size)},
                   {"supports", box.supports}});
  return out;
}

}  // namespace

View::View(Bus& bus) {
  bus.subscribe<Scene>([this](const Scene& m, const Receipt&) { scene_ = m; });
  bus.subscribe<HumanState>([this](const HumanState& m, const Receipt&) { people_ = m; });
  bus.subscribe<ExecutionStatus>([this](const ExecutionStatus& m, const Receipt&) {
    execution_ = m;
    execution_known_ = true;
  });
  bus.subscribe<ActiveTrajectory>(
      [this](const ActiveTrajectory& m, const Receipt&) { active_ = m; });
}

bool View::complete() const {
  return scene_.robot_known && people_.stamp != 0 && execution_known_ &&
         active_.position.size() > 0;
}

const SceneObject& View::object(const std::string& id) const {
  std::string names;
  for (const SceneObject& object : scene_.objects) {
    if (object.id == id) return object;
    names += (names.empty() ? "" : ", ") + object.id;
  }
  throw command::LineError("the scene has no object \"" + id + "\"" +
                           (names.empty() ? "" : "; it has: " + names));
}

Json pose_json(const Pose& T) {
  Json out = Json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) out.push_back(T.matrix()(row, column));
  return out;
}

Json list_json(const Vector& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

Json observation(const View& view, const RobotModel& robot, const Snapshot& seen, double time) {
  const TaskStatus& task = seen.task.sample;
  return {{"time", time},
          {"robot", robot_json(view, robot)},
          {"motion", motion_json(view.execution(), view.active().trajectory != 0)},
          {"people", people_json(view.people())},
          {"objects", objects_json(view.scene())},
          {"boxes", boxes_json(view.scene())},
          {"task", seen.task.ever ? Json{{"id", task.id},
                                         {"kind", name(task.kind)},
                                         {"state", name(task.state)},
                                         {"phase", task.phase},
                                         {"reason", task.reason}}
                                  : Json(nullptr)}};
}

Json oracle(const GroundTruth& truth) {
  return {{"carrier", truth.carrier},
          {"object", truth.object},
          {"handovers", truth.handovers},
          {"handover_done", truth.handover_done},
          {"dropped", truth.dropped},
          {"max_lifted", truth.max_lifted},
          {"min_separation", finite(truth.min_separation)},
          {"ssm_violations", truth.ssm_violations},
          {"limit_violations", truth.limit_violations},
          {"collisions", truth.self_or_scene_collisions},
          {"contact_force", truth.contact_force},
          {"hash", truth.hash}};
}

Json task_json(const config::TaskDescription& task) {
  return {{"kind", task.kind()},
          {"object", task.object()},
          {"human", task.human()},
          {"surface", task.surface()}};
}

}  // namespace handsel::environment
