// SPDX-License-Identifier: Apache-2.0
#include "sim/world_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace handsel::sim {
namespace {

std::uint64_t steps_per(double rate, double step) {
  return std::max<std::uint64_t>(1, std::llround(1 / (rate * step)));
}

}  // namespace

WorldOutput::WorldOutput(Bus& bus, const SimSettings& settings)
    : state_out_(bus.advertise<RobotState>()),
      human_out_(bus.advertise<HumanObservation>()),
      object_out_(bus.advertise<ObjectObservation>()),
      report_out_(bus.advertise<RobotReport>()),
      ground_truth_out_(bus.advertise<GroundTruth>()),
      steps_per_state_(steps_per(settings.state_rate, settings.step)),
      steps_per_report_(steps_per(TopicOf<RobotReport>::row.rate, settings.step)),
      steps_per_ground_truth_(steps_per(settings.ground_truth_rate, settings.step)) {}

void WorldOutput::publish(SimWorld& world, std::uint64_t steps,
                          const std::function<Stamp()>& stamp_now, double factor) {
  if (steps % steps_per_state_ == 0 && world.robot_state(state_)) {
    state_.stamp = stamp_now();
    state_out_->publish(state_);
  }
  publish_observations(world, stamp_now);
  if (steps % steps_per_report_ == 0) {
    world.robot_reports(reports_);
    for (RobotReport& report : reports_) {
      report.stamp = stamp_now();
      report_out_->publish(report);
    }
  }
  if (steps % steps_per_ground_truth_ == 0) publish_ground_truth(world, stamp_now, factor);
}

void WorldOutput::publish_observations(SimWorld& world, const std::function<Stamp()>& stamp_now) {
  const auto stamp_of = [&](double seen) {
    return stamp_now() - from_seconds(world.time() - seen).count();
  };
  human_due_.clear();
  world.human_observations(human_due_);
  for (auto& delivery : human_due_) {
    Stamped& last = stamped_[delivery.message.source];
    if (last.stamp == 0 || last.seen != delivery.seen)
      last = {delivery.seen, stamp_of(delivery.seen)};
    delivery.message.stamp = last.stamp;
    human_out_->publish(delivery.message);
  }
  object_due_.clear();
  world.object_observations(object_due_);
  for (auto& delivery : object_due_) {
    delivery.message.stamp = stamp_of(delivery.seen);
    object_out_->publish(delivery.message);
  }
}

void WorldOutput::publish_ground_truth(SimWorld& world, const std::function<Stamp()>& stamp_now,
                                       double factor) {
  const std::uint64_t before = ground_truth_.limit_violations;
  const std::uint64_t collisions_before = ground_truth_.self_or_scene_collisions;
  world.ground_truth(ground_truth_);
  if (before == 0 && ground_truth_.limit_violations > 0)
    std::fprintf(stderr, "sim: at %.3f s the first set-point beyond the limits, %s\n", world.time(),
                 world.first_limit_violation().c_str());
  if (collisions_before == 0 && ground_truth_.self_or_scene_collisions > 0)
    std::fprintf(stderr, "sim: at %.3f s the first collision, %s\n", world.time(),
                 world.last_collision().c_str());
  ground_truth_.stamp = stamp_now();
  ground_truth_.real_time_factor = factor;
  ground_truth_out_->publish(ground_truth_);
}

}  // namespace handsel::sim
