// SPDX-License-Identifier: Apache-2.0
// Long lists and malformed elements: an observation is shortened and counted, not dropped; a
// command is dropped.
#include <gtest/gtest.h>

#include <cmath>

#include "common/bus/left_out.hpp"
#include "common/bus/local_bus.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/system.hpp"
#include "common/messages/task.hpp"
#include "common/wire/message_type.hpp"
#include "tests/support/oracles/wire_leaves.hpp"

namespace handsel::left_out_test {
namespace {

template <class M>
std::shared_ptr<void> sent(const M& message) {
  auto wire = message_type<M>().new_wire();
  std::string why;
  EXPECT_TRUE(message_type<M>().to_wire(&message, 1, wire.get(), why)) << why;
  return wire;
}

template <class M>
void damage(void* wire, const std::string& path) {
  int found = 0;
  message_type<M>().leaves(wire, [&](const WireLeaf& leaf) {
    if (leaf.path() != path) return;
    *static_cast<double*>(leaf.value) = std::nan("");
    ++found;
  });
  ASSERT_EQ(found, 1) << path;
}

HumanObservation three_people() {
  HumanObservation out;
  out.source = "camera";
  out.coverage = {{-2, -2, 0}, {2, 2, 2}};
  for (int i = 0; i < 3; ++i)
    out.people.push_back({"body" + std::to_string(i),
                          {{"head", {1.0 * i, 0, 1.7}, 1}, {"torso", {1.0 * i, 0, 1.3}, 1}}});
  return out;
}

TEST(LeftOut, an_object_with_a_pose_that_is_none_is_left_out_and_the_others_stay) {
  ObjectObservation seen;
  seen.source = "camera";
  for (const char* id : {"cup", "mug", "box"})
    seen.objects.push_back({id, "mug", make_pose({1, 0, 1}), 1});
  const auto wire = sent(seen);
  damage<ObjectObservation>(wire.get(), "objects[1].T_world_object.position.y");
  ObjectObservation got;
  std::string why;
  LeftOutElements left_out;
  ASSERT_TRUE(message_type<ObjectObservation>().from_wire(wire.get(), &got, why, left_out)) << why;
  ASSERT_EQ(got.objects.size(), 2u);
  EXPECT_EQ(got.objects[0].id, "cup");
  EXPECT_EQ(got.objects[1].id, "box");
  EXPECT_EQ(left_out.count, 1u);
  EXPECT_EQ(left_out.why,
            "ObjectObservation.objects[1].T_world_object.position.y is nan, must be a number from "
            "-10000 to 10000");
}

TEST(LeftOut, a_malformed_joint_goes_alone_and_the_coverage_stays) {
  const auto wire = sent(three_people());
  damage<HumanObservation>(wire.get(), "people[1].joints[0].position.x");
  HumanObservation got;
  std::string why;
  LeftOutElements left_out;
  ASSERT_TRUE(message_type<HumanObservation>().from_wire(wire.get(), &got, why, left_out)) << why;
  ASSERT_EQ(got.people.size(), 3u);
  ASSERT_EQ(got.people[1].joints.size(), 1u);
  EXPECT_EQ(got.people[1].joints[0].name, "torso");
  EXPECT_EQ(left_out.count, 1u);
  EXPECT_EQ(got.coverage.high, Vector3(2, 2, 2));
}

TEST(LeftOut, a_source_that_lost_a_person_to_malformed_data_shows_no_place_to_be_empty) {
  const auto wire = sent(three_people());
  for (const char* joint : {"0", "1"})
    damage<HumanObservation>(wire.get(), std::string("people[2].joints[") + joint + "].position.z");
  HumanObservation got;
  std::string why;
  LeftOutElements left_out;
  ASSERT_TRUE(message_type<HumanObservation>().from_wire(wire.get(), &got, why, left_out)) << why;
  EXPECT_EQ(got.people.size(), 2u);
  EXPECT_EQ(left_out.count, 3u) << "two joints, then the person";
  EXPECT_EQ(got.coverage.low, got.coverage.high);
}

TEST(LeftOut, a_malformed_gaze_leaves_the_body) {
  HumanObservation seen = three_people();
  seen.people[0].has_gaze = true;
  const auto wire = sent(seen);
  damage<HumanObservation>(wire.get(), "people[0].gaze_direction.x");
  HumanObservation got;
  std::string why;
  LeftOutElements left_out;
  ASSERT_TRUE(message_type<HumanObservation>().from_wire(wire.get(), &got, why, left_out)) << why;
  ASSERT_EQ(got.people.size(), 3u);
  EXPECT_FALSE(got.people[0].has_gaze);
  EXPECT_EQ(got.people[0].joints.size(), 2u);
  EXPECT_EQ(got.coverage.high, Vector3(2, 2, 2));
}

TEST(LeftOut, a_command_with_one_malformed_number_is_refused_whole) {
  TrajectoryCommand command;
  command.robot = "jido";
  command.axes = {0, 1};
  command.trajectory.axes.resize(2);
  for (auto& axis : command.trajectory.axes) axis.segments.push_back({0.5, 1.0});
  const auto wire = sent(command);
  damage<TrajectoryCommand>(wire.get(), "trajectory.axes[1].segments[0].jerk");
  TrajectoryCommand got;
  std::string why;
  LeftOutElements left_out;
  EXPECT_FALSE(message_type<TrajectoryCommand>().from_wire(wire.get(), &got, why, left_out));
  EXPECT_EQ(left_out.count, 0u);
}

TEST(LeftOut, a_plan_longer_than_its_list_is_cut_when_sent) {
  TaskStatus status;
  status.plan.assign(100, "pick mug");
  TaskStatus got;
  std::string why;
  ASSERT_TRUE(message_type<TaskStatus>().from_wire(sent(status).get(), &got, why)) << why;
  EXPECT_EQ(got.plan.size(), 64u);
}

TEST(LeftOut, of_many_goals_of_a_path_the_first_ones_are_sent) {
  PathRequest request;
  request.group = "arm";
  request.start = Vector::Zero(7);
  for (int i = 0; i < 100; ++i) request.goals.push_back(Vector::Constant(7, 0.01 * i));
  PathRequest got;
  std::string why;
  ASSERT_TRUE(message_type<PathRequest>().from_wire(sent(request).get(), &got, why)) << why;
  ASSERT_EQ(got.goals.size(), 64u);
  EXPECT_EQ(got.goals.front(), request.goals.front());
}

TEST(LeftOut, two_hundred_people_and_a_thousand_objects_arrive_whole) {
  LocalNetwork net(1);
  Bus &camera = net.add("camera"), &reader = net.add("reader");
  std::size_t people = 0, objects = 0;
  reader.subscribe<HumanObservation>(
      [&](const HumanObservation& m, const Receipt&) { people = m.people.size(); });
  reader.subscribe<ObjectObservation>(
      [&](const ObjectObservation& m, const Receipt&) { objects = m.objects.size(); });
  HumanObservation bodies = three_people();
  while (bodies.people.size() < 200) bodies.people.push_back(bodies.people.front());
  ObjectObservation things;
  things.source = "camera";
  while (things.objects.size() < 1000)
    things.objects.push_back({"thing" + std::to_string(things.objects.size()), "mug"});
  const auto bodies_out = camera.advertise<HumanObservation>();
  const auto things_out = camera.advertise<ObjectObservation>();
  EXPECT_TRUE(bodies_out->publish(bodies));
  EXPECT_TRUE(things_out->publish(things));
  net.run_until(TimePoint{} + std::chrono::milliseconds(50));
  EXPECT_EQ(people, 200u);
  EXPECT_EQ(objects, 1000u);
}

TEST(LeftOut, what_is_counted_shows_in_the_health_of_the_process) {
  LocalNetwork net(1);
  Bus &spark = net.add("spark"), &observer = net.add("observer");
  ComponentHealth health;
  observer.subscribe<ComponentHealth>([&](const ComponentHealth& m, const Receipt&) {
    if (m.component == "spark") health = m;
  });
  spark.count_left_out("people: farther than the nearest 16", 3);
  spark.count_left_out("people: farther than the nearest 16", 4);
  net.run_until(TimePoint{} + std::chrono::milliseconds(250));
  ASSERT_EQ(health.left_out.size(), 1u);
  EXPECT_EQ(health.left_out[0].name, "people: farther than the nearest 16");
  EXPECT_EQ(health.left_out[0].count, 7u);
}

TEST(LeftOut, ever_new_names_do_not_grow_the_list) {
  LeftOutCounts counts;
  for (int i = 0; i < 1000; ++i) counts.add("cause " + std::to_string(i), 1);
  std::uint64_t sum = 0;
  for (const NamedCount& one : counts.counts()) sum += one.count;
  EXPECT_LE(counts.counts().size(), 32u);
  EXPECT_EQ(sum, 1000u);
}

}  // namespace
}  // namespace handsel::left_out_test
