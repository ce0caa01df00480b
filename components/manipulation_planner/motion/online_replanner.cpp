// The motion that runs, looked at again and again: a better path for the people as they are now, a way around what came into it (chapter
// sections 2.1 and 4.1.1). The path planner keeps what lies before the place where the old path is left; the controller is told that place.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/collision/margins.hpp"
#include "common/model/human/human_body.hpp"
#include "common/trajectory/path/broken_line.hpp"
#include "components/manipulation_planner/planner.hpp"

namespace handsel::manipulation_planner {
namespace {

constexpr double kStep = 0.004;     // the motion that leads over is judged this often [rad, max norm]
constexpr double kWideStep = 0.01;  // and what follows it this often
constexpr double kMargin = 0.01;    // furniture, and what other axes turn, is taken for larger by this much on every side [m]
constexpr double kReserve = 1.1;    // what a switch keeps of the limits it is given: so it keeps the comfort limits
constexpr double kLook = 0.1;       // costs along a trajectory are looked at this often [s]
constexpr double kEarly = 0.04;     // the command must be with the controller this long before it is due [s]

// [rad, max norm] The same path at another pace is joined at most so far from where the arm is, or so much farther as it needs to brake.
constexpr double kRetimed = 0.3, kFarther = 0.1;

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

/// Whether one of the last `legs` legs must be slower than it was timed, to less than `share` of that. Speeds as in TrajectoryReply.
bool slower_ahead(const Vector& before, const Vector& now, std::size_t legs, double share) {
  const auto from_end = [](const Vector& speeds, std::size_t k) {
    return static_cast<Eigen::Index>(k) < speeds.size() ? speeds[speeds.size() - 1 - static_cast<Eigen::Index>(k)] : 1.0;
  };
  for (std::size_t k = 0; k < legs; ++k)
    if (from_end(now, k) < share * from_end(before, k)) return true;
  return false;
}

/// From speed it takes longer than from rest: it would go past where it joins, and come back.
bool turns_back(const Switched& over, const Trajectory& to) { return over.ok() && over.trajectory.duration() > to.duration(); }

}  // namespace

/// From a state in motion onto the trajectory.
Switched ManipulationPlanner::join(const MotionState3& from, const Trajectory& to, const Ways& ways) const {
  KinematicLimits limits = robot_->comfort_limits();
  for (Vector* part : {&limits.velocity, &limits.acceleration, &limits.jerk}) *part = kReserve * RobotModel::part(*part, arm_);
  if (ways.share < 1)
    limits.velocity = (ways.share * limits.velocity).cwiseMax(limits.velocity.cwiseMin(kReserve * from.velocity.cwiseAbs()));
  SwitchSettings settings;
  settings.reserve = kReserve;
  settings.last = within_reach(to, from.position, ways.reach);
  return switch_to(from, to, limits, settings);
}

/// The same, all of what leads over free; nullopt when that cannot be.
std::optional<Trajectory> ManipulationPlanner::lead_over(CollisionWorld& world, const Around& around, const MotionState3& from,
                                                         const Ways& ways) const {
  const Trajectory& to = *ways.over;
  const Switched over = join(from, to, ways);
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
  const double from_rest = ways.over->duration();
  if (!standing) {
    ways.over = lead_over(world, around, from, ways);
    if (ways.along) {
      Switched along = join(from, *ways.along, ways);
      if (along.ok() && !turns_back(along, *ways.along)) ways.along = std::move(along.trajectory);
    }
  }
  if (!ways.over || !ways.along) return;
  cost_->set_people(around.people);
  cost_->set_layers(around.layers);
  cost_->set_base(around.scene.T_world_base);
  double level = cost_at(from.position, around.posture);  // what every motion between these ends costs is nobody's gain
  for (const Trajectory* way : {&*ways.over, &*ways.along})
    level = std::min(level, cost_at(way->at(way->duration()).position, around.posture));
  const double before = cost_along(*ways.along, around.posture, level),
               saved = before > 0 ? around.cost_gain * (1 - cost_along(*ways.over, around.posture, level) / before) : 0;
  const double longest = std::min(from_rest, (1 + settings_.live_slower() * saved) * ways.along->duration());
  ways.worth = saved >= settings_.live_gain() && ways.over->duration() <= longest;
}

Routine<bool> ManipulationPlanner::follow(Motion& motion, const Vector& goal) {
  const Person* whom = snapshot_.person(motion.receiver);
  if (whom == nullptr) co_return false;
  const Vector3 torso = whom->joints[static_cast<std::size_t>(body_joint_index("torso"))].position;
  if ((torso - motion.receiver_at).norm() < kStepAside) co_return false;
  const Pose T_world_object =
      snapshot_.T_world_base() * robot_->link_pose(RobotModel::with(posture(), arm_, goal), palm_) * attachment_.T_tool_object;
  ExchangeChoice choice = co_await choose_exchange(motion.receiver, &T_world_object);
  whom = snapshot_.person(motion.receiver);
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

bool ManipulationPlanner::gone(const Running& running) const {
  return snapshot_.execution()->trajectory != running.command || snapshot_.execution()->motion != MotionState::running;
}

Routine<Outcome> ManipulationPlanner::go_on(Running& running, const Motion& motion) {
  if (snapshot_.active().trajectory != running.command || snapshot_.active().rest.size() != static_cast<int>(arm_.axes.size()))
    co_return Outcome::failure("the controller tells of another motion");
  const double duration = snapshot_.active().rest.duration();
  Leave leave;
  leave.offset = duration - running.duration;
  leave.standing = at_rest();
  leave.at = snapshot_.active().time + (leave.standing ? 0.0 : settings_.replan_time());
  if (!leave.standing && leave.at <= leave.offset) co_return Outcome::failure("it has not begun yet");
  if (leave.at + settings_.replan_time() > duration) co_return Outcome::failure("it is nearly there");
  leave.from = snapshot_.active().rest.at(leave.at);
  leave.rest = duration - leave.at;
  const Vector start = RobotModel::with(posture(), arm_, leave.from.position);
  const Running* now = &running;
  const auto ended = [this, now] { return gone(*now); };

  PathRequest request = path_request(start, motion);
  request.running = running.nodes;
  request.time_limit = settings_.live_time();
  ++live_counts_.looks;
  clients_.path.send(request);
  const bool planned =
      co_await waiting_.until([this, ended] { return clients_.path.reply().has_value() || ended(); }, settings_.replan_time());
  if (!planned || ended()) co_return Outcome::failure("no path came in time");
  if (!clients_.path.reply()->solved) {
    ++live_counts_.refused;
    co_return Outcome::failure(clients_.path.reply()->reason);
  }
  const PathOutcome outcome = clients_.path.reply()->outcome;
  const std::vector<Vector> nodes = clients_.path.reply()->path;
  const bool kept = outcome == PathOutcome::kept, only_cheaper = outcome == PathOutcome::improved;
  const std::vector<Vector> as_before = remainder(running.nodes, leave.from.position, settings_.live_reach());
  const bool compared = only_cheaper || (kept && settings_.live_pace() > 0 && !as_before.empty());
  if (compared) {
    clients_.comparison.send(trajectory_request(clients_.comparison, as_before, start, motion));
  }
  if (!kept) clients_.trajectory.send(trajectory_request(clients_.trajectory, nodes, start, motion));
  const bool timed = co_await waiting_.until(
      [this, ended, kept, compared] {
        return ((kept || clients_.trajectory.reply()) && (!compared || clients_.comparison.reply())) || ended();
      },
      settings_.replan_time());
  if (!timed || ended()) co_return Outcome::failure("no trajectory came in time");
  if (!kept) {
    if (!clients_.trajectory.reply()->solved) {
      ++live_counts_.refused;
      co_return Outcome::failure(clients_.trajectory.reply()->reason);
    }
    auto ways = std::make_shared<Ways>();
    ways->over = clients_.trajectory.reply()->trajectory;
    ways->reach = settings_.live_reach();
    if (only_cheaper && clients_.comparison.reply()->solved) ways->along = clients_.comparison.reply()->trajectory;
    const TrajectoryReply reply = *clients_.trajectory.reply();
    Outcome over = co_await go_over(running, motion, leave, ways, reply, nodes);
    if (over.good) ++live_counts_.taken;
    if (over.good || ways->worth) co_return over;
    ++live_counts_.slower;
    if (!only_cheaper || ended()) co_return over;
  } else {
    ++live_counts_.kept;
  }
  if (!compared || !clients_.comparison.reply()->solved || settings_.live_pace() <= 0) co_return Outcome{};
  Outcome retimed = co_await retime(running, motion, leave, as_before);
  if (retimed.good) ++live_counts_.retimed;
  co_return Outcome{};
}

/// Slower where a leg ahead must be; faster where all of the way then is.
Routine<Outcome> ManipulationPlanner::retime(Running& running, const Motion& motion, const Leave& leave, const std::vector<Vector>& nodes) {
  const TrajectoryReply reply = *clients_.comparison.reply();
  auto ways = std::make_shared<Ways>();
  ways->over = reply.trajectory;
  ways->share = reply.speeds.size() > 0 ? reply.speeds[0] : 1.0;
  Switched along;
  along.trajectory = reply.trajectory;
  for (double reach = kRetimed; !leave.standing && reach <= settings_.live_reach(); reach += kFarther) {
    ways->reach = reach;
    along = join(leave.from, reply.trajectory, *ways);
    if (along.ok() && !turns_back(along, reply.trajectory)) break;
  }
  if (!along.ok() || turns_back(along, reply.trajectory)) co_return Outcome::failure("the arm is too fast to go over");
  const double share = 1 - settings_.live_pace();
  if (!slower_ahead(running.speeds, reply.speeds, nodes.size() - 1, share)) {
    const bool faster = slower_ahead(reply.speeds, running.speeds, nodes.size() - 1, share);
    if (!faster || along.trajectory.duration() > share * leave.rest) co_return Outcome::failure("it would go as before");
  }
  Outcome over = co_await go_over(running, motion, leave, ways, reply, nodes);
  co_return over;
}

Routine<Outcome> ManipulationPlanner::go_over(Running& running, const Motion& motion, const Leave& leave, const std::shared_ptr<Ways>& ways,
                                              const TrajectoryReply& timed, const std::vector<Vector>& nodes) {
  const Running* now = &running;
  const bool standing = leave.standing;
  const std::function<void()> job = [this, ways, standing, from = leave.from, world = worker_.world(*robot_, snapshot_.objects()),
                                     around = Around{snapshot_.scene(), snapshot_.people(), snapshot_.layers(waiting_.now()), attachment_,
                                                     motion.allowed, RobotModel::with(posture(), arm_, leave.from.position),
                                                     live_pace_.heard(waiting_.now()) ? cost_gain_ : 1.0}] {
    weigh(*ways, *world, around, from, standing);
  };
  Outcome worked = co_await worker_.run(job);
  if (!worked.good) co_return worked;
  if (gone(running)) co_return Outcome::failure("the motion has ended");
  if (!ways->over) {
    ++live_counts_.refused;
    co_return Outcome::failure("no free motion leads over to the new path");
  }
  if (!ways->worth) co_return Outcome::failure("the new path takes longer than it is worth");
  if (standing ? !at_rest() || snapshot_.active().time > leave.at + 1e-6 : snapshot_.active().time + kEarly > leave.at) {
    ++live_counts_.refused;
    co_return Outcome::failure("the new path came too late");
  }
  TrajectoryCommand command = command_for(*ways->over, motion);
  command.switch_at = standing ? 0.0 : leave.at - leave.offset;
  Outcome heard = co_await send(command);
  if (!heard.good) co_return heard;
  if (snapshot_.execution()->motion == MotionState::refused) {
    ++live_counts_.refused;
    const Outcome why = Outcome::failure("the new path was refused: " + snapshot_.execution()->reason);
    co_await waiting_.until([this, now] { return snapshot_.execution()->trajectory == now->command; }, 1.0);
    co_return why;
  }
  running.command = command.id;
  running.duration = command.trajectory.duration();
  running.nodes = nodes;
  running.speeds = timed.speeds;
  co_return Outcome{};
}

}  // namespace handsel::manipulation_planner
