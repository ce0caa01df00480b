// SPDX-License-Identifier: Apache-2.0
#include "components/spark/people/track.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/cost/human_cost.hpp"
#include "common/model/human/palm.hpp"

namespace handsel::spark {
namespace {

constexpr std::size_t kJoints = kBodyJoints.size();

int index(const char* name) { return body_joint_index(name); }
const std::array kHands = {index("l_hand"), index("r_hand")},
                 kWrists = {index("l_wrist"), index("r_wrist")},
                 kShoulders = {index("l_shoulder"), index("r_shoulder")};
const std::array kTrunkMiddle = {index("neck"), index("torso"), index("waist"), index("l_shoulder"),
                                 index("r_shoulder")};
const std::vector<const char*> kLimbs[] = {{"l_shoulder", "l_elbow", "l_wrist", "l_hand"},
                                           {"r_shoulder", "r_elbow", "r_wrist", "r_hand"},
                                           {"l_hip", "l_knee", "l_ankle"},
                                           {"r_hip", "r_knee", "r_ankle"}};

const Vector3& joint_position(const Person& person, int joint) {
  return person.joints[static_cast<std::size_t>(joint)].position;
}

/// Returns the height in the person's profile [m]; 0: none.
double height(const settings::SparkSettings& settings, const std::string& id) {
  for (const settings::PersonProfile& one : settings.people)
    if (one.id == id) return one.height;
  return 0;
}

/// Places unobserved joints relative to observed ones, once shoulders or hips show the direction of
/// the body, which the first observation may have missed.
void place_unobserved(const Track& track, std::vector<BodyJoint>& body) {
  const auto seen = [&](const char* joint) {
    return track.joint_seen[static_cast<std::size_t>(index(joint))].has_value();
  };
  const auto at = [&](const std::vector<BodyJoint>& b, const char* joint) -> Vector3 {
    return b[static_cast<std::size_t>(index(joint))].position;
  };
  const bool shoulders = seen("l_shoulder") && seen("r_shoulder");
  if (!shoulders && !(seen("l_hip") && seen("r_hip"))) return;
  const Vector3 left = shoulders ? at(body, "l_shoulder") - at(body, "r_shoulder")
                                 : at(body, "l_hip") - at(body, "r_hip");
  const auto model =
      standing_body(Vector3::Zero(), std::atan2(-left.x(), left.y()), track.person.stature);
  const Vector3 trunk =
      shoulders ? at(body, "l_shoulder") + at(body, "r_shoulder") - at(model, "l_shoulder") -
                      at(model, "r_shoulder")
                : at(body, "l_hip") + at(body, "r_hip") - at(model, "l_hip") - at(model, "r_hip");
  for (const char* joint :
       {"head", "neck", "torso", "waist", "l_shoulder", "r_shoulder", "l_hip", "r_hip"})
    if (!seen(joint))
      body[static_cast<std::size_t>(index(joint))].position = at(model, joint) + trunk / 2;
  for (const auto& limb : kLimbs) {
    if (std::any_of(limb.begin() + 1, limb.end(), seen)) continue;
    for (auto joint = limb.begin() + 1; joint != limb.end(); ++joint)
      body[static_cast<std::size_t>(index(*joint))].position =
          at(body, limb.front()) + at(model, *joint) - at(model, limb.front());
  }
}

/// Takes a sample of each observed hand; an observed wrist also determines the hand.
void update_hands(Track& track, const std::array<bool, kJoints>& observed, TimePoint at,
                  const settings::SparkSettings& settings) {
  Vector3 trunk = Vector3::Zero();
  for (const int joint : kTrunkMiddle)
    trunk += joint_position(track.person, joint) / static_cast<double>(kTrunkMiddle.size());
  for (std::size_t side = 0; side < kHands.size(); ++side) {
    if (!observed[static_cast<std::size_t>(kHands[side])] &&
        !observed[static_cast<std::size_t>(kWrists[side])])
      continue;
    const Vector3& hand = joint_position(track.person, kHands[side]);
    std::optional<TimePoint>& last = track.hand_seen[side];
    const double dt = last ? to_seconds(at - *last) : settings.motion_gap;
    if (dt >= settings.motion_gap)
      track.hands[side].reset(hand, trunk, settings.joint_noise, settings.hand_prediction);
    else if (dt > 1e-4)
      track.hands[side].update(hand, trunk, dt, settings.joint_noise);
    else
      continue;
    last = at;
  }
}

/// Takes a sample of each palm whose two knuckles are observed with the hand or the wrist.
void update_palms(Track& track, const ObservedPerson& body,
                  const std::array<bool, kJoints>& observed, TimePoint seen,
                  double min_confidence) {
  const auto find = [&](const char* name) {
    const auto it =
        std::find_if(body.joints.begin(), body.joints.end(), [&](const ObservedJoint& joint) {
          return joint.name == name && joint.position.allFinite() &&
                 joint.confidence >= min_confidence;
        });
    return it == body.joints.end() ? nullptr : &it->position;
  };
  for (std::size_t side = 0; side < kHands.size(); ++side) {
    const Vector3 *pinky = find(kKnuckles[side].pinky), *index_finger = find(kKnuckles[side].index);
    if (pinky == nullptr || index_finger == nullptr) continue;
    if (!observed[static_cast<std::size_t>(kHands[side])] &&
        !observed[static_cast<std::size_t>(kWrists[side])])
      continue;
    if (track.palm_seen[side] && *track.palm_seen[side] > seen) continue;
    const Vector3 fingers =
        joint_position(track.person, kHands[side]) - joint_position(track.person, kWrists[side]);
    const auto normal =
        palm_normal(side == 0 ? Side::left : Side::right, fingers, *index_finger - *pinky);
    if (!normal) continue;
    track.palms[side] = *normal;
    track.palm_seen[side] = seen;
  }
}

}  // namespace

double distance(const Track& track, const ObservedPerson& body) {
  Vector3 sum = Vector3::Zero();
  double weight = 0;
  for (const ObservedJoint& joint : body.joints) {
    const int i = body_joint_index(joint.name);
    if (i < 0 || !joint.position.allFinite()) continue;
    const double w = joint.confidence * (of_trunk(static_cast<std::size_t>(i)) ? 5 : 1);
    sum += w * (joint.position - joint_position(track.person, i));
    weight += w;
  }
  return weight > 0 ? std::hypot(sum.x(), sum.y()) / weight
                    : std::numeric_limits<double>::infinity();
}

void update(Track& track, const ObservedPerson& body, TimePoint seen, double jump,
            const settings::SparkSettings& settings) {
  if (body.has_gaze && (!track.gaze_seen || seen >= *track.gaze_seen)) {
    track.person.gaze_origin = body.gaze_origin;
    track.person.gaze_direction = body.gaze_direction;
    track.gaze_seen = seen;
  }
  Person& person = track.person;
  const bool known = !person.joints.empty();
  if (body.joints.empty()) return;

  // A source with more latency shows an earlier instant: joints unobserved since then are used,
  // extrapolated to the present.
  const TimePoint at = known ? std::max(seen, track.seen) : seen;
  const double behind = to_seconds(at - seen);
  if (behind > settings.merge_time) return;
  ObservedPerson merged = body;
  merged.joints.clear();
  std::array<bool, kJoints> observed{};
  for (const ObservedJoint& joint : body.joints) {
    const int i = body_joint_index(joint.name);
    if (i < 0 || !(joint.confidence >= settings.min_confidence)) continue;
    const auto k = static_cast<std::size_t>(i);
    if (track.joint_seen[k] && *track.joint_seen[k] > seen) continue;
    merged.joints.push_back(joint);
    if (behind > 0) merged.joints.back().position += behind * person.joints[k].velocity;
    track.joint_seen[k] = seen;
    observed[k] = true;
  }
  if (merged.joints.empty()) return;
  const double dt = known ? to_seconds(at - track.seen) : 0.0;
  std::array<bool, kJoints> observed_recently{};  // observed by another recent observation
  for (std::size_t i = 0; known && i < kJoints; ++i) {
    if (observed[i] || !track.joint_seen[i] ||
        to_seconds(at - *track.joint_seen[i]) > settings.merge_time)
      continue;
    merged.joints.push_back(
        {kBodyJoints[i], person.joints[i].position + dt * person.joints[i].velocity, 0.5});
    observed_recently[i] = true;
  }
  track.size.add_sample(body, settings);
  const double known_height = height(settings, person.id);
  person.stature = known_height > 0 ? known_height : track.size.stature(settings);
  const Person previous = person;
  std::vector<BodyJoint> fitted = fit_body(merged, known ? &previous : nullptr, person.stature);
  if (fitted.empty()) return;
  place_unobserved(track, fitted);
  std::array<double, kJoints> noise{};
  for (std::size_t i = 0; i < kJoints; ++i)
    noise[i] = observed_recently[i]
                   ? 0.0
                   : settings.joint_noise * (observed[i] ? 1.0 : settings.unobserved_noise);
  track.motion.update(fitted, noise, at, settings);
  const auto inflate = [&](double by, double time) {
    track.extra_inflation = seen < track.extra_until ? track.extra_inflation + by : by;
    track.extra_until = std::max(track.extra_until, seen + from_seconds(time));
  };
  if (known && dt > settings.lost_after)
    inflate(settings.lost_speed * dt + jump, settings.confirm_time);
  else if (known && jump > settings.person_max_speed * (dt + behind) + settings.settled_distance)
    inflate(jump, settings.doubt_time);
  person.joints = std::move(fitted);
  update_hands(track, observed, at, settings);
  update_palms(track, body, observed, seen, settings.min_confidence);
  track.seen = at;
  track.empty_since.reset();
  track.left_by.clear();
  track.adopted = false;
}

std::vector<PalmDirection> palms_of(const Track& track, TimePoint now,
                                    const settings::SparkSettings& settings) {
  std::vector<PalmDirection> out;
  for (std::size_t side = 0; side < kHands.size(); ++side)
    if (track.palm_seen[side] && to_seconds(now - *track.palm_seen[side]) <= settings.palm_memory)
      out.push_back({kKnuckles[side].hand, track.palms[side]});
  return out;
}

std::vector<HandPrediction> hands_ahead(const Track& track, const Person& person, TimePoint now,
                                        const settings::SparkSettings& settings) {
  std::vector<HandPrediction> out;
  for (std::size_t side = 0; side < kHands.size(); ++side) {
    if (!track.hand_seen[side]) continue;
    const double since = std::max(0.0, to_seconds(now - *track.hand_seen[side]));
    HandPrediction hand{kBodyJoints[static_cast<std::size_t>(kHands[side])], {}};
    for (int k = 1; k <= static_cast<int>(settings.hand_predictions); ++k) {
      const HandPredictor::Ball ball =
          track.hands[side].at(since + k * settings.hand_prediction_step);
      // The arm's length bounds the distance from the shoulder, which may have moved.
      const double arm = (ball.centre - joint_position(person, kShoulders[side])).norm() +
                         arm_length(person) +
                         settings.person_max_speed * (since + k * settings.hand_prediction_step);
      hand.ahead.push_back({k * settings.hand_prediction_step, ball.centre,
                            std::min(ball.radius, arm) + person.inflation});
    }
    out.push_back(std::move(hand));
  }
  return out;
}

}  // namespace handsel::spark
