// SPDX-License-Identifier: Apache-2.0
// Converts BVH skeletons to recordings.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "sim/recordings/bvh.hpp"
#include "sim/recordings/recording_parts.hpp"

namespace handsel::sim {

using namespace recording_detail;

namespace {

constexpr double kStature = 1.75;  // stature assigned to a skeleton of unknown unit [m]

std::string plain(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (c != '_' && c != '-' && c != '.' && c != ' ')
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// Returns the index of the joint with the first of `names` found, each also with "l" or "r" for
/// "left" or "right"; -1: none.
int find_any(const Bvh& bvh, std::initializer_list<std::string> names) {
  for (const std::string& wanted : names) {
    const std::string brief = wanted.starts_with("left")    ? "l" + wanted.substr(4)
                              : wanted.starts_with("right") ? "r" + wanted.substr(5)
                                                            : wanted;
    for (std::size_t i = 0; i < bvh.joints.size(); ++i)
      if (const std::string has = plain(bvh.joints[i].name); has == wanted || has == brief)
        return static_cast<int>(i);
  }
  return -1;
}

/// Assigns joints of a skeleton to points of the body; -1: none.
struct BvhMap {
  std::array<int, kBodyJoints.size()> joint{};
  int head_top{-1};
  std::array<int, 2> fingers{-1, -1};
};

BvhMap map_joints(const Bvh& bvh, const std::string& name) {
  BvhMap map;
  map.joint.fill(-1);
  const auto need = [&](int body, std::initializer_list<std::string> names) {
    map.joint[static_cast<std::size_t>(body)] = find_any(bvh, names);
    if (map.joint[static_cast<std::size_t>(body)] >= 0) return;
    std::string all;
    for (const std::string& n : names) all += (all.empty() ? "" : ", ") + n;
    fail_at(name, 1,
            std::string("no joint for the body's ") + kBodyJoints[static_cast<std::size_t>(body)] +
                "; known names are " + all);
  };
  const auto child_of = [&](int parent) {
    for (std::size_t i = 0; i < bvh.joints.size(); ++i)
      if (bvh.joints[i].parent == parent && bvh.joints[i].offset.norm() > 1e-9)
        return static_cast<int>(i);
    return -1;
  };
  need(kHead, {"head"});
  need(kNeck, {"neck", "neck1"});
  need(kTorso, {"spine2", "spine1", "chest2", "chest", "thorax", "upperback", "spine"});
  int& torso = map.joint[static_cast<std::size_t>(kTorso)];  // not at the neck
  for (int i = map.joint[static_cast<std::size_t>(kNeck)];
       i > 0 && torso == bvh.joints[static_cast<std::size_t>(i)].parent &&
       bvh.joints[static_cast<std::size_t>(i)].offset.norm() < 1e-9;)
    i = torso, torso = bvh.joints[static_cast<std::size_t>(i)].parent;
  need(kWaist, {"hips", "pelvis", "hip", "root"});
  for (std::size_t s = 0; s < 2; ++s) {
    const std::string side = s == 0 ? "left" : "right";
    need(kShoulder[s],
         {side + "arm", side + "upperarm", side + "uparm", side + "shldr", side + "shoulder"});
    need(kElbow[s], {side + "forearm", side + "elbow", side + "lowarm", side + "lowerarm"});
    need(kWrist[s], {side + "hand", side + "wrist"});
    need(kHip[s],
         {side + "upleg", side + "hip", side + "thigh", side + "upperleg", side + "upperleg"});
    need(kKnee[s], {side + "leg", side + "knee", side + "shin", side + "lowleg", side + "lowerleg",
                    side + "calf"});
    need(kAnkle[s], {side + "foot", side + "ankle"});
    map.fingers[s] = child_of(map.joint[static_cast<std::size_t>(kWrist[s])]);
  }
  map.head_top = child_of(map.joint[static_cast<std::size_t>(kHead)]);
  return map;
}

// Many files begin with the rest pose of the skeleton. Joints would jump from there into the
// motion, faster than any joint of a person moves [m/s].
constexpr double kMaxJointSpeed = 15.0;

/// Returns the largest displacement of a joint between two frames [m].
double max_displacement(const BodyPoints& from, const BodyPoints& to) {
  double max = 0;
  for (std::size_t i = 0; i < from.size(); ++i) max = std::max(max, (to[i] - from[i]).norm());
  return max;
}

}  // namespace

Recording parse_bvh_recording(std::string_view text, const std::string& name) {
  const Bvh bvh = parse_bvh(text, name);
  if (bvh.frames() < 2) fail_at(name, 1, "one frame is no motion: needs at least two frames");
  const BvhMap map = map_joints(bvh, name);
  std::vector<Vector3> points;
  bvh.positions(0, points);
  const auto at = [&](int body) {
    return points[static_cast<std::size_t>(map.joint[static_cast<std::size_t>(body)])];
  };
  const Vector3 up = at(kHead) - at(kWaist);
  const int axis = up.y() > std::abs(up.z()) ? 1 : 2;
  if (up[axis] < 0.5 * up.norm())
    fail_at(name, 1, "the body in the first frame does not stand along +y or +z");
  std::vector<BodyPoints> frames(bvh.frames());
  double scale = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    bvh.positions(f, points);
    if (axis == 1)
      for (Vector3& p : points) p = Vector3(p.x(), -p.z(), p.y());
    BodyPoints& body = frames[f];
    for (std::size_t i = 0; i < body.size(); ++i)
      if (map.joint[i] >= 0) body[i] = points[static_cast<std::size_t>(map.joint[i])];
    if (map.head_top >= 0)
      body[kHead] = (body[kHead] + points[static_cast<std::size_t>(map.head_top)]) / 2;
    if (f == 0) {
      const auto leg = [&](int s) {
        return (body[kHip[s]] - body[kKnee[s]]).norm() + (body[kKnee[s]] - body[kAnkle[s]]).norm();
      };
      const double stature = ((body[kHead] - body[kWaist]).norm() + (leg(0) + leg(1)) / 2) /
                             (kTrunk + 0.53 - kAnkleUp);
      if (!(stature > 1e-6)) fail_at(name, 1, "the skeleton has no size");
      const double unit = unit_of(stature).first;
      scale = unit > 0 ? unit : kStature / stature;
    }
    for (Vector3& p : body) p *= scale;
    const double palm = 0.054 * kStature;
    for (std::size_t s = 0; s < 2; ++s) {
      const Vector3 fingers =
          map.fingers[s] >= 0
              ? Vector3(scale * points[static_cast<std::size_t>(map.fingers[s])] - body[kWrist[s]])
              : Vector3(body[kWrist[s]] - body[kElbow[s]]);
      body[kHand[s]] = body[kWrist[s]] + palm * fingers.stableNormalized();
    }
  }
  if (frames.size() > 2 && max_displacement(frames[0], frames[1]) > kMaxJointSpeed * bvh.frame_time)
    frames.erase(frames.begin());
  check_body(frames[0], name, 1);
  return finish(std::move(frames), 1 / bvh.frame_time, true);
}

}  // namespace handsel::sim
