// The motion that runs, looked at again and again: a better path for the people as they are now, a way around what came into it (chapter
// sections 2.1 and 4.1.1). The path planner keeps what lies before the place where the old path is left; the controller is told that place.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/collision/margins.hpp"
#include "common/model/human_body.hpp"
#include "common/trajectory/broken_line.hpp"
#include "components/manipulation_planner/manipulation_planner.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kStep = 0.004;     // the motion that leads over is judged this often [rad, max norm]
constexpr double kWideStep = 0.01;  // and what follows it this often
constexpr double kMargin = 0.01;    // furniture, and what other axes turn, is taken for larger by this much on every side [m]
constexpr double kReserve = 1.1;    // what a switch keeps of the limits it is given: so it keeps the comfort limits
constexpr double kLook = 0.1;       // costs along a trajectory are looked at this often [s]
constexpr double kEarly = 0.04;     // the command must be with the controller this long before it is due [s]

constexpr double kStepAside = 0.1;     // a receiver who moved less is where they were [m]
constexpr double kWorthMoving = 0.05;  // an exchange posture is kept until another costs less by this

/// Until when the trajectory has not been farther than `reach` from where it begins [s].
double within_reach(const Trajectory& trajectory, const Vector& from, double reach) {
  constexpr int kLooks = 100;
  double last = 0.0;
  for (int k = 0; k <= kLooks; ++k) {
    const double t = trajectory.duration() * k / kLooks;
    if ((trajectory.at(t).position - from).cwiseAbs().maxCoeff() > reach) break;
    last = t;
  }
  return last;
}

}  // namespace

/// From a state in motion onto the trajectory.
Switched ManipulationPlanner::join(const MotionState3& from, const Trajectory& to) const {
  KinematicLimits limits = robot_->comfort_limits();
  for (Vector* part : {&limits.velocity, &limits.acceleration, &limits.jerk}) *part = kReserve * RobotModel::part(*part, arm_);
  SwitchSettings settings;
  settings.reserve = kReserve;
  settings.last = within_reach(to, from.position, settings_.live_reach());
  return switch_to(from, to, limits, settings);
}

/// The same, all of what leads over free; nullopt when that cannot be.
std::optional<Trajectory> ManipulationPlanner::lead_over(CollisionWorld& world, const Around& around, const MotionState3& from,
                                                         const Trajectory& to) const {
  const Switched over = join(from, to);
  if (!over.ok()) return std::nullopt;
  world.set_scene(around.scene);
  world.set_people(around.people);
  world.set_attachment(around.attachment, around.allowed);
  world.set_moving_axes(arm_.axes);
  const auto whole_posture = [&](const Vector& q) { return RobotModel::with(around.posture, arm_, q); };
  set_scene_with_margins(world, around.scene, {kMargin, kMargin},
                         {whole_posture(from.position), whole_posture(to.at(to.duration()).position)});
  double rate = kReserve * RobotModel::part(robot_->comfort_limits().velocity, arm_).maxCoeff();
  for (const AxisTrajectory& axis : over.trajectory.axes) rate = std::max(rate, std::abs(axis.start.velocity));
  // Past that the path is known to be free, but corners cut it.
  const double whole = over.trajectory.duration();
  const int first = std::max(2, static_cast<int>(std::ceil(rate * over.connecting / kStep)));
  const int looks = first + static_cast<int>(std::ceil(rate * std::max(0.0, whole - over.connecting) / kWideStep));
  for (int k = 0; k <= looks; ++k) {
    const double t = k <= first ? over.connecting * k / first : over.connecting + (whole - over.connecting) * (k - first) / (looks - first);
    const Vector q = over.trajectory.at(t).position;
    for (int i = 0; i < q.size(); ++i) {
      const Axis& axis = robot_->axes()[static_cast<std::size_t>(arm_.axes[static_cast<std::size_t>(i)])];
      if (q[i] < axis.lower || q[i] > axis.upper) return std::nullopt;
    }
    if (!world.is_free(whole_posture(q))) return std::nullopt;
  }
  return over.trajectory;
}

double ManipulationPlanner::cost_at(const Vector& q, const Vector& posture) const { return (*cost_)(RobotModel::with(posture, arm_, q)); }

/// Integral along the trajectory of what the human-aware cost is above `level` [rad].
double ManipulationPlanner::cost_along(const Trajectory& trajectory, const Vector& posture, double level) const {
  const int looks = std::max(1, static_cast<int>(std::ceil(trajectory.duration() / kLook)));
  double sum = 0;
  for (int k = 0; k < looks; ++k) {
    const auto at = [&](double look) { return trajectory.at(trajectory.duration() * look / looks).position; };
    sum += std::max(0.0, cost_at(at(k + 0.5), posture) - level) * (at(k + 1) - at(k)).norm();
  }
  return sum;
}

/// Both ways as the arm would really go: what leads over to a path may leave out what makes it cheaper.
void ManipulationPlanner::weigh(Ways& ways, CollisionWorld& world, const Around& around, const MotionState3& from, bool standing) const {
  if (!standing) {
    ways.over = lead_over(world, around, from, *ways.over);
    if (ways.along)
      if (Switched along = join(from, *ways.along); along.ok()) ways.along = std::move(along.trajectory);
  }
  if (!ways.over || !ways.along) return;
  cost_->set_people(around.people);
  cost_->set_layers(around.layers);
  cost_->set_base(around.scene.T_world_base);
  double level = cost_at(from.position, around.posture);  // what every motion between these ends costs is nobody's gain
  for (const Trajectory* way : {&*ways.over, &*ways.along})
    level = std::min(level, cost_at(way->at(way->duration()).position, around.posture));
  const double before = cost_along(*ways.along, around.posture, level),
               gain = before > 0 ? 1 - cost_along(*ways.over, around.posture, level) / before : 0;
  ways.worth = gain >= settings_.live_gain() && ways.over->duration() <= (1 + settings_.live_slower() * gain) * ways.along->duration();
}

Routine<bool> ManipulationPlanner::follow(Motion& motion, const Vector& goal) {
  const Person* whom = person(motion.receiver);
  if (whom == nullptr) co_return false;
  const Vector3 torso = whom->joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  if ((torso - motion.receiver_at).norm() < kStepAside) co_return false;
  const Pose T_world_object =
      scene_.T_world_base * robot_->link_pose(RobotModel::with(posture(), arm_, goal), robot_->tool_link()) * attachment_.T_tool_object;
  ExchangeChoice choice = co_await choose_exchange(motion.receiver, &T_world_object);
  whom = person(motion.receiver);
  if (!choice.outcome.good || whom == nullptr) co_return false;
  if (choice.search.poses.empty()) co_return !choice.kept;
  if (choice.kept && *choice.kept <= choice.search.poses.front().cost + kWorthMoving) {
    motion.receiver_at = torso;
    co_return false;
  }
  lead_to(choice.search, *whom, motion);
  motion.receiver_at = torso;
  status_.exchange_point = choice.search.poses.front().T_world_object.translation();
  co_return true;
}

Routine<Outcome> ManipulationPlanner::go_on(Running& running, const Motion& motion) {
  if (active_.trajectory != running.command || active_.rest.size() != static_cast<int>(arm_.axes.size()))
    co_return Outcome::failure("the controller tells of another motion");
  const double duration = active_.rest.duration(), offset = duration - running.duration;
  const bool standing = at_rest();
  const double leave = active_.time + (standing ? 0.0 : settings_.replan_time());
  if (!standing && leave <= offset) co_return Outcome::failure("it has not begun yet");
  if (leave + settings_.replan_time() > duration) co_return Outcome::failure("it is nearly there");
  const MotionState3 from = active_.rest.at(leave);
  const Vector start = RobotModel::with(posture(), arm_, from.position);
  const Running* now = &running;
  const auto ended = [this, now] { return execution_->trajectory != now->command || execution_->motion != MotionState::running; };

  PathRequest request = path_request(start, motion);
  request.running = running.nodes;
  request.time_limit = settings_.live_time();
  ++live_counts_.looks;
  out_->path_requests.push_back(request);
  const bool planned = co_await waiting_.until([this, ended] { return path_reply_.has_value() || ended(); }, settings_.replan_time());
  if (!planned || ended()) co_return Outcome::failure("no path came in time");
  if (!path_reply_->solved) {
    ++live_counts_.refused;
    co_return Outcome::failure(path_reply_->reason);
  }
  if (path_reply_->outcome == PathOutcome::kept) {
    ++live_counts_.kept;
    co_return Outcome{};
  }
  const bool only_cheaper = path_reply_->outcome == PathOutcome::improved;
  const std::vector<Vector> nodes = path_reply_->path;
  if (only_cheaper) {
    const TrajectoryRequest as_before = trajectory_request(remainder(running.nodes, from.position, settings_.live_reach()), start, motion);
    comparison_ = as_before.id;
    comparison_reply_.reset();
    out_->trajectory_requests.push_back(as_before);
  }
  out_->trajectory_requests.push_back(trajectory_request(nodes, start, motion));
  const bool timed = co_await waiting_.until(
      [this, ended, only_cheaper] { return (trajectory_reply_ && (!only_cheaper || comparison_reply_)) || ended(); },
      settings_.replan_time());
  if (!timed || ended()) co_return Outcome::failure("no trajectory came in time");
  if (!trajectory_reply_->solved) {
    ++live_counts_.refused;
    co_return Outcome::failure(trajectory_reply_->reason);
  }
  auto ways = std::make_shared<Ways>();
  ways->over = trajectory_reply_->trajectory;
  if (only_cheaper && comparison_reply_->solved) ways->along = comparison_reply_->trajectory;
  if (!world_) world_ = std::make_shared<CollisionWorld>(*robot_, objects_);
  const std::function<void()> job = [this, ways, standing, from, world = world_,
                                     around = Around{scene_, people_, layers_.at(waiting_.now()), attachment_, motion.allowed, start}] {
    weigh(*ways, *world, around, from, standing);
  };
  Outcome worked = co_await work(job);
  if (!worked.good) co_return worked;
  if (ended()) co_return Outcome::failure("the motion has ended");
  if (!ways->over) {
    ++live_counts_.refused;
    co_return Outcome::failure("no free motion leads over to the new path");
  }
  if (!ways->worth) {
    ++live_counts_.slower;
    co_return Outcome::failure("the new path takes longer than it is worth");
  }
  if (standing ? !at_rest() || active_.time > leave + 1e-6 : active_.time + kEarly > leave) {
    ++live_counts_.refused;
    co_return Outcome::failure("the new path came too late");
  }
  TrajectoryCommand command = command_for(*ways->over, motion);
  command.switch_at = standing ? 0.0 : leave - offset;
  Outcome heard = co_await send(command);
  if (!heard.good) co_return heard;
  if (execution_->motion == MotionState::refused) {
    ++live_counts_.refused;
    const Outcome why = Outcome::failure("the new path was refused: " + execution_->reason);
    co_await waiting_.until([this, now] { return execution_->trajectory == now->command; }, 1.0);
    co_return why;
  }
  ++live_counts_.taken;
  running.command = command.id;
  running.duration = command.trajectory.duration();
  running.nodes = nodes;
  co_return Outcome{};
}

}  // namespace handsel::manipulation_planner
