// SPDX-License-Identifier: Apache-2.0
#include "sim/people/free_grasp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/geometry/segments.hpp"
#include "common/model/object_surface.hpp"

namespace handsel::sim {

namespace {

constexpr double kTilts[] = {0.0, -0.45, 0.45};  // of the hand about the axis across it [rad]
constexpr double kShifts[] = {0.0, 0.03};        // of the hand against its fingers' direction [m]
constexpr int kApproachSteps = 4;                // number of poses tested before the grasp
constexpr double kDifference = 1e-4;             // step of the finite differences [m]
constexpr int kLeanSteps = 8;                    // number of leans tested

/// Returns directions spread evenly over the sphere.
std::vector<Vector3> directions(int number) {
  std::vector<Vector3> out;
  for (int i = 0; i < number; ++i) {
    const double z = 1 - (2.0 * i + 1) / number, r = std::sqrt(1 - z * z),
                 turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    out.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return out;
}

/// Returns the points about which the hand is placed, world: the centre of mass and, of a long
/// extent, a point on either side.
std::vector<Vector3> anchors(const FreeGraspQuery& query, const FreeGraspSettings& settings) {
  Eigen::AlignedBox3d box;
  for (const Vector3& vertex : query.object->mesh.vertices) box.extend(vertex);
  std::vector<Vector3> out{query.T_world_object * query.object->com};
  const double min_length = query.p_left ? settings.giving_min_extent : settings.taking_min_extent;
  const auto off_middle = [&](double length) {
    return query.p_left
               ? std::min(settings.giving_off_middle * length, settings.giving_max_off_middle)
               : settings.taking_off_middle * length;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const double length = box.sizes()[axis];
    if (length < min_length) continue;
    for (const double side : {-1.0, 1.0}) {
      Vector3 p = query.object->com;
      p[axis] = box.center()[axis] + side * off_middle(length);
      out.push_back(query.T_world_object * p);
    }
  }
  return out;
}

/// Returns points of the surface, object frame, weighted by their area and by how near the points
/// are to the point `left` of a receiver, against the opposite end.
std::vector<std::pair<Vector3, double>> surface_left(const ObjectModel& object,
                                                     const Vector3& left) {
  constexpr std::size_t kSamples = 300;
  const TriangleMesh& mesh = object.mesh;
  const Vector3 axis = (left - object.com).stableNormalized();
  double length = 0;
  for (const Vector3& vertex : mesh.vertices) length = std::max(length, (left - vertex).dot(axis));
  const std::size_t step = 1 + mesh.triangles.size() / kSamples;
  std::vector<std::pair<Vector3, double>> out;
  for (std::size_t i = 0; length > 0 && i < mesh.triangles.size(); i += step) {
    const auto& t = mesh.triangles[i];
    const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vector3 middle = (a + b + c) / 3;
    const double nearness = std::clamp(1 - (left - middle).dot(axis) / length, 0.0, 1.0);
    out.emplace_back(middle, nearness * (b - a).cross(c - a).norm());
  }
  return out;
}

}  // namespace

FreeGraspSearch::FreeGraspSearch(const FreeGraspQuery& query, const HumanHand& shape,
                                 const FreeGraspSettings& settings)
    : query_(query),
      robot_(*query.robot),
      shape_(shape),
      settings_(settings),
      T_object_world_(query.T_world_object.inverse()),
      anchors_(anchors(query, settings)),
      directions_(directions(settings.taking_directions)) {
  if (query.p_left) surface_ = surface_left(*query.object, T_object_world_ * *query.p_left);
}

bool FreeGraspSearch::advance() {
  constexpr int kTests = 4;  // poses tested in a part
  if (over_) return true;
  if (!ordered_) {
    add_about(anchors_[next_ / directions_.size()], directions_[next_ % directions_.size()]);
    if (++next_ < anchors_.size() * directions_.size()) return false;
    std::sort(candidates_.begin(), candidates_.end(),
              [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
    ordered_ = true;
    next_ = 0;
    return false;
  }
  for (int i = 0; i < kTests && !over_; ++i) {
    if (next_ < candidates_.size()) consider(candidates_[next_++]);
    over_ =
        next_ == candidates_.size() || usable_ == (query_.p_left ? settings_.giving_choices : 1);
  }
  return over_;
}

/// Keeps a candidate that is usable and better than those before.
void FreeGraspSearch::consider(const Candidate& candidate) {
  if (is_avoided(candidate.T_world_hand)) return;
  const auto grasp = test(candidate);
  if (!grasp) return;
  ++usable_;
  const double cost = candidate.cost + settings_.giving_room_preference * covered(*grasp);
  if (found_ && cost >= min_cost_) return;
  found_ = grasp;
  min_cost_ = cost;
}

/// Returns the fraction of the surface near the hand, where a receiver has no room; the surface
/// counts the more, the nearer to the point that is left to the receiver. 0 without such a point.
double FreeGraspSearch::covered(const FreeGrasp& grasp) const {
  std::array<HandPart, kHandParts> hand = shape_.parts(grasp.closures);
  for (HandPart& part : hand) part = transformed(grasp.T_object_hand, part);
  double all = 0, near = 0;
  Vector3 on_part, on_sample;
  for (const auto& [p, weight] : surface_) {
    all += weight;
    const bool is_near = std::any_of(hand.begin(), hand.end(), [&, &at = p](const HandPart& part) {
      const double limit = part.radius + settings_.giving_finger_room;
      return nearest_points(part.a, part.b, at, at, on_part, on_sample) < limit * limit;
    });
    if (is_near) near += weight;
  }
  return all > 0 ? near / all : 0;
}

double FreeGraspSearch::distance(const Vector3& p_world) const {
  return surface_distance(*query_.object, T_object_world_ * p_world);
}

/// Returns the direction into the object near a point, unit.
Vector3 FreeGraspSearch::inward(const Vector3& p_world) const {
  Vector3 slope;
  for (int i = 0; i < 3; ++i) {
    const Vector3 step = kDifference * Vector3::Unit(i);
    slope[i] = distance(p_world - step) - distance(p_world + step);
  }
  return slope.stableNormalized();
}

/// Returns whether a part keeps the clearance from every part of the robot.
bool FreeGraspSearch::is_clear(const HandPart& part) const {
  Vector3 on_part, on_robot;
  return std::none_of(robot_.begin(), robot_.end(), [&](const HandPart& other) {
    const double limit = part.radius + other.radius + settings_.taking_clearance;
    return nearest_points(part.a, part.b, other.a, other.b, on_part, on_robot) < limit * limit;
  });
}

void FreeGraspSearch::add_about(const Vector3& anchor, const Vector3& direction) {
  constexpr double kOutside = 0.3;  // distance of the hand before the motion to the object [m]
  if (direction.dot(query_.preferred) < settings_.taking_min_side_cosine) return;
  const Vector3 first = direction.unitOrthogonal(), second = direction.cross(first);
  const int rolls = settings_.taking_rolls;
  for (int k = 0; k < rolls; ++k) {
    const double roll = 2 * std::numbers::pi * k / rolls;
    const Vector3 fingers = std::cos(roll) * first + std::sin(roll) * second;
    for (const double shift : kShifts) {
      const Vector3 start = anchor + kOutside * direction - shift * fingers;
      for (const double tilt : kTilts) add(start, direction, fingers, tilt);
    }
  }
}

/// Moves the hand from `start` against `direction` to the object and keeps the pose. For a person
/// who gives, adds poses with the palm off the object and square to it: givers use precision grips,
/// which leave the receiver more of the object.
void FreeGraspSearch::add(const Vector3& start, const Vector3& direction, const Vector3& fingers,
                          double tilt) {
  constexpr double kFar = 0.4;  // max length of the motion [m]
  double moved = 0, beyond = distance(start) - kPalmDistance;
  for (int i = 0; i < 40 && moved < kFar && beyond > 5e-4; ++i) {
    moved += beyond;
    beyond = distance(start - moved * direction) - kPalmDistance;
  }
  if (beyond > 5e-4) return;  // the motion misses the object
  Pose T = Pose::Identity();
  T.linear() << -direction, fingers.cross(-direction), fingers;
  T.linear() = T.linear() * Eigen::AngleAxisd(tilt, Vector3::UnitY()).toRotationMatrix();
  T.translation() = start - moved * direction;
  const double near_left = query_.p_left
                               ? std::max(0.0, 1 - (T.translation() - *query_.p_left).norm() /
                                                       settings_.giving_room_distance)
                               : 0.0;
  add_candidate({T, 0, 0, true}, direction, near_left);
  if (!query_.p_left || settings_.giving_palm_gap <= 0 || tilt != 0) return;
  for (int i = 1; i <= settings_.giving_palm_gaps; ++i) {
    T.translation() += settings_.giving_palm_gap / settings_.giving_palm_gaps * direction;
    add_candidate({T, 0, 0, false}, direction, near_left);
  }
}

/// Keeps a pose of the hand, with the palm's normal against `direction`, if the arm reaches it.
/// `near_left`: how near the held part is to the point that is left to a receiver, [0, 1].
void FreeGraspSearch::add_candidate(Candidate candidate, const Vector3& direction,
                                    double near_left) {
  if (query_.beside &&
      (candidate.T_world_hand.translation() - query_.T_world_object * query_.object->com)
              .dot(*query_.beside) < settings_.taking_both_min_beside)
    return;
  Pose T_wrist = candidate.T_world_hand;
  T_wrist.translation() -= query_.wrist * T_wrist.linear().col(2);
  const auto posture = wrist_posture(leaning_to(T_wrist.translation()), T_wrist);
  if (!posture || posture->strain > settings_.taking_max_strain) return;
  const double beside = (1 - direction.dot(query_.preferred)) / 2;
  candidate.strain = posture->strain;
  candidate.cost = posture->strain + settings_.taking_side_preference * beside +
                   settings_.giving_room_preference * near_left;
  candidates_.push_back(candidate);
}

/// Returns the arm of the person who leans as far as the wrist's position needs.
HumanArm FreeGraspSearch::leaning_to(const Vector3& p_wrist) const {
  HumanArm arm = query_.arm;
  for (int i = 0; i <= kLeanSteps; ++i) {
    const double lean = i * settings_.taking_place_max_lean / kLeanSteps;
    arm.shoulder = query_.arm.shoulder + query_.trunk * (std::sin(lean) * query_.forward +
                                                         (std::cos(lean) - 1) * Vector3::UnitZ());
    if ((p_wrist - arm.shoulder).norm() <= settings_.taking_stretch * (arm.upper + arm.forearm))
      break;
  }
  return arm;
}

std::optional<FreeGrasp> FreeGraspSearch::test(const Candidate& candidate) const {
  const Pose& T = candidate.T_world_hand;
  for (const HandPart& part : shape_.palm()) {
    const HandPart there = transformed(T, part);
    if (surface_distance(*query_.object, transformed(T_object_world_, there)) <
            -settings_.taking_palm_overlap ||
        !is_clear(there))
      return std::nullopt;
  }
  FreeGrasp grasp{T_object_world_ * T, {}, 0, candidate.strain};
  Vector3 of_fingers = Vector3::Zero(), of_thumb = Vector3::Zero();
  std::array<std::optional<double>, kDigits> contacts;
  for (int d = 0; d < kDigits; ++d) {
    const auto contact = first_contact(shape_, d, *query_.object, grasp.T_object_hand);
    if (contact && contact->distance < -settings_.taking_digit_overlap) return std::nullopt;
    if (contact) contacts[d] = contact->closure;
    if (!contact || !can_close(T, d, contact->closure)) continue;
    grasp.closures[d] = contact->closure;
    ++grasp.digits_in_contact;
    (d == 0 ? of_thumb : of_fingers) += inward(query_.T_world_object * contact->p_object);
  }
  for (int d = 0; d < kDigits; ++d) {
    const double closure = contacts[d] ? 0 : free_closure(d, contacts);
    if (closure > 0 && can_close(T, d, closure)) grasp.closures[d] = closure;
  }
  const Vector3 palm = T.linear().col(0), fingers = of_fingers.stableNormalized();
  const bool is_enclosed =
      of_thumb.dot(fingers) < -settings_.taking_min_opposition ||
      (candidate.palm_touches && fingers.dot(palm) < -settings_.taking_min_opposition);
  if (grasp.digits_in_contact < settings_.taking_min_digits || !is_enclosed || !can_come(T))
    return std::nullopt;
  return grasp;
}

/// Returns whether a digit closes without touching the robot.
bool FreeGraspSearch::can_close(const Pose& T_world_hand, int digit, double closure) const {
  const int steps = static_cast<int>(std::ceil(closure * kClosureSteps));
  for (int i = 0; i <= steps; ++i) {
    const double c = std::min(closure, static_cast<double>(i) / kClosureSteps);
    for (const HandPart& part : shape_.digit(digit, c)) {
      if (!is_clear(transformed(T_world_hand, part))) return false;
    }
  }
  return true;
}

/// Returns whether the open hand comes straight to the pose without touching the robot.
bool FreeGraspSearch::can_come(const Pose& T_world_hand) const {
  for (int i = 0; i <= kApproachSteps; ++i) {
    Pose before = T_world_hand;
    before.translation() -=
        i * settings_.taking_approach / kApproachSteps * T_world_hand.linear().col(0);
    for (const HandPart& part : shape_.parts({})) {
      if (!is_clear(transformed(before, part))) return false;
    }
  }
  return true;
}

/// Returns whether a pose is a place that was held before in vain.
bool FreeGraspSearch::is_avoided(const Pose& T_world_hand) const {
  const Pose T = T_object_world_ * T_world_hand;
  return std::any_of(query_.avoided.begin(), query_.avoided.end(), [&](const Pose& before) {
    return (T.translation() - before.translation()).norm() < settings_.giving_other_min_distance &&
           T.linear().col(0).dot(before.linear().col(0)) > settings_.giving_other_max_cosine;
  });
}

std::optional<FreeGrasp> find_free_grasp(const FreeGraspQuery& query, const HumanHand& shape,
                                         const FreeGraspSettings& settings) {
  FreeGraspSearch search(query, shape, settings);
  while (!search.advance()) {
  }
  return search.found();
}

}  // namespace handsel::sim
