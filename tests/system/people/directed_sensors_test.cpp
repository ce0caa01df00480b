// SPDX-License-Identifier: Apache-2.0
// Attention directs the sensors of the running system: few samples while nobody is near, all of
// them beside a person, and all of them without attention. The whole system in lock-step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/system.hpp"
#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::directed_sensors_test {
namespace {

const std::string kSensors =
    "human_sensors { source: \"kinect\" rate: 30 latency: 0.04 noise: 0.004 }\n"
    "object_sensors { source: \"object_tracker\" rate: 30 latency: 0.04 noise: 0.001 }\n";

/// The system with one person, and what its sensors deliver.
class Room {
 public:
  explicit Room(const std::string& person)
      : system_(system_context(
            folder_.write("room.txtpb", "name: \"room\"\nrobot: \"jido\"\n" + person + kSensors)
                .string(),
            "", 1)) {
    Bus& seat = system_.bus();
    seat.subscribe<HumanObservation>([this](const HumanObservation&, const Receipt& r) {
      people_.push_back(r.arrival);
      if (separation_ < kNear && people_.size() > 1)
        max_gap_near_ =
            std::max(max_gap_near_, to_seconds(people_.back() - people_[people_.size() - 2]));
    });
    seat.subscribe<ObjectObservation>(
        [this](const ObjectObservation&, const Receipt& r) { objects_.push_back(r.arrival); });
    seat.subscribe<GroundTruth>(
        [this](const GroundTruth& truth, const Receipt&) { separation_ = truth.separation; });
    system_.network().run_until([&] { return not_ready(system_.snapshot(), false).empty(); },
                                system_.now() + from_seconds(10));
    run(2);
  }
  void run(double seconds) {
    system_.network().run_until([] { return false; }, system_.now() + from_seconds(seconds));
  }
  struct Rates {
    double people, objects;  // [Hz]
  };
  /// Returns the rates over the next three seconds.
  Rates rates() {
    const TimePoint from = system_.now();
    run(3);
    const auto since = [from](const std::vector<TimePoint>& times) {
      return static_cast<double>(std::count_if(times.begin(), times.end(),
                                               [from](TimePoint t) { return t > from; })) /
             3;
    };
    const Rates rates{since(people_), since(objects_)};
    std::printf("people %.1f Hz, objects %.1f Hz\n", rates.people, rates.objects);
    return rates;
  }
  /// Returns the max time between two samples of people while a person was within 0.9 m [s].
  double max_gap_near() const { return max_gap_near_; }
  LocalNetwork& network() { return system_.network(); }

 private:
  static constexpr double kNear = 0.9;  // [m]
  test::TemporaryFolder folder_;
  LockstepSystem system_;
  std::vector<TimePoint> people_, objects_;
  double separation_{1e9}, max_gap_near_{};
};

TEST(DirectedSensors, measure_less_while_the_only_person_is_far_and_all_without_attention) {
  Room room("people { id: \"anna\" x: 3.9 y: 0 yaw: 3.1416 behaviour: STILL }\n");
  const Room::Rates far = room.rates();
  EXPECT_LT(far.people, 15);
  EXPECT_GT(far.people, 10) << "the guard needs samples";
  EXPECT_LT(far.objects, 13);
  EXPECT_GT(far.objects, 10);

  room.network().kill("attention");
  room.run(1);
  const Room::Rates alone = room.rates();
  EXPECT_GT(alone.people, 29);
  EXPECT_GT(alone.objects, 29);
}

TEST(DirectedSensors, measure_everything_beside_a_person) {
  Room room("people { id: \"anna\" x: 1.1 y: -0.25 yaw: 3.1416 behaviour: STILL }\n");
  const Room::Rates near = room.rates();
  EXPECT_GT(near.people, 27);
  EXPECT_GT(near.objects, 27);
}

TEST(DirectedSensors, are_at_full_rate_before_a_person_who_walks_up_is_near) {
  Room room(
      "people { id: \"ben\" x: 1.4 y: 0 yaw: 1.5708 behaviour: WALKER approach_from: 6.0 }\n");
  room.run(15);
  EXPECT_GT(room.max_gap_near(), 0) << "nobody came near";
  EXPECT_LT(room.max_gap_near(), 0.05);
}

}  // namespace
}  // namespace handsel::directed_sensors_test
