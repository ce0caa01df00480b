// SPDX-License-Identifier: Apache-2.0
// The simulator's giver and partner, without physics: the object moves with the commanded hand.
#include <cmath>
#include <optional>

#include "sim/people/person.hpp"
#include "tests/support/acts/acted_sequence.hpp"

namespace handsel::test {
namespace {

class Simulated final : public ActedSequence {
 public:
  Simulated(const ActStage& stage, std::uint64_t seed)
      : stage_(stage), random_(seed * 0x9e3779b97f4a7c15ULL + 29) {
    sim::PersonSettings settings;
    settings.id = "anna";
    settings.feet = Vector3(1.40 + about(0.12), -0.05 + about(0.12), 0);
    settings.yaw = M_PI + about(0.3);
    settings.stature = 1.72 + about(0.15);
    settings.left_handed = chance(0.12);
    settings.kind = chance(0.6) ? sim::PersonKind::giver : sim::PersonKind::partner;
    settings.holds = true;
    settings.reaction = within(0.4, 1.6);
    sim::BehaviourProfile& profile = settings.behaviour;
    profile.speed_scale = within(0.7, 1.3);
    if (chance(0.25)) profile.hesitation = within(0.3, 1) * 1.5;
    if (chance(0.2)) profile.look_away = within(0.3, 1) * 3;
    profile.look_away_at = within(2, 14);
    profile.seated = chance(0.15);
    if (!profile.seated && chance(0.25))
      profile.sidestep =
          Eigen::AngleAxisd(within(M_PI_2, 3 * M_PI_2), Vector3::UnitZ()) * Vector3(-0.25, 0, 0);
    profile.sidestep_at = within(2, 14);
    asked_at_ = chance(0.75) ? within(1, 2.5) : 1e9;
    ends_at_ = within(5, 6.5);
    walks_ = chance(0.25);
    refuses_at_ = chance(0.15) ? 0.0 : ends_at_;
    model_.emplace(settings);
    view_.object = stage_.object;
    view_.robot_hand = stage_.p_hand;
    step(0);
  }

  void step(double dt) override {
    clock_ += dt;
    if (clock_ > asked_at_) model_->announce(sim::Announcement::asks);
    if (clock_ > refuses_at_ && !ended_) {
      ended_ = true;
      walks_ ? model_->leave() : model_->refuse();
    }
    model_->step(dt, view_);
    view_.T_world_object = model_->hand().T_world_body * Eigen::Translation3d(kHeldInFront, 0, 0);
    if (model_->phase() == sim::PersonPhase::keeping && !is_out_) kept_ = outward();
    if (model_->is_offering()) is_out_ = true, out_ = outward();
  }
  double duration() const override { return ends_at_ + 2; }
  std::vector<const Person*> people() const override { return {&model_->body()}; }
  Pose T_world_object() const override { return view_.T_world_object; }
  bool is_unclear() const override { return is_out_ && out_ < kept_ + kMinOutward; }
  Act act() const override {
    if (model_->is_offering()) return Act::offers;
    switch (model_->phase()) {
      case sim::PersonPhase::offering:
        return Act::hesitates;
      case sim::PersonPhase::leaving:
        return Act::carries;
      default:
        return Act::keeps;
    }
  }

 private:
  double within(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random_);
  }
  double about(double size) { return within(-size, size); }
  bool chance(double share) { return within(0, 1) < share; }

  /// Level distance of the hand from its shoulder [m].
  double outward() const {
    const char* shoulder = model_->side() == Side::left ? "l_shoulder" : "r_shoulder";
    const Person& body = model_->body();
    const Vector3 out = model_->hand().T_world_body.translation() -
                        body.joints[static_cast<std::size_t>(body_joint_index(shoulder))].position;
    return std::hypot(out.x(), out.y());
  }

  ActStage stage_;
  std::mt19937_64 random_;
  std::optional<sim::PersonModel> model_;
  sim::PersonView view_;
  double clock_{}, asked_at_{}, ends_at_{}, refuses_at_{};
  double kept_{}, out_{};
  bool walks_{}, ended_{}, is_out_{};
};

}  // namespace

std::unique_ptr<ActedSequence> simulated_sequence(const ActStage& stage, std::uint64_t seed) {
  return std::make_unique<Simulated>(stage, seed);
}

}  // namespace handsel::test
