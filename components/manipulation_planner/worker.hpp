// SPDX-License-Identifier: Apache-2.0
// Long computations beside the actions. A job gets values and shared data that no one else writes
// while it runs; jobs run one after the other.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "common/collision/collision_world.hpp"
#include "components/manipulation_planner/motion/motion_end.hpp"
#include "components/manipulation_planner/outbox.hpp"
#include "components/manipulation_planner/routine.hpp"

namespace handsel::manipulation_planner {

/// Hands jobs out and counts them.
class Worker {
 public:
  /// `timeout`: a job that takes longer has failed [s]; the references must outlive the worker.
  Worker(Outbox& outbox, Waiting& waiting, double timeout)
      : outbox_(outbox), waiting_(waiting), timeout_(timeout) {}

  /// Hands the job out and waits for its end. `job` must outlive the routine.
  Routine<Outcome> run(const std::function<void()>& job) {
    const std::uint64_t mine = ++started_;
    outbox_.jobs.push_back(job);
    const bool done = co_await waiting_.until([this, mine] { return done_ >= mine; }, timeout_);
    co_return done
        ? Outcome{}
        : Outcome::failure("the computation did not end in time", ActionFailure::timed_out);
  }
  /// Counts one job as ended; what it wrote may be read from now on.
  void job_done() { ++done_; }
  /// Returns whether no job runs.
  bool is_idle() const { return done_ >= started_; }
  /// Returns the collision world of the jobs, made at the first call.
  std::shared_ptr<CollisionWorld> world(const RobotModel& robot, const ObjectLibrary& objects) {
    if (!world_) world_ = std::make_shared<CollisionWorld>(robot, objects);
    return world_;
  }

 private:
  Outbox& outbox_;
  Waiting& waiting_;
  double timeout_;
  std::uint64_t started_{0}, done_{0};
  std::shared_ptr<CollisionWorld> world_;
};

}  // namespace handsel::manipulation_planner
