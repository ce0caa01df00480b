// SPDX-License-Identifier: Apache-2.0
// The recorded handover of the reference data, with a robot that replaces one of the two people.
#include <algorithm>
#include <array>

#include "common/model/human/human_body.hpp"
#include "tests/support/acts/acted_sequence.hpp"
#include "tests/support/recorded_handover.hpp"

namespace handsel::test {
namespace {

constexpr double kRate = 120;        // frame rate of the recording [Hz]
constexpr double kTaken = 3.28;      // time at which the taker holds the baton, as published [s]
constexpr double kReleased = 3.51;   // time at which the giver has released it, as published [s]
constexpr double kApart = 1.55;      // distance of robot and person, with space for its hand [m]
constexpr double kAside = 1.2;       // distance of the robot from an observed handover [m]
constexpr double kSlow = 1.0 / 3;    // max speed of an offer, divided by the max speed of the reach
constexpr double kHeld = 1.5;        // time at rest added to the giver's offer [s]
constexpr double kWristPart = 0.75;  // position of the wrist from elbow (0) to hand (1)
constexpr double kSpeedOver = 0.05;  // interval of the baton's speed measurement [s]

class Recorded final : public ActedSequence {
 public:
  Recorded(const RecordedHandover& recording, RecordedView view)
      : recording_(recording), view_(view) {
    const Vector3 giver = place_of("giver", "waist", 0), taker = place_of("taker", "waist", 0);
    const Vector3 across = (giver - taker).cwiseProduct(Vector3(1, 1, 0)).normalized();
    const bool is_taker = view == RecordedView::taker;
    const bool is_aside = view == RecordedView::aside;
    // Robot at the origin, +x toward the person.
    const Vector3 ahead = is_aside   ? Vector3(-across.y(), across.x(), 0)
                          : is_taker ? Vector3(-across)
                                     : across;
    const Vector3 person = is_aside ? Vector3((giver + taker) / 2) : is_taker ? taker : giver;
    Eigen::Matrix3d R;
    R << ahead.x(), ahead.y(), 0, -ahead.y(), ahead.x(), 0, 0, 0, 1;
    const Vector3 foot(person.x(), person.y(), 0);
    T_world_recording_ =
        make_pose(Vector3(is_aside ? kAside : kApart, 0, 0) - R * foot, Eigen::Quaterniond(R));
    if (is_taker) begin_ = kReleased + 0.1;
    find_offer();
    for (const char* id : {"giver", "taker"}) {
      const bool is_seen = is_aside || (is_taker == (std::string(id) == "taker"));
      if (!is_seen) continue;
      Person& body = bodies_[count_++];
      body.id = id == std::string("giver") ? "anna" : "ben";
      body.stature = 1.7;
      names_.push_back(id);
    }
    step(0);
  }

  void step(double dt) override {
    clock_ += dt;
    for (std::size_t i = 0; i < count_; ++i) move(bodies_[i], names_[i]);
  }
  double duration() const override {
    switch (view_) {
      case RecordedView::giver:
        return kReleased + 0.1;
      case RecordedView::giver_waits:
        return offer_begin_ + kHeld;
      default:
        return static_cast<double>(recording_.baton.size() - 1) / kRate - begin_;
    }
  }
  std::vector<const Person*> people() const override {
    std::vector<const Person*> out;
    for (std::size_t i = 0; i < count_; ++i) out.push_back(&bodies_[i]);
    return out;
  }
  Pose T_world_object() const override {
    const auto& row = recording_.baton[frame()];
    return T_world_recording_ *
           make_pose(place(row), Eigen::Quaterniond(row[6], row[3], row[4], row[5]).normalized());
  }
  Act act() const override {
    const bool gives = view_ == RecordedView::giver || view_ == RecordedView::giver_waits;
    if (!gives) return Act::passes;
    if (clock_ < offer_begin_) return Act::brings_out;
    return view_ == RecordedView::giver && clock_ > kReleased ? Act::passes : Act::offers;
  }
  OfferLabel label() const override { return {.max_speed = 1e9, .min_duration = 0.4}; }
  std::vector<ObservedGrip> grips() const override {
    const Pose T = T_world_object();
    const auto force = [&](const std::vector<std::vector<double>>& wrench) {
      return std::max(0.0, -wrench[frame()][2]);
    };
    return {{T * Vector3(-0.2, 0, 0), force(recording_.giver_wrench)},
            {T * Vector3(0.2, 0, 0), force(recording_.taker_wrench)}};
  }

 private:
  std::size_t frame() const {
    double t = begin_ + clock_;
    if (view_ == RecordedView::giver_waits) t = std::min(t, offer_begin_);
    return std::min(static_cast<std::size_t>(t * kRate), recording_.baton.size() - 1);
  }
  Vector3 place_of(const std::string& id, const std::string& joint, std::size_t frame) const {
    for (const auto& [name, frames] : recording_.bodies.at(id))
      if (name == joint) return place(frames[frame]);
    return Vector3::Zero();
  }
  /// The offer begins when the baton has become slower than kSlow of its max speed on the path to
  /// the taker: the recorded giver does not come to rest before the taker has hold of the baton.
  void find_offer() {
    const std::size_t over = static_cast<std::size_t>(kSpeedOver * kRate);
    const auto speed = [&](std::size_t i) {
      return (place(recording_.baton[i]) - place(recording_.baton[i - over])).norm() / kSpeedOver;
    };
    std::size_t fastest = over;
    for (std::size_t i = over; i < static_cast<std::size_t>(kTaken * kRate); ++i)
      if (speed(i) > speed(fastest)) fastest = i;
    std::size_t slow = fastest;
    while (speed(slow) > kSlow * speed(fastest)) ++slow;
    offer_begin_ = static_cast<double>(slow) / kRate;
  }
  void move(Person& body, const std::string& id) const {
    body.joints = standing_body(Vector3::Zero(), 0, body.stature);
    const Vector3 p_waist = T_world_recording_ * place_of(id, "waist", frame());
    for (BodyJoint& joint : body.joints) joint.position += Vector3(p_waist.x(), p_waist.y(), 0);
    const auto at = [&](const std::string& joint) -> Vector3& {
      return body.joints[static_cast<std::size_t>(body_joint_index(joint))].position;
    };
    for (const auto& [name, frames] : recording_.bodies.at(id))
      at(name) = T_world_recording_ * place(frames[frame()]);
    for (const std::string side : {"l", "r"})
      at(side + "_wrist") =
          at(side + "_elbow") + kWristPart * (at(side + "_hand") - at(side + "_elbow"));
  }

  const RecordedHandover& recording_;
  RecordedView view_;
  Pose T_world_recording_{Pose::Identity()};
  std::array<Person, 2> bodies_;
  std::vector<std::string> names_;
  std::size_t count_{};
  double clock_{}, begin_{}, offer_begin_{};
};

}  // namespace

std::unique_ptr<ActedSequence> recorded_sequence(const RecordedHandover& recording,
                                                 RecordedView view) {
  return std::make_unique<Recorded>(recording, view);
}

}  // namespace handsel::test
