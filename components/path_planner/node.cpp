#include "components/path_planner/node.hpp"

#include <algorithm>
#include <cmath>

#include "common/config/settings/path_planner.hpp"
#include "common/cost/cost_settings.hpp"
#include "components/path_planner/cartesian.hpp"
#include "components/path_planner/head_room.hpp"
#include "components/path_planner/path_planner.hpp"
#include "components/path_planner/request.hpp"

namespace handsel::path_planner {
namespace {

constexpr const char* kCancelled = "cancelled on request";
constexpr Duration kLayerWatch = std::chrono::milliseconds(200);

Settings core_settings(const settings::PathPlannerSettings& s) {
  Settings out;
  out.step = s.step;
  out.verify_step = s.verify_step;
  out.connect_range = s.connect_range;
  out.transition_range = s.transition_range;
  out.initial_temperature = s.initial_temperature;
  out.search_share = s.search_share;
  out.cost_step = s.cost_step;
  out.length_weight = s.length_weight;
  out.smoothing_rounds = s.smoothing_rounds;
  out.patience = s.patience;
  out.longest_edge = s.longest_edge;
  return out;
}

PathReply reply_of(const PathRequest& request, const Result& result) {
  PathReply reply;
  reply.id = request.id;
  reply.solved = result.solved;
  reply.reason = result.reason;
  reply.start_touches = result.start_touches;
  reply.goal = static_cast<std::uint32_t>(result.goal);
  reply.path = result.path;
  reply.cost = result.cost;
  reply.work = result.work;
  reply.length = result.length;
  reply.checks = result.checks;
  return reply;
}

}  // namespace

Node::Node(Bus& bus, const NodeContext& context)
    : bus_(bus),
      robot_(context.robot),
      reply_out_(bus.advertise<PathReply>()),
      world_(*context.robot, context.objects),
      cost_(*context.robot, load_cost_settings(context.settings)),
      objects_(context.objects),
      weights_(load_cost_settings(context.settings)) {
  if (!context.description.empty()) on_platform_ = on_platform(*context.robot, context.description);
  const auto file = settings::read_path_planner_settings(context.settings / "path_planner.txtpb");
  settings_ = core_settings(file);
  timing_ = {file.check_time, file.longest_time, from_seconds(file.max_scene_age)};
  live_.least_gain = file.live_gain;
  live_.rounds = file.live_rounds;
  live_.tries = file.live_tries;
  live_margins_ = {file.live_margin, file.live_turning_margin};
  roam_ = file.roam;
  head_room_ = file.head_room;
  bus.subscribe<Scene>([this](const Scene& scene, const Receipt&) { scene_ = std::make_shared<Scene>(scene); });
  bus.subscribe<HumanState>([this](const HumanState& people, const Receipt&) { people_ = std::make_shared<HumanState>(people); });
  bus.subscribe<Costmap>(
      [this](const Costmap& layer, const Receipt& receipt) { layers_.put(layer, receipt.arrival - receipt.age, receipt.arrival); });
  bus.every(kLayerWatch, [this](TimePoint now) { bus_.set_degraded(layers_.complaint(now)); });
  bus.subscribe<PathRequest>([this](const PathRequest& request, const Receipt&) { on_request(request); });
}

void Node::on_request(const PathRequest& request) {
  if (request.cancel) {
    cancel(request.id);
    return;
  }
  using Admission = RequestQueue<PathReply>::Admission;
  switch (requests_.admit(request.id)) {
    case Admission::under_way:
      return;
    case Admission::answered:
      reply_out_->publish(*requests_.answer(request.id));
      return;
    case Admission::superseded:
      refuse(request.id, "superseded by a newer request of the same client");
      return;
    case Admission::cancelled:
      refuse(request.id, kCancelled);
      return;
    case Admission::full:
      bus_.count_left_out("path requests: too many wait", 1);
      refuse_unheard(request.id, requests_.why_full());
      return;
    case Admission::fresh:
      break;
  }
  stop_running(request.id.client, request.id.number);
  if (const std::string why = not_ready(); !why.empty()) {
    refuse(request.id, why);
    return;
  }
  PathRequest whole = request;
  if (const std::string why = complete(whole); !why.empty()) {
    refuse(request.id, why);
    return;
  }
  start(whole);
}

/// Where a platform drives it begins where it stands, unless told. Why the request makes no sense, or empty.
std::string Node::complete(PathRequest& request) const {
  if (!on_platform_ || !drives(request.group)) return contradiction(*robot_, request);
  constexpr double kLevel = 0.02;  // [rad]
  if (!(scene_->T_world_base.linear()(2, 2) > std::cos(kLevel))) return "the platform does not stand level: it cannot be planned for";
  if (request.start.size() == robot_->dof()) request.start = with_platform(request.start, scene_->T_world_base);
  return contradiction(*on_platform_, request);
}

Node::Seat Node::seat_for(const std::string& group) {
  if (!on_platform_ || !drives(group)) return {*robot_, world_, cost_, nullptr};
  if (!mobile_) mobile_ = std::make_unique<Mobile>(*on_platform_, objects_, weights_);
  return {*on_platform_, mobile_->world, mobile_->cost, &mobile_->navigation};
}

/// What is asked for is answered at once; the work for it ends with its next check.
void Node::cancel(const RequestId& id) {
  stop_running(id.client, id.number);
  for (const RequestId& open : requests_.cancel(id)) refuse(open, kCancelled);
}

std::string Node::not_ready() const {
  if (!scene_ || bus_.lag<Scene>() > timing_.max_scene_age) return "no current scene is known";
  if (!people_ || bus_.lag<HumanState>() > timing_.max_scene_age) return "no current state of people is known";
  if (!scene_->robot_known) return "the robot's place is not known yet";
  return {};
}

void Node::start(const PathRequest& request) {
  struct Work {
    PathRequest request;
    Problem problem;
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const HumanState> people;
    LayersNow layers;
    LiveOutcome outcome{};
    Result result;
  };
  auto work = std::make_shared<Work>();
  work->request = request;
  work->scene = scene_;
  work->people = people_;
  work->layers = layers_.at(bus_.now());
  Problem& problem = work->problem;
  Pose T_world_root = scene_->T_world_base;
  const bool driving = on_platform_ && drives(request.group);
  if (driving) T_world_root = make_pose({0, 0, scene_->T_world_base.translation().z()});
  problem = problem_of(driving ? *on_platform_ : *robot_, request, T_world_root);
  const double time = std::clamp(request.time_limit, 0.0, timing_.longest_time);
  problem.budget = static_cast<std::uint64_t>(std::llround(time / timing_.check_time));

  const auto compute = [this, work, T_world_root](const CancelToken& token) {
    const Seat seat = seat_for(work->request.group);
    Scene scene = *work->scene;
    scene.T_world_base = T_world_root;
    seat.world.set_scene(scene);
    seat.world.set_turning_margin(0);
    seat.world.set_people(*work->people);
    seat.world.set_attachment(work->request.attachment, work->request.allowed_contacts);
    if (!work->request.running.empty()) {
      seat.world.set_moving_axes(work->problem.axes);
      set_scene_with_margins(seat.world, scene, live_margins_, ends_of(work->problem, work->request.running.back()));
    }
    seat.cost.set_people(*work->people);
    seat.cost.set_layers(work->layers);
    seat.cost.set_base(T_world_root);
    if (seat.navigation != nullptr) {
      seat.navigation->set_people(*work->people);
      drive(seat.robot, *seat.navigation, roam_, work->problem);
    }
    const Hooks hooks{[&token] { return token.cancelled(); }, {}};
    const auto solve = [&] {
      if (work->request.running.empty()) {
        work->result = from_nothing(seat, work->request, work->problem, T_world_root, hooks);
        return;
      }
      LiveResult live = go_on(seat.robot, seat.world, seat.cost, work->problem, work->request.running, settings_, live_, hooks);
      work->outcome = live.outcome;
      work->result = std::move(live.result);
    };
    const std::uint64_t budget = work->problem.budget;
    std::uint64_t spent = 0;
    if (make_head_room(seat, work->request, work->problem, *work->people) > 0) {
      work->problem.budget = budget / 2;
      solve();
      seat.world.set_obstacles({});
      spent = work->result.checks;
    }
    if (!work->result.solved && !token.cancelled()) {
      work->problem.budget = budget - std::min(spent, budget - 1);
      solve();
      work->result.checks += spent;
    }
    return from_seconds(timing_.check_time * static_cast<double>(work->result.checks));
  };
  const auto answer = [this, work] {
    const RequestId id = work->request.id;
    auto& of_client = running_[id.client];
    of_client.erase(id.number);
    if (of_client.empty()) running_.erase(id.client);
    if (requests_.answer(id) != nullptr) return;  // cancelled
    PathReply reply = reply_of(work->request, work->result);
    if (!reply.solved && work->result.cancelled && requests_.superseded(id))
      reply.reason = "superseded by a newer request of the same client";
    if (!work->request.running.empty()) {
      ++live_outcomes_[static_cast<std::size_t>(work->outcome)];
      reply.outcome = static_cast<PathOutcome>(static_cast<int>(work->outcome) + static_cast<int>(PathOutcome::kept));
    } else if (!reply.solved) {
      reply.outcome = PathOutcome::blocked;
    }
    requests_.close(reply);
    reply_out_->publish(reply);
  };
  running_[request.id.client].emplace(request.id.number, bus_.run_job(compute, answer));
}

/// Room about heads for what is planned between postures; 0 for the rest: a straight line leads where it leads.
double Node::make_head_room(const Seat& seat, const PathRequest& request, const Problem& problem, const HumanState& people) const {
  seat.world.set_obstacles({});
  if (request.straight || problem.goals.empty() || seat.navigation != nullptr || request.space == PlanSpace::cartesian) return 0;
  seat.world.set_moving_axes(problem.axes);
  std::vector<Vector> goals;
  for (const Vector& goal : problem.goals) goals.push_back(RobotModel::with(problem.start, *seat.robot.group(request.group), goal));
  return keep_off_heads(seat.world, people, head_room_, problem.start, goals);
}

/// Start and goal of a live request: the goal that is led to if it is wanted still, else the first one; all axes.
std::vector<Vector> Node::ends_of(const Problem& problem, const Vector& goal_so_far) {
  Vector goal = problem.start;
  goal(problem.axes) = std::count(problem.goals.begin(), problem.goals.end(), goal_so_far) > 0 ? goal_so_far : problem.goals.front();
  return {problem.start, goal};
}

Result Node::from_nothing(const Seat& seat, const PathRequest& request, Problem& problem, const Pose& T_world_root, const Hooks& hooks) {
  const std::vector<PoseGoal> poses = pose_goals(request, T_world_root);
  if (request.space == PlanSpace::cartesian) {
    CartesianProblem cartesian;
    cartesian.start = problem.start;
    cartesian.T_root_goal = poses.front().T_root_tip;
    cartesian.also.assign(request.also.begin(), request.also.end());
    cartesian.also_goal = request.also_goal;
    cartesian.seed = problem.seed;
    cartesian.budget = problem.budget;
    std::vector<int> columns = problem.axes;
    columns.insert(columns.end(), cartesian.also.begin(), cartesian.also.end());
    return in_joints(plan_cartesian(seat.robot, seat.world, seat.cost, cartesian, {}, hooks), columns);
  }
  if (poses.empty()) return plan(seat.robot, seat.world, seat.cost, problem, settings_, hooks);
  PoseGoals found = seat.navigation != nullptr ? reach_driving(seat.robot, seat.world, poses, problem.start, problem.seed)
                                               : reach(seat.robot, *seat.robot.group(request.group), poses, problem.start, problem.seed);
  problem.goals = std::move(found.goals);
  Result result;
  result.reason = found.reason;
  if (seat.navigation != nullptr) drive(seat.robot, *seat.navigation, roam_, problem);
  if (!problem.goals.empty()) result = plan(seat.robot, seat.world, seat.cost, problem, settings_, hooks);
  if (result.solved) result.goal = found.pose[result.goal];
  return result;
}

/// Ends the work for the requests of a client up to this number with its next check.
void Node::stop_running(std::uint64_t client, std::uint64_t last) {
  const auto of_client = running_.find(client);
  if (of_client == running_.end()) return;
  for (auto& [number, token] : of_client->second)
    if (number <= last) token.cancel();
}

void Node::refuse(const RequestId& id, const std::string& reason) {
  requests_.close(refusal(id, reason));
  reply_out_->publish(*requests_.answer(id));
}

/// The answer is not remembered: the same request may be made again.
void Node::refuse_unheard(const RequestId& id, const std::string& reason) { reply_out_->publish(refusal(id, reason)); }

PathReply Node::refusal(const RequestId& id, const std::string& reason) {
  PathReply reply;
  reply.id = id;
  reply.reason = reason;
  reply.outcome = PathOutcome::blocked;
  return reply;
}

}  // namespace handsel::path_planner
