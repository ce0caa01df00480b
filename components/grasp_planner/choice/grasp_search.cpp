// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/choice/grasp_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "common/cost/person_frame.hpp"
#include "common/model/human/holding_hand.hpp"
#include "common/model/object_extent.hpp"
#include "common/model/platform.hpp"
#include "components/grasp_planner/pair/double_grasp.hpp"
#include "components/grasp_planner/pair/retreat.hpp"

namespace handsel::grasp_planner {
namespace {

constexpr double kMotionStep = 0.04;  // [rad] between two checked states

std::size_t touching(const Grasp& g) {
  std::set<std::uint32_t> fingers;
  for (const Contact& c : g.contacts) fingers.insert(c.finger);
  return fingers.size();
}

bool something_at_goal(const ChoiceInputs& inputs, const ObjectLibrary& library) {
  const Scene& scene = inputs.scene;
  const auto touched = [&](const Shape& shape, const Pose& T_world_shape) {
    return touch(*CollisionShape::make(shape), T_world_shape, *inputs.object.shape(),
                 inputs.request.T_world_goal);
  };
  const bool furniture =
      std::any_of(scene.boxes.begin(), scene.boxes.end(), [&](const SceneBox& box) {
        const double slack = box.supports ? std::min(kSupportSlack, 0.5 * box.size.z()) : 0.0;
        return touched(Box{box.size - Vector3(0, 0, slack)},
                       box.T_world_box * Eigen::Translation3d(0, 0, -0.5 * slack));
      });
  return furniture ||
         std::any_of(scene.objects.begin(), scene.objects.end(), [&](const SceneObject& o) {
           if (o.id == inputs.request.object || o.holder == Holder::robot ||
               o.holder == Holder::human)
             return false;
           const ObjectModel* model = library ? library(o.model) : nullptr;
           if (model != nullptr)
             return touched(std::make_shared<const TriangleMesh>(model->mesh), o.T_world_object);
           const auto shape = primitive_shape(o.primitive, 0);
           return shape && touched(*shape, o.T_world_object);
         });
}

}  // namespace

GraspChooser::Search::Search(const GraspChooser& chooser, const ChoiceInputs& given)
    : self(chooser),
      inputs(given),
      hand(*chooser.hand_geometry_, given.object, chooser.settings_.support_gap),
      scene(given.scene),
      start{Pose::Identity(), CollisionWorld(*chooser.robot_, chooser.library_)} {
  const ObjectModel* held_object = nullptr;
  for (const SceneObject& o : scene.objects) {
    if (o.id != inputs.request.object) continue;
    start.T_world_object = o.T_world_object;
    if (o.holder == Holder::human) holder = o.holder_id;
    if (chooser.library_ && !o.model.empty()) held_object = chooser.library_(o.model);
  }
  const auto prepare = [&](CollisionWorld& world, const Scene& with) {
    world.set_scene(with);
    world.set_people(inputs.people);
    world.set_attachment({}, {inputs.request.object});
  };
  prepare(start.world, scene);
  if (!holder.empty()) {
    HumanState around = inputs.people;
    for (Person& p : around.people) {
      if (p.id != holder) continue;
      std::vector<HandPart> digits;
      if (held_object != nullptr) digits = assumed_digits(p, *held_object, start.T_world_object);
      for (HandPart& part : digits) part.radius += p.inflation;
      p = with_fingers_bent(p, start.T_world_object.translation());
      p.inflation += settings().off_fingers;
      holder_body.emplace(p, start.T_world_object, std::move(digits));
      holder_body->set_digit_clearance(settings().off_digits);
    }
    start.world.set_people(around);
    for (Person& p : around.people) {
      if (p.id == holder) p.inflation += settings().off_giver - settings().off_fingers;
    }
    giver.emplace(robot(), self.library_);
    giver->set_people(around, PeopleParts::without_forearms_and_hands);
    giver->set_attachment({}, {inputs.request.object});
  }
  if (inputs.request.has_goal) {
    Scene then = scene;
    for (SceneObject& o : then.objects) {
      if (o.id == inputs.request.object) o.T_world_object = inputs.request.T_world_goal;
    }
    goal.emplace(Site{inputs.request.T_world_goal, CollisionWorld(robot(), self.library_)});
    prepare(goal->world, then);
    carrying.emplace(robot(), self.library_);
    prepare(*carrying, scene);
    goal_is_taken = something_at_goal(inputs, self.library_);
  }
  const std::vector<Person>& people = inputs.people.people;
  const auto found = std::find_if(people.begin(), people.end(), [&](const Person& p) {
    return p.id == inputs.request.for_human;
  });
  if (found != people.end()) person = &*found;
  stand(scene.T_world_base);
}

Vector3 GraspChooser::Search::p_world_robot() const {
  return T_world_platform(robot(), inputs.request.start, scene.T_world_base).translation();
}

void GraspChooser::Search::stand(const Pose& T_world_base) {
  scene.T_world_base = T_world_base;
  T_root_world = T_world_base.inverse();
  start.world.set_base(T_world_base);
  if (goal) goal->world.set_base(T_world_base);
  if (carrying) carrying->set_base(T_world_base);
  if (held) held->set_base(T_world_base);
  if (giver) giver->set_base(T_world_base);
  places.reset();
  eye.reset();
  if (person == nullptr) {
    if (robot().gaze_link() >= 0)
      eye =
          T_world_base * robot().link_pose(inputs.request.start, robot().gaze_link()).translation();
    return;
  }
  if (const auto sight = sight_of(*person)) eye = sight->eyes;
  plan_handover();
  const auto arm = human_arm(*person, Side::right);
  if (inputs.pairs != nullptr && arm)
    places.emplace(*person, *arm, p_world_robot(), start.T_world_object.linear(),
                   inputs.object.box().center());
}

// Sets a nominal handover place before the person's chest, on the side of the robot. The task
// itself chooses the actual place later.
void GraspChooser::Search::plan_handover() {
  handover_point.reset();
  const BodyJoint *torso = find_joint(*person, "torso"),
                  *shoulder = find_joint(*person, "r_shoulder");
  if (torso == nullptr || shoulder == nullptr) return;
  Vector3 place = torso->position;
  Vector3 to_robot = p_world_robot() - place;
  to_robot.z() = 0;
  if (to_robot.norm() < 0.3) return;
  to_robot.normalize();
  place += settings().handover_ahead * to_robot;
  place.z() = shoulder->position.z() - settings().handover_below;
  handover_point = HandoverPoint{place, -to_robot};
}

double GraspChooser::Search::rank(const ListedGrasp& listed, std::size_t index) const {
  const double fingers = static_cast<double>(self.hand_geometry_->chains.size());
  double sum = settings().rank_quality * listed.grasp.quality +
               settings().rank_contacts * static_cast<double>(touching(listed.grasp)) / fingers;
  sum += settings().rank_sturdy *
         std::clamp(listed.grasp.margin / settings().sturdy_margin, -2.0, 1.0);
  if (!holder.empty())
    sum += settings().rank_away * on_our_side(listed.grasp) +
           (hand.stands_in(listed.grasp) ? settings().rank_stands : 0.0);
  if (inputs.request.for_human.empty()) return sum;
  sum += settings().rank_room * listed.room;
  return places ? sum + settings().rank_partner * inputs.pairs->promise(index) : sum;
}

std::optional<TransferPose> GraspChooser::Search::transfer(std::size_t index, const Grasp& g,
                                                           double tilt) {
  if (out.transfer_reaches >= transfer_budget) return std::nullopt;
  if (!held) {
    held.emplace(robot(), self.library_);
    held->set_scene(scene);
    held->set_base(scene.T_world_base);
    held->set_people(inputs.people, PeopleParts::without_forearms_and_hands);
  }
  held->set_attachment({inputs.request.object, g.T_object_hand.inverse()}, {});
  const auto try_reach = [&](const Pose&, const Pose& T_world_hand) -> std::optional<Vector> {
    ++out.transfer_reaches;
    auto q = inverse(T_world_hand, inputs.request.start, 0);
    if (q && !free(*held, *q, g.hand_joints)) q.reset();
    return q;
  };
  return places->best(*inputs.pairs, index, g.T_object_hand, tilt, try_reach,
                      static_cast<int>(settings().transfer_reaches));
}

GraspChooser::Search::HandoverPlace GraspChooser::Search::handover(const Grasp& g,
                                                                   const Vector& arm_q) {
  const auto& [handover_place, to_person] = *handover_point;
  HandoverPlace best;
  best.T_world_object = start.T_world_object;
  best.T_world_object.translation() = handover_place;
  const int headings = static_cast<int>(settings().handover_headings);
  for (int k = 0; k < headings; ++k) {
    Pose T_world_held = Pose::Identity();
    T_world_held.linear() =
        Eigen::AngleAxisd(2 * std::numbers::pi * k / headings, Vector3::UnitZ()) *
        start.T_world_object.linear();
    T_world_held.translation() = handover_place;
    const Pose T_world_hand = T_world_held * g.T_object_hand;
    const double behind = (handover_place - T_world_hand.translation()).normalized().dot(to_person);
    if (behind < 0 || behind <= best.behind) continue;
    if (reach(T_world_hand, RobotModel::with(inputs.request.start, *self.manipulator_.arm, arm_q),
              1))
      best = {behind, T_world_held};
  }
  return best;
}

double GraspChooser::Search::visible(const Grasp& g, const Pose& T_world_object) {
  return eye ? hand.visible(g, T_world_object.inverse() * *eye) : 1;
}

bool GraspChooser::Search::below_support(const Grasp& g) {
  return hand.below_support(scene.boxes, start.T_world_object, g);
}

Vector GraspChooser::Search::whole(const Vector& arm_q, const Vector& hand_q) const {
  return RobotModel::with(RobotModel::with(inputs.request.start, *self.manipulator_.arm, arm_q),
                          *self.manipulator_.fingers, hand_q);
}

std::optional<Vector> GraspChooser::Search::reach(const Pose& T_world_hand, const Vector& seed,
                                                  int restarts) {
  ++out.reaches;
  return inverse(T_world_hand, seed, restarts);
}

std::optional<Vector> GraspChooser::Search::inverse(const Pose& T_world_hand, const Vector& seed,
                                                    int restarts) const {
  IkOptions options;
  options.max_iterations = 80;
  options.restarts = restarts;
  options.random_seed = inputs.request.seed + 1;
  return robot().inverse(*self.manipulator_.arm, T_root_world * T_world_hand, seed, options);
}

bool GraspChooser::Search::free(CollisionWorld& world, const Vector& arm_q, const Vector& hand_q) {
  ++out.states;
  return world.is_free(whole(arm_q, hand_q));
}

// Returns whether the open hand touches neither the object, nor the hand that holds the object,
// nor anything else on the straight motion from approach_q to grasp_q.
bool GraspChooser::Search::approach_free(Site& site, const Vector& approach_q,
                                         const Vector& grasp_q, const Grasp& g) {
  const Vector from = whole(approach_q, g.pregrasp_joints), to = whole(grasp_q, g.pregrasp_joints);
  const int steps = static_cast<int>(std::ceil(stand_off() / kSweepStep));
  const Pose T_object_root = site.T_world_object.inverse() * scene.T_world_base;
  const bool from_hand = holder_body.has_value() && &site == &start;
  for (int i = 0; i <= steps; ++i) {
    const double fraction = static_cast<double>(i) / steps;
    const Pose T_object_hand =
        T_object_root * robot().link_pose(from + fraction * (to - from), self.manipulator_.palm);
    ++out.touch_tests;
    const double clearance =
        i == steps ? 0.5 * settings().approach_clearance : settings().approach_clearance;
    if (self.hand_geometry_->shape.touches(T_open, inputs.object, T_object_hand, clearance))
      return false;
    if (from_hand) ++out.touch_tests;
    if (from_hand &&
        HandShape::hands_touch(self.hand_geometry_->shape.placed(T_open, T_object_hand),
                               holder_body->placed(), 0))
      return false;
  }
  out.states += static_cast<std::uint64_t>(motion_states(from, to, kMotionStep));
  return site.world.check_motion(from, to, kMotionStep).free;
}

double GraspChooser::Search::stand_off() const {
  return settings().stand_off - (holder.empty() ? 0.0 : settings().held_nearer);
}

// Returns the configuration at the start of the straight approach; sets T_open.
std::optional<Vector> GraspChooser::Search::approach(Site& site, const Vector& grasp_q,
                                                     const Grasp& g) {
  const Pose T_world_hand = site.T_world_object * g.T_object_hand;
  self.hand_geometry_->forward(g.pregrasp_joints, T_open);
  std::vector<Vector3> directions = self.retreats_;
  directions.push_back(T_world_hand.linear().transpose() * Vector3::UnitZ());
  for (const Vector3& direction : directions) {
    const RetreatPath path{direction, stand_off(), settings().approach_clearance};
    if (!retreat_free(*self.hand_geometry_, T_open, inputs.object, g.T_object_hand, path,
                      &out.touch_tests))
      continue;
    Pose T = T_world_hand;
    T.translate(Vector3(stand_off() * direction));
    auto q = reach(T, whole(grasp_q, g.pregrasp_joints), 0);
    if (!q || (*q - grasp_q).cwiseAbs().maxCoeff() > settings().max_approach_turn) continue;
    if (approach_free(site, *q, grasp_q, g)) return q;
  }
  return std::nullopt;
}

bool GraspChooser::Search::can_lift(const Pose& T_world_hand, const Vector& grasp_q,
                                    const Grasp& g) {
  Pose T_lifted = T_world_hand;
  T_lifted.translation().z() += settings().lift;
  const auto lifted =
      reach(T_lifted, RobotModel::with(inputs.request.start, *self.manipulator_.arm, grasp_q), 0);
  return lifted && (*lifted - grasp_q).cwiseAbs().maxCoeff() <= settings().max_lift_turn &&
         free(start.world, *lifted, g.hand_joints);
}

double GraspChooser::Search::on_our_side(const Grasp& g) const {
  const Vector3 to_robot = (p_world_robot() - start.T_world_object.translation())
                               .cwiseProduct(Vector3(1, 1, 0))
                               .stableNormalized();
  const Vector3 to_hand = start.T_world_object.linear() *
                          (g.T_object_hand.translation() - inputs.object.box().center());
  return 0.5 * (1 + to_hand.stableNormalized().dot(to_robot));
}

bool GraspChooser::Search::off_giver(const Vector& arm_q, const Grasp& g) {
  ++out.states;
  return giver->check_people(whole(arm_q, g.pregrasp_joints)).free;
}

GraspChooser::Search::Ranked GraspChooser::Search::ranked() {
  Ranked all;
  for (std::size_t i = 0; i < inputs.list.grasps.size(); ++i) {
    const Grasp& g = inputs.list.grasps[i].grasp;
    const bool can_hold = inputs.list.bears(g);
    if (can_hold || (!holder.empty() && g.margin >= settings().min_margin_held))
      (can_hold ? all.strong : all.weak).emplace_back(rank(inputs.list.grasps[i], i), i);
    else
      ++out.reasons[static_cast<std::size_t>(ChoiceReason::too_weak)];
  }
  for (Ranking* ranking : {&all.strong, &all.weak})
    std::stable_sort(ranking->begin(), ranking->end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
  return all;
}

ChoiceReason GraspChooser::Search::pick_up(Grasp& g) {
  if (holder_body && hand.touches(holder_body->placed(), g, out.touch_tests)) {
    if (!out.contacts.is_full()) out.contacts.add("the hand and that of " + holder);
    return ChoiceReason::collision;
  }
  const Pose T_world_hand = start.T_world_object * g.T_object_hand;
  const auto grasp_q = reach(T_world_hand, inputs.request.start, 2);
  if (!grasp_q) return ChoiceReason::out_of_reach;
  for (const Vector* fingers : {&g.hand_joints, &g.pregrasp_joints}) {
    if (free(start.world, *grasp_q, *fingers)) continue;
    if (!out.contacts.is_full()) {
      const CollisionVerdict verdict = start.world.check(whole(*grasp_q, *fingers));
      out.contacts.add(verdict.first + " and " + verdict.second);
    }
    return ChoiceReason::collision;
  }
  if (holder.empty() && !can_lift(T_world_hand, *grasp_q, g)) return ChoiceReason::cannot_lift;
  const auto approach_q = approach(start, *grasp_q, g);
  if (!approach_q) return ChoiceReason::no_approach;
  if (giver && (!off_giver(*grasp_q, g) || !off_giver(*approach_q, g)))
    return ChoiceReason::near_giver;
  g.arm_joints = *grasp_q;
  g.approach_joints = *approach_q;
  return ChoiceReason::chosen;
}

ChoiceReason GraspChooser::Search::put_down(const Grasp& g, PuttingDown& down) {
  const Pose T_world_hand = goal->T_world_object * g.T_object_hand;
  const auto at =
      reach(T_world_hand,
            RobotModel::with(inputs.request.start, *self.manipulator_.arm, g.arm_joints), 2);
  if (!at) return ChoiceReason::goal_out_of_reach;
  carrying->set_attachment({inputs.request.object, g.T_object_hand.inverse()}, {});
  if (!free(*carrying, *at, g.hand_joints) || !free(goal->world, *at, g.pregrasp_joints))
    return ChoiceReason::goal_collision;
  Pose T_above = T_world_hand;
  T_above.translation().z() += settings().lift;
  const auto above =
      reach(T_above, RobotModel::with(inputs.request.start, *self.manipulator_.arm, *at), 0);
  if (!above || (*above - *at).cwiseAbs().maxCoeff() > settings().max_lift_turn)
    return ChoiceReason::goal_lowering;
  const Vector from = whole(*above, g.hand_joints), to = whole(*at, g.hand_joints);
  out.states += static_cast<std::uint64_t>(motion_states(from, to, kMotionStep));
  if (!carrying->check_motion(from, to, kMotionStep).free) return ChoiceReason::goal_lowering;
  const auto off = approach(*goal, *at, g);
  if (!off) return ChoiceReason::goal_leaving;
  down = {*above, *at, *off};
  return ChoiceReason::chosen;
}

ChoiceReason GraspChooser::Search::consider(const Grasp& listed, Found& found) {
  if (below_support(listed)) return ChoiceReason::below_support;
  if (goal_is_taken) return ChoiceReason::goal_taken;
  if (goal && hand.below_support(scene.boxes, goal->T_world_object, listed))
    return ChoiceReason::goal_support;
  Grasp& g = found.grasp;
  g = listed;
  const auto hidden = [&](const Pose& T_world_object) {
    g.visible = visible(g, T_world_object);
    return g.visible < inputs.request.min_visible;
  };
  // The person's view of the handover place is known only after the arm has reached the grasp.
  const bool seen_later = person != nullptr && !found.transfer;
  if (!seen_later && inputs.request.min_visible > 0 &&
      hidden(found.transfer ? found.transfer->T_world_object : start.T_world_object))
    return ChoiceReason::hidden;
  const ChoiceReason taken = pick_up(g);
  if (taken != ChoiceReason::chosen) return taken;
  if (goal) {
    const ChoiceReason put = put_down(g, found.goal);
    if (put != ChoiceReason::chosen) return put;
  }
  found.rank +=
      settings().rank_configuration * rest_score_of(robot(), *self.manipulator_.arm, g.arm_joints);
  Pose T_world_seen = start.T_world_object;
  if (found.transfer) {
    found.rank += settings().rank_handover * found.transfer->score + settings().rank_transfer -
                  settings().rank_tilt * found.transfer->tilt;
    T_world_seen = found.transfer->T_world_object;
  } else if (handover_point) {
    const HandoverPlace at = handover(g, g.arm_joints);
    found.rank += settings().rank_handover * at.behind;
    T_world_seen = at.T_world_object;
  }
  if (g.visible <= 0 && hidden(T_world_seen)) return ChoiceReason::hidden;
  if (person != nullptr) found.rank += settings().rank_visible * g.visible;
  return ChoiceReason::chosen;
}

}  // namespace handsel::grasp_planner
