#include "components/grasp_planner/grasp_choice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "components/grasp_planner/double_grasp.hpp"
#include "components/grasp_planner/retreat.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr double kLargestApproach = 0.9;  // [rad] an arm axis moves less on the straight approach
constexpr double kLargestLift = 1.4;      // [rad] and on the lift
constexpr double kExchangeAhead = 0.58;   // [m] before the torso of the person
constexpr double kExchangeBelow = 0.2;    // [m] below the shoulder
constexpr int kExchangeHeadings = 8;
constexpr int kTransferReaches = 16;            // inverse kinematics tried for the places of one grasp ...
constexpr std::uint64_t kTransferBudget = 600;  // ... and of all
constexpr std::size_t kTransferTries = 12;      // grasps looked at for a place to hand over, for each that is wanted
constexpr double kSameDistance = 0.02;          // [m] grasps nearer than this ...
constexpr double kSameAngle = 0.35;             // [rad] ... and less turned count as one variant

Vector with_hand(const RobotModel&, const Vector& q, const Group& arm, const Vector& arm_q, const Group& hand, const Vector& hand_q) {
  return RobotModel::with(RobotModel::with(q, arm, arm_q), hand, hand_q);
}

std::size_t touching(const Grasp& g) {
  std::set<std::uint32_t> fingers;
  for (const Contact& c : g.contacts) fingers.insert(c.finger);
  return fingers.size();
}

bool alike(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm() < kSameDistance &&
         Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle() < kSameAngle;
}

}  // namespace

const char* reason_text(ChoiceReason reason) {
  switch (reason) {
    case ChoiceReason::chosen:
      return "chosen";
    case ChoiceReason::below_support:
      return "the hand would be in or under what the object stands on";
    case ChoiceReason::out_of_reach:
      return "no posture of the arm reaches it";
    case ChoiceReason::collision:
      return "arm or hand would collide at the grasp";
    case ChoiceReason::cannot_lift:
      return "the arm could not lift the object straight up";
    case ChoiceReason::no_approach:
      return "no straight approach is free";
    case ChoiceReason::not_considered:
      return "not considered: enough better ones were found, or the budget was used up";
    case ChoiceReason::count:
      break;
  }
  return "unknown";
}

Refusals Choice::refusals() const {
  Refusals out;
  for (std::size_t r = 1; r < reasons.size(); ++r) {
    if (reasons[r] > 0) out.push_back({std::to_string(reasons[r]) + " grasps", reason_text(static_cast<ChoiceReason>(r))});
  }
  return out;
}

std::string Choice::why_none(const GraspList& list) const {
  if (list.grasps.empty()) {
    const auto most = std::max_element(list.reasons.begin() + 1, list.reasons.end());
    return "no stable grasp of hand " + list.hand + " on object " + list.object + " in " + std::to_string(list.frames) +
           " frames; mostly " + reason_text(static_cast<FrameReason>(most - list.reasons.begin()));
  }
  const auto most = std::max_element(reasons.begin() + 1, reasons.end());
  return "none of " + std::to_string(list.grasps.size()) + " stable grasps serves here; mostly " +
         reason_text(static_cast<ChoiceReason>(most - reasons.begin()));
}

GraspChooser::GraspChooser(std::shared_ptr<const RobotModel> robot, std::shared_ptr<const HandKit> kit, ObjectLibrary library,
                           const ChoiceSettings& settings)
    : robot_(std::move(robot)), kit_(std::move(kit)), library_(std::move(library)), settings_(settings) {
  arm_ = &robot_->require_group("arm");
  hand_ = &robot_->require_group("hand");
  if (arm_->tip < 0 || arm_->tip != robot_->tool_link()) {
    throw ConfigError("robot " + robot_->name() + ": the arm's tip_link must be the tool_link, the palm of the hand");
  }
  const std::vector<Axis>& axes = kit_->hand.model().axes();
  bool same = axes.size() == hand_->axes.size();
  for (std::size_t i = 0; same && i < axes.size(); ++i)
    same = robot_->axes()[static_cast<std::size_t>(hand_->axes[i])].name == axes[i].name;
  if (!same) {
    throw ConfigError("robot " + robot_->name() + ": its group \"hand\" must list the joints of hand " + kit_->hand.name() +
                      " in the order of its fingers");
  }
  retreats_ = retreat_ways(kit_->hand);
}

struct GraspChooser::Search {
  Search(const GraspChooser& chooser, const GraspRequest& r, const Graspable& g, const Scene& s, const HumanState& everybody,
         const TransferTable* table)
      : self(chooser), request(r), object(g), scene(s), people(everybody), pairs(table), world(*chooser.robot_, chooser.library_) {
    for (const SceneObject& o : scene.objects) {
      if (o.id == request.object) T_world_object = o.T_world_object;
    }
    T_root_world = scene.T_world_base.inverse();
    world.set_base(scene.T_world_base);
    world.set_scene(scene);
    world.set_people(people);
    world.set_attachment({}, {request.object});
    const auto person =
        std::find_if(people.people.begin(), people.people.end(), [&](const Person& p) { return p.id == request.for_human; });
    if (person == people.people.end()) return;
    plan_exchange(*person);
    const auto arm = human_arm(*person, Side::right);
    if (pairs != nullptr && arm)
      places.emplace(*person, *arm, scene.T_world_base.translation(), T_world_object.linear(), object.box().center());
  }

  const RobotModel& robot() const { return *self.robot_; }
  const ChoiceSettings& settings() const { return self.settings_; }

  /// A middle place for the exchange: before the person's chest, on the side of the robot. Whoever carries the task out chooses the real
  /// one.
  void plan_exchange(const Person& person) {
    const int torso = body_joint_index("torso"), shoulder = body_joint_index("r_shoulder");
    if (static_cast<int>(person.joints.size()) <= std::max(torso, shoulder)) return;
    exchange_place = person.joints[static_cast<std::size_t>(torso)].position;
    Vector3 to_robot = scene.T_world_base.translation() - exchange_place;
    to_robot.z() = 0;
    if (to_robot.norm() < 0.3) return;
    to_robot.normalize();
    exchange_place += kExchangeAhead * to_robot;
    exchange_place.z() = person.joints[static_cast<std::size_t>(shoulder)].position.z() - kExchangeBelow;
    to_person = -to_robot;
    exchange_known = true;
  }

  /// Where and how the object can be handed over in this grasp, the robot free of everything but the person's arms.
  std::optional<TransferPose> transfer(std::size_t index, const Grasp& g) {
    if (out.transfer_reaches >= kTransferBudget) return std::nullopt;
    if (!held) {
      held.emplace(robot(), self.library_);
      held->set_base(scene.T_world_base);
      held->set_scene(scene);
      held->set_people(people, PeopleParts::without_forearms_and_hands);
    }
    held->set_attachment({request.object, g.T_object_hand.inverse()}, {});
    const auto try_reach = [&](const Pose&, const Pose& T_world_hand) -> std::optional<Vector> {
      ++out.transfer_reaches;
      auto q = inverse(T_world_hand, request.start, 0);
      if (!q) return q;
      ++out.states;
      if (!held->is_free(with_hand(robot(), request.start, *self.arm_, *q, *self.hand_, g.hand_joints))) q.reset();
      return q;
    };
    return places->best(*pairs, index, g.T_object_hand, try_reach, kTransferReaches);
  }

  /// How well the hand stays behind the object, [0, 1], in the best heading the arm can hold it out in; -1 when it cannot.
  double exchange(const Grasp& g, const Vector& arm_q) {
    double best = -1;
    for (int k = 0; k < kExchangeHeadings; ++k) {
      Pose T_world_held = Pose::Identity();
      T_world_held.linear() = Eigen::AngleAxisd(2 * std::numbers::pi * k / kExchangeHeadings, Vector3::UnitZ()) * T_world_object.linear();
      T_world_held.translation() = exchange_place;
      const Pose T_world_hand = T_world_held * g.T_object_hand;
      const double behind = (exchange_place - T_world_hand.translation()).normalized().dot(to_person);
      if (behind < 0 || behind <= best) continue;
      if (reach(T_world_hand, RobotModel::with(request.start, *self.arm_, arm_q), 1)) best = behind;
    }
    return best;
  }

  bool below_support(const Pose& T_world_hand, const Grasp& g) {
    self.kit_->forward(g.hand_joints, T_closed);
    self.kit_->forward(g.pregrasp_joints, T_open);
    for (const auto* T : {&T_closed, &T_open}) {
      for (const HandShape::Low& low : self.kit_->shape.lows(*T, T_world_hand)) {
        for (const SceneBox& box : scene.boxes) {
          if (!box.supports) continue;
          const Vector3 local = box.T_world_box.inverse() * low.middle;
          const double top = (box.T_world_box * Vector3(0, 0, 0.5 * box.size.z())).z();
          const bool over = std::abs(local.x()) < 0.5 * box.size.x() && std::abs(local.y()) < 0.5 * box.size.y();
          if (over && T_world_object.translation().z() > top - 0.02 && low.height < top + settings().support_gap) return true;
        }
      }
    }
    return false;
  }

  std::optional<Vector> reach(const Pose& T_world_hand, const Vector& seed, int restarts) {
    ++out.reaches;
    return inverse(T_world_hand, seed, restarts);
  }

  std::optional<Vector> inverse(const Pose& T_world_hand, const Vector& seed, int restarts) const {
    IkOptions options;
    options.max_iterations = 80;
    options.restarts = restarts;
    options.random_seed = request.seed + 1;
    return robot().inverse(*self.arm_, T_root_world * T_world_hand, seed, options);
  }

  bool free(const Vector& arm_q, const Vector& hand_q) {
    ++out.states;
    return world.is_free(with_hand(robot(), request.start, *self.arm_, arm_q, *self.hand_, hand_q));
  }

  /// The straight way from approach_q to grasp_q with the hand opened: nothing touched, the object neither.
  bool way_in_free(const Vector& approach_q, const Vector& grasp_q, const Grasp& g) {
    const Vector from = with_hand(robot(), request.start, *self.arm_, approach_q, *self.hand_, g.pregrasp_joints);
    const Vector to = with_hand(robot(), request.start, *self.arm_, grasp_q, *self.hand_, g.pregrasp_joints);
    const int steps = static_cast<int>(std::ceil(settings().stand_off / kSweepStep));
    const Pose T_object_root = T_world_object.inverse() * scene.T_world_base;
    for (int i = 0; i <= steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      const Pose T_object_hand = T_object_root * robot().link_pose(from + share * (to - from), robot().tool_link());
      ++out.touch_tests;
      const double clearance = i == steps ? 0.5 * settings().approach_clearance : settings().approach_clearance;
      if (self.kit_->shape.touches(T_open, object, T_object_hand, clearance)) return false;
    }
    out.states += static_cast<std::uint64_t>(motion_states(from, to, 0.04));
    return world.check_motion(from, to, 0.04).free;
  }

  std::optional<Vector> approach(const Pose& T_world_hand, const Vector& grasp_q, const Grasp& g) {
    std::vector<Vector3> ways = self.retreats_;
    ways.push_back(T_world_hand.linear().transpose() * Vector3::UnitZ());
    for (const Vector3& way : ways) {
      if (!retreat_free(*self.kit_, T_open, object, g.T_object_hand, way, settings().stand_off, settings().approach_clearance,
                        &out.touch_tests)) {
        continue;
      }
      Pose T = T_world_hand;
      T.translate(Vector3(settings().stand_off * way));
      const auto q = reach(T, with_hand(robot(), request.start, *self.arm_, grasp_q, *self.hand_, g.pregrasp_joints), 0);
      if (!q || (*q - grasp_q).cwiseAbs().maxCoeff() > kLargestApproach) continue;
      if (way_in_free(*q, grasp_q, g)) return q;
    }
    return std::nullopt;
  }

  ChoiceReason consider(const ListedGrasp& listed, Grasp& g) {
    const Pose T_world_hand = T_world_object * listed.grasp.T_object_hand;
    if (below_support(T_world_hand, listed.grasp)) return ChoiceReason::below_support;
    const auto grasp_q = reach(T_world_hand, request.start, 2);
    if (!grasp_q) return ChoiceReason::out_of_reach;
    g = listed.grasp;
    if (!free(*grasp_q, g.hand_joints) || !free(*grasp_q, g.pregrasp_joints)) return ChoiceReason::collision;
    Pose T_lifted = T_world_hand;
    T_lifted.translation().z() += settings().lift;
    const auto lifted = reach(T_lifted, RobotModel::with(request.start, *self.arm_, *grasp_q), 0);
    if (!lifted || (*lifted - *grasp_q).cwiseAbs().maxCoeff() > kLargestLift) return ChoiceReason::cannot_lift;
    if (!free(*lifted, g.hand_joints)) return ChoiceReason::cannot_lift;
    const auto approach_q = approach(T_world_hand, *grasp_q, g);
    if (!approach_q) return ChoiceReason::no_approach;
    g.arm_joints = *grasp_q;
    g.approach_joints = *approach_q;
    return ChoiceReason::chosen;
  }

  /// What can be said of a grasp before the arm is looked at.
  double rank(const ListedGrasp& listed, std::size_t index) const {
    const double fingers = static_cast<double>(self.kit_->chains.size());
    double sum =
        settings().rank_quality * listed.grasp.quality + settings().rank_contacts * static_cast<double>(touching(listed.grasp)) / fingers;
    sum += settings().rank_sturdy * std::clamp(listed.grasp.margin / settings().sturdy_margin, -2.0, 1.0);
    if (request.for_human.empty()) return sum;
    sum += settings().rank_room * listed.room;
    return places ? sum + settings().rank_partner * pairs->promise(index) : sum;
  }

  const GraspChooser& self;
  const GraspRequest& request;
  const Graspable& object;
  const Scene& scene;
  const HumanState& people;
  const TransferTable* pairs;
  CollisionWorld world;
  Pose T_world_object{Pose::Identity()}, T_root_world{Pose::Identity()};
  Vector3 to_person{Vector3::Zero()}, exchange_place{Vector3::Zero()};
  bool exchange_known{};
  std::optional<TransferPlaces> places;
  std::optional<CollisionWorld> held;  // with the object in the hand
  std::vector<std::vector<Pose>> T_closed, T_open;
  Choice out;
};

Choice GraspChooser::choose(const GraspRequest& request, const GraspList& list, const Graspable& object, const Scene& scene,
                            const HumanState& people, const std::function<bool()>& cancelled, const TransferTable* pairs) const {
  Search search(*this, request, object, scene, people, pairs);
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < list.grasps.size(); ++i) order.emplace_back(search.rank(list.grasps[i], i), i);
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  struct Found {
    double rank;
    Grasp grasp;
    std::optional<TransferPose> transfer;
  };
  std::vector<Found> found;
  // Twice as many as asked for, so that the arm's posture has a say.
  const std::size_t enough = 2 * static_cast<std::size_t>(std::max(1U, request.max_grasps));
  const auto consider = [&](double rank, std::size_t index, std::optional<TransferPose> transfer) {
    const bool stop = found.size() >= enough || search.out.reaches >= settings_.reach_budget || (cancelled && cancelled());
    Grasp grasp;
    const ChoiceReason reason = stop ? ChoiceReason::not_considered : search.consider(list.grasps[index], grasp);
    ++search.out.reasons[static_cast<std::size_t>(reason)];
    if (reason != ChoiceReason::chosen) return;
    double whole = rank + settings_.rank_posture * posture_score(*robot_, *arm_, grasp.arm_joints);
    if (transfer) {
      whole += settings_.rank_exchange * transfer->score + settings_.rank_transfer;
    } else if (search.exchange_known) {
      whole += settings_.rank_exchange * search.exchange(grasp, grasp.arm_joints);
    }
    found.push_back({whole, std::move(grasp), std::move(transfer)});
  };
  // For a person, those that can be handed over come first; the others only when too few of them can be picked up.
  std::vector<std::pair<double, std::size_t>> others;
  std::size_t tries = 0;
  for (const auto& [rank, index] : order) {
    if (!search.places) {
      consider(rank, index, {});
      continue;
    }
    const Grasp& g = list.grasps[index].grasp;
    std::optional<TransferPose> transfer;
    const bool try_it = found.size() < enough && tries < kTransferTries * enough && !pairs->partners(index).empty();
    if (try_it && !search.below_support(search.T_world_object * g.T_object_hand, g)) {
      ++tries;
      transfer = search.transfer(index, g);
    }
    if (transfer) {
      consider(rank, index, std::move(transfer));
    } else {
      others.emplace_back(rank, index);
    }
  }
  for (const auto& [rank, index] : others) consider(rank, index, {});
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.rank > b.rank; });
  // One of each kind first: when the best fails, the next should be different.
  const auto known = [&](const Found& f, const std::vector<Found>& among) {
    return std::any_of(among.begin(), among.end(), [&](const Found& g) { return alike(g.grasp.T_object_hand, f.grasp.T_object_hand); });
  };
  std::vector<Found> ordered, again;
  for (Found& f : found) (known(f, ordered) ? again : ordered).push_back(std::move(f));
  std::move(again.begin(), again.end(), std::back_inserter(ordered));
  if (ordered.size() > request.max_grasps) ordered.resize(request.max_grasps);
  for (Found& f : ordered) {
    search.out.grasps.push_back(std::move(f.grasp));
    if (search.places) search.out.transfers.push_back(std::move(f.transfer));
  }
  return search.out;
}

}  // namespace handsel::grasp_planner
