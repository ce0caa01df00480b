// The motion that runs, looked at again and again: a better path for the people as they are now, a way around what came into it (chapter
// sections 2.1 and 4.1.1). The path planner keeps what lies before the place where the old path is left; the controller is told that place.
#include <algorithm>
#include <cmath>

#include "common/trajectory/switch.hpp"
#include "components/manipulation_planner/manipulation_planner.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kStep = 0.004;    // the motion that leads over is judged this often [rad, max norm]
constexpr double kMargin = 0.005;  // furniture is taken for larger by this much on every side [m]
constexpr double kReserve = 1.1;   // what a switch keeps of the limits it is given: so it keeps the comfort limits
constexpr double kEarly = 0.04;    // the command must be with the controller this long before it is due [s]

/// Whether `path` is, but for its first node, the end of `whole`.
bool same_way(const std::vector<Vector>& path, const std::vector<Vector>& whole) {
  if (path.size() < 2 || path.size() > whole.size() + 1) return false;
  return std::equal(path.begin() + 1, path.end(), whole.end() - static_cast<std::ptrdiff_t>(path.size()) + 1,
                    [](const Vector& a, const Vector& b) { return a.size() == b.size() && (a - b).cwiseAbs().maxCoeff() < 1e-9; });
}

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

/// From a state in motion onto the new trajectory, all of what leads over free; nullopt when that cannot be.
std::optional<Trajectory> ManipulationPlanner::lead_over(CollisionWorld& world, const Around& around, const MotionState3& from,
                                                         const Trajectory& to) const {
  Scene scene = around.scene;
  for (SceneBox& box : scene.boxes) box.size += Vector3::Constant(2 * kMargin);
  world.set_scene(scene);
  world.set_people(around.people);
  world.set_attachment(around.attachment, around.allowed);
  world.set_moving_axes(arm_.axes);
  KinematicLimits limits = robot_->comfort_limits();
  for (Vector* part : {&limits.velocity, &limits.acceleration, &limits.jerk}) *part = kReserve * RobotModel::part(*part, arm_);
  SwitchSettings settings;
  settings.reserve = kReserve;
  settings.last = within_reach(to, from.position, settings_.live_reach());
  Switched over = switch_to(from, to, limits, settings);
  if (!over.ok()) return std::nullopt;
  double rate = 0;
  for (const AxisTrajectory& axis : over.trajectory.axes) rate = std::max(rate, std::abs(axis.start.velocity));
  rate = std::max(rate, limits.velocity.maxCoeff());
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

  PathRequest request;
  request.id = next_request();
  request.group = arm_.name;
  request.start = start;
  request.goals = motion.goals;
  request.attachment = attachment_;
  request.allowed_contacts = motion.allowed;
  request.time_limit = settings_.live_time();
  request.seed = goal_.id + requests_;
  request.live = true;
  path_reply_.reset();
  ++live_counts_.looks;
  out_->path_requests.push_back(request);
  const bool planned = co_await waiting_.until([this, ended] { return path_reply_.has_value() || ended(); }, settings_.replan_time());
  if (!planned || ended()) co_return Outcome::failure("no path came in time");
  if (!path_reply_->solved) {
    ++live_counts_.refused;
    co_return Outcome::failure(path_reply_->reason);
  }
  const std::vector<Vector> nodes = path_reply_->path;
  if (same_way(nodes, running.nodes)) {
    ++live_counts_.kept;
    co_return Outcome{};
  }
  out_->trajectory_requests.push_back(trajectory_request(nodes, start, motion));
  const bool timed = co_await waiting_.until([this, ended] { return trajectory_reply_.has_value() || ended(); }, settings_.replan_time());
  if (!timed || ended()) co_return Outcome::failure("no trajectory came in time");
  if (!trajectory_reply_->solved) {
    ++live_counts_.refused;
    co_return Outcome::failure(trajectory_reply_->reason);
  }
  auto over = std::make_shared<std::optional<Trajectory>>(trajectory_reply_->trajectory);
  if (!standing) {
    if (!world_) world_ = std::make_shared<CollisionWorld>(*robot_, objects_);
    const std::function<void()> job = [this, over, world = world_, from, to = trajectory_reply_->trajectory,
                                       around = Around{scene_, people_, attachment_, motion.allowed, start}] {
      *over = lead_over(*world, around, from, to);
    };
    Outcome worked = co_await work(job);
    if (!worked.good) co_return worked;
    if (!*over) {
      ++live_counts_.refused;
      co_return Outcome::failure("no free motion leads over to the new path");
    }
  }
  if (ended()) co_return Outcome::failure("the motion has ended");
  if (blocked_for_ == 0 && (*over)->duration() > (1 + settings_.live_slower()) * (duration - leave)) {
    ++live_counts_.slower;
    co_return Outcome::failure("the new path takes longer than it is worth");
  }
  if (standing ? !at_rest() || active_.time > leave + 1e-6 : active_.time + kEarly > leave) {
    ++live_counts_.refused;
    co_return Outcome::failure("the new path came too late");
  }
  TrajectoryCommand command = command_for(**over, motion);
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
