// The motion that runs, looked at again and again: a better path for the people as they are now, a way around what came into it (chapter
// sections 2.1 and 4.1.1). The path planner keeps what lies before the place where the old path is left; the controller is told that place.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/trajectory/broken_line.hpp"
#include "components/manipulation_planner/manipulation_planner.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kStep = 0.004;    // the motion that leads over is judged this often [rad, max norm]
constexpr double kMargin = 0.005;  // furniture is taken for larger by this much on every side [m]
constexpr double kReserve = 1.1;   // what a switch keeps of the limits it is given: so it keeps the comfort limits
constexpr double kEarly = 0.04;    // the command must be with the controller this long before it is due [s]

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
  Scene scene = around.scene;
  for (SceneBox& box : scene.boxes) box.size += Vector3::Constant(2 * kMargin);
  world.set_scene(scene);
  world.set_people(around.people);
  world.set_attachment(around.attachment, around.allowed);
  world.set_moving_axes(arm_.axes);
  double rate = kReserve * RobotModel::part(robot_->comfort_limits().velocity, arm_).maxCoeff();
  for (const AxisTrajectory& axis : over.trajectory.axes) rate = std::max(rate, std::abs(axis.start.velocity));
  const int looks = std::max(2, static_cast<int>(std::ceil(rate * over.connecting / kStep)));
  for (int k = 0; k <= looks; ++k) {
    const Vector q = over.trajectory.at(over.connecting * k / looks).position;
    for (int i = 0; i < q.size(); ++i) {
      const Axis& axis = robot_->axes()[static_cast<std::size_t>(arm_.axes[static_cast<std::size_t>(i)])];
      if (q[i] < axis.lower || q[i] > axis.upper) return std::nullopt;
    }
    if (!world.is_free(RobotModel::with(around.posture, arm_, q))) return std::nullopt;
  }
  return over.trajectory;
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
  struct Ways {
    std::optional<Trajectory> over;
    double longest{std::numeric_limits<double>::infinity()};  // that it may last [s]
  };
  auto ways = std::make_shared<Ways>();
  ways->over = trajectory_reply_->trajectory;
  const double slower = 1 + settings_.live_slower();
  if (only_cheaper && comparison_reply_->solved) ways->longest = slower * comparison_reply_->trajectory.duration();
  if (!standing) {
    if (!world_) world_ = std::make_shared<CollisionWorld>(*robot_, objects_);
    const Trajectory as_before = only_cheaper && comparison_reply_->solved ? comparison_reply_->trajectory : Trajectory{};
    const std::function<void()> job = [this, ways, slower, as_before, world = world_, from, to = trajectory_reply_->trajectory,
                                       around = Around{scene_, people_, attachment_, motion.allowed, start}] {
      ways->over = lead_over(*world, around, from, to);
      if (as_before.size() == 0) return;
      if (const Switched along = join(from, as_before); along.ok()) ways->longest = slower * along.trajectory.duration();
    };
    Outcome worked = co_await work(job);
    if (!worked.good) co_return worked;
    if (!ways->over) {
      ++live_counts_.refused;
      co_return Outcome::failure("no free motion leads over to the new path");
    }
  }
  if (ended()) co_return Outcome::failure("the motion has ended");
  if (ways->over->duration() > ways->longest) {
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
