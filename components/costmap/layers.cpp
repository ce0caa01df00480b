// SPDX-License-Identifier: Apache-2.0
#include "components/costmap/layers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/cost/person_frame.hpp"
#include "common/cost/reach_check.hpp"
#include "components/costmap/layer_kernel.hpp"

namespace handsel::costmap {
namespace {

enum Layer { kSafety, kVisibility, kComfort, kTotal };
constexpr std::uint8_t kUnreachable = 255;  // value of an unreachable point
constexpr std::array kWatched = {"l_shoulder", "r_shoulder", "waist", "head"};
constexpr double kArmTolerance = 0.01;   // max difference in length of equal arms [m]
constexpr std::size_t kMaxVolumes = 24;  // max cached volumes, as measured lengths vary

Vector3 shoulder_middle(const Person& person) {
  const BodyJoint *left = find_joint(person, "l_shoulder"),
                  *right = find_joint(person, "r_shoulder");
  if (left && right) return 0.5 * (left->position + right->position);
  return left ? left->position : right ? right->position : Vector3(Vector3::Zero());
}

double angle(const Vector3& a, const Vector3& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

void put(const Vector3& p, float (&out)[3]) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(p[i]);
}

/// Returns first and one past last point of a row (along x) within reach of the arm.
std::pair<int, int> within_reach(const PlacedArm& arm, const Vector3& first, double step, int n) {
  const Vector3 d = first - arm.shoulder;
  const double reach = arm.length() + kArmTolerance,
               left = reach * reach - d.y() * d.y() - d.z() * d.z();
  if (left <= 0) return {0, 0};
  const double half = std::sqrt(left);
  return {std::clamp(static_cast<int>(std::ceil((-d.x() - half) / step)), 0, n),
          std::clamp(static_cast<int>(std::floor((-d.x() + half) / step)) + 1, 0, n)};
}

}  // namespace

const Layers& MapMaker::make(const Person& person, const std::vector<SceneBox>& boxes) {
  const int half = static_cast<int>(std::ceil(settings_.reach / settings_.resolution));
  const Vector3 middle = shoulder_middle(person);
  for (std::size_t layer = 0; layer < layers_.size(); ++layer) {
    Costmap& map = layers_[layer];
    map.layer = kOwnLayers[layer];
    map.person = person.id;
    map.resolution = settings_.resolution;
    for (int i = 0; i < 3; ++i)
      map.origin[i] = settings_.resolution * (std::round(middle[i] / settings_.resolution) - half);
    map.nx = map.ny = map.nz = static_cast<std::uint32_t>(2 * half + 1);
    map.values.assign(std::size_t{map.nx} * map.ny * map.nz, kUnreachable);
  }
  fill_comfort(person, boxes, layers_[kComfort]);
  fill_others(person);
  return layers_;
}

/// Returns the volume of an arm, valid until kMaxVolumes others are requested.
const ComfortVolume& MapMaker::volume_of(const ArmSize& arm) {
  const auto known = std::find_if(volumes_.begin(), volumes_.end(), [&](const ComfortVolume& v) {
    return v.suits(arm, kArmTolerance);
  });
  if (known != volumes_.end()) {
    volumes_.splice(volumes_.begin(), volumes_, known);
  } else {
    volumes_.emplace_front(arm, settings_.resolution);
    if (volumes_.size() > kMaxVolumes) volumes_.pop_back();
  }
  return volumes_.front();
}

void MapMaker::fill_comfort(const Person& person, const std::vector<SceneBox>& boxes,
                            Costmap& map) {
  const std::optional<PlacedArm> left = placed_arm(person, Side::left),
                                 right = placed_arm(person, Side::right);
  if (!left || !right) return;
  const ReachCheck furniture(person, boxes, settings_.clearance);
  const std::array<std::pair<const PlacedArm&, const ComfortVolume&>, 2> arms = {
      {{*left, volume_of(left->size)}, {*right, volume_of(right->size)}}};
  const int n = static_cast<int>(map.nx);
  std::uint8_t* row = map.values.data();
  for (std::uint32_t k = 0; k < map.nz; ++k)
    for (std::uint32_t j = 0; j < map.ny; ++j, row += n) {
      const Vector3 first = map.origin + settings_.resolution * Vector3(0, j, k);
      for (const auto& [arm, volume] : arms) {
        const auto [begin, end] = within_reach(arm, first, settings_.resolution, n);
        Vector3 p_arm =
            arm.to_arm * (first + settings_.resolution * Vector3(begin, 0, 0) - arm.shoulder);
        const Vector3 step = settings_.resolution * arm.to_arm.col(0);
        for (int i = begin; i < end; ++i, p_arm += step)
          if (const double cost = volume.cost(p_arm); cost < 1.0)
            row[i] = std::min(row[i], static_cast<std::uint8_t>(std::lround(cost * 254)));
      }
      for (int i = 0; i < n; ++i)
        if (row[i] != kUnreachable &&
            furniture.blocked_by(first + settings_.resolution * Vector3(i, 0, 0)))
          row[i] = kUnreachable;
    }
}

void MapMaker::fill_others(const Person& person) {
  const Costmap& grid = layers_[kSafety];
  const SimplifiedBody body = simplified_body(person);
  const std::optional<Sight> sight = sight_of(person);
  const CostSettings& cost = settings_.cost;
  const float over_sum = 1 / static_cast<float>(cost.w_safety + cost.w_visibility + cost.w_comfort);
  detail::RowPerson h{};
  float bottom[3];
  put(body.axis_bottom - grid.origin, bottom);
  h.axis_x = bottom[0], h.axis_y = bottom[1], h.bottom = bottom[2];
  h.height = static_cast<float>(body.height), h.radius = static_cast<float>(body.radius);
  put(body.head - grid.origin, h.head);
  h.head_radius = static_cast<float>(body.head_radius);
  h.over_safety_radius = 1 / static_cast<float>(cost.safety_radius);
  if (sight) {
    put(sight->eyes - grid.origin, h.eyes);
    put(sight->direction, h.gaze);
    h.cutoff = static_cast<float>(cost.visibility_cutoff);
  }
  h.w_safety = static_cast<float>(cost.w_safety) * over_sum;
  h.w_visibility = static_cast<float>(cost.w_visibility) * over_sum;
  h.w_comfort = static_cast<float>(cost.w_comfort) * over_sum;
  const detail::FillRow fill = detail::fill_row();
  const auto step = static_cast<float>(grid.resolution);
  std::size_t at = 0;
  for (std::uint32_t k = 0; k < grid.nz; ++k)
    for (std::uint32_t j = 0; j < grid.ny; ++j, at += grid.nx)
      fill(h,
           {static_cast<float>(j) * step, static_cast<float>(k) * step, step,
            static_cast<int>(grid.nx)},
           &layers_[kComfort].values[at], &layers_[kSafety].values[at],
           &layers_[kVisibility].values[at], &layers_[kTotal].values[at]);
}

bool Watch::changed(const Person& person, const std::vector<SceneBox>& boxes) {
  std::vector<Vector3> joints;
  for (const char* name : kWatched) {
    const BodyJoint* joint = find_joint(person, name);
    joints.push_back(joint ? joint->position : Vector3(Vector3::Zero()));
  }
  const std::optional<Sight> sight = sight_of(person);
  const std::array<Vector3, 2> directions = {torso_axes(person).col(0),
                                             sight ? sight->direction : Vector3(Vector3::UnitX())};
  bool same =
      person.id == person_ && joints.size() == joints_.size() && boxes.size() == boxes_.size();
  for (std::size_t i = 0; same && i < directions.size(); ++i)
    same = angle(directions[i], directions_[i]) < turned_;
  for (std::size_t i = 0; same && i < joints.size(); ++i)
    same = (joints[i] - joints_[i]).norm() < moved_;
  for (std::size_t i = 0; same && i < boxes.size(); ++i)
    same = boxes[i].id == boxes_[i].id && boxes[i].size == boxes_[i].size &&
           boxes[i].T_world_box.isApprox(boxes_[i].T_world_box, 1e-4);
  if (same) return false;
  person_ = person.id;
  joints_ = std::move(joints);
  directions_ = directions;
  boxes_ = boxes;
  return true;
}

const Person* nearest_person(const HumanState& people, const Vector3& point) {
  const Person* best = nullptr;
  double min_distance = std::numeric_limits<double>::infinity();
  for (const Person& person : people.people) {
    const double d = (shoulder_middle(person) - point).norm();
    if (d >= min_distance) continue;
    min_distance = d;
    best = &person;
  }
  return best;
}

}  // namespace handsel::costmap
