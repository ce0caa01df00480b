// SPDX-License-Identifier: Apache-2.0
// Specified errors of the emulated sensors, measured on their stream.
#include <gtest/gtest.h>

#include <set>

#include "common/model/human/body_index.hpp"
#include "common/model/human/palm.hpp"
#include "tests/unit/sim/sim_fixture.hpp"

namespace handsel::sim::sensors_test {
namespace {

using namespace test;

using Stream = std::vector<Delivery<HumanObservation>>;

Person person_at(const std::string& id, double x, double y, double yaw = M_PI) {
  Person person;
  person.id = id;
  person.joints = standing_body({x, y, 0}, yaw, 1.75);
  person.gaze_known = true;
  person.gaze_direction = Vector3(std::cos(yaw), std::sin(yaw), 0);
  person.gaze_origin = person.joints[0].position + 0.08 * person.gaze_direction;
  return person;
}

SensorSettings plain() {
  SensorSettings s;
  s.source = "camera";
  s.rate = 30;
  s.latency = 0.04;
  s.coverage = {{-4, -4, -0.1}, {4, 4, 2.5}};
  return s;
}

/// Everything handed over in `seconds`, with `due` as the instant it was collected.
Stream watch(const SensorSettings& settings, const std::vector<Person>& people, double seconds,
             std::uint64_t seed = 3, const std::vector<SightBox>& boxes = {},
             const std::vector<SightCapsule>& robot = {}) {
  HumanSensor sensor(settings, seed);
  Sight sight;
  for (const Person& person : people) {
    sight.people.push_back(&person);
    sight.bodies.push_back(body_capsules(person));
  }
  sight.boxes = boxes;
  sight.robot = robot;
  Stream out, now_due;
  const auto steps =
      static_cast<int>(std::lround((seconds + settings.latency + settings.jitter) * 1000));
  for (int i = 0; i < steps; ++i) {
    const double now = i * 0.001;
    if (now < seconds && sensor.due(now)) sensor.observe(now, sight);
    now_due.clear();
    sensor.collect(now, now_due);
    for (auto& delivery : now_due) {
      delivery.due = now;
      out.push_back(std::move(delivery));
    }
  }
  return out;
}

bool shows(const HumanObservation& observation, const std::string& joint) {
  for (const ObservedPerson& person : observation.people)
    for (const ObservedJoint& j : person.joints)
      if (j.name == joint) return true;
  return false;
}

TEST(Sensors, rate_from15_to120_hz_is_that_of_the_stream) {
  for (const double rate : {15.0, 30.0, 60.0, 120.0}) {
    SensorSettings s = plain();
    s.rate = rate;
    const Stream stream = watch(s, {person_at("anna", 1.4, 0)}, 10);
    EXPECT_NEAR(static_cast<double>(stream.size()), 10 * rate, 1.01) << rate;
  }
}

TEST(Sensors, knuckles_are_observed_of_a_hand_whose_turn_is_known) {
  Person anna = person_at("anna", 1.4, 0);
  EXPECT_FALSE(shows(watch(plain(), {anna}, 0.1).at(0).message, "r_index"));
  const Vector3 fingers =
      (anna.joints[body::r_hand].position - anna.joints[body::r_wrist].position).normalized();
  const Vector3 normal = fingers.unitOrthogonal();
  anna.palms.push_back({"r_hand", normal});
  const Stream stream = watch(plain(), {anna}, 0.1);
  const auto at = [&](const char* name) -> Vector3 {
    for (const ObservedJoint& joint : stream.at(0).message.people.at(0).joints)
      if (joint.name == name) return joint.position;
    ADD_FAILURE() << name;
    return Vector3::Zero();
  };
  const auto observed = palm_normal(Side::right, fingers, at("r_index") - at("r_pinky"));
  ASSERT_TRUE(observed.has_value());
  EXPECT_GT(observed->dot(normal), 0.999);
  EXPECT_FALSE(shows(stream.at(0).message, "l_index"));
  SensorSettings body_only = plain();
  body_only.joints = {"r_wrist", "r_hand"};
  EXPECT_FALSE(shows(watch(body_only, {anna}, 0.1).at(0).message, "r_index"));
}

TEST(Sensors, latency_and_jitter_are_those_of_the_stream_and_order_is_kept) {
  SensorSettings s = plain();
  s.latency = 0.06;
  s.jitter = 0.02;
  const Stream stream = watch(s, {person_at("anna", 1.4, 0)}, 60);
  double sum = 0, least = 1, most = 0, squares = 0, before = -1;
  for (const auto& d : stream) {
    const double delay = d.due - d.seen;
    sum += delay;
    squares += delay * delay;
    least = std::min(least, delay);
    most = std::max(most, delay);
    ASSERT_GT(d.seen, before);
    before = d.seen;
  }
  const double n = static_cast<double>(stream.size()), mean = sum / n,
               deviation = std::sqrt(squares / n - mean * mean);
  EXPECT_NEAR(mean, 0.06, 0.002);
  EXPECT_NEAR(deviation, 0.02 / std::sqrt(3.0), 0.001) << "uniform within the jitter";
  EXPECT_GE(least, 0.04 - 1e-9);
  EXPECT_LE(most, 0.081 + 1e-9);
}

TEST(Sensors, noise_has_the_standard_deviation_asked) {
  SensorSettings s = plain();
  s.noise = 0.01;
  const Person anna = person_at("anna", 1.4, 0);
  double squares = 0, n = 0;
  for (const auto& d : watch(s, {anna}, 20)) {
    for (std::size_t j = 0; j < anna.joints.size(); ++j, n += 3)
      squares +=
          (d.message.people.at(0).joints.at(j).position - anna.joints[j].position).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squares / n), 0.01, 0.0003);
}

TEST(Sensors, drop_outs_are_the_share_asked_and_independent) {
  SensorSettings s = plain();
  s.rate = 100;
  s.dropout = 0.2;
  const Stream stream = watch(s, {person_at("anna", 1.4, 0)}, 200);
  EXPECT_NEAR(1 - static_cast<double>(stream.size()) / 20000, 0.2, 0.012)
      << "4 standard deviations";
  int pairs = 0;  // pairs of consecutive losses
  for (std::size_t i = 1; i < stream.size(); ++i)
    pairs +=
        std::max(0, static_cast<int>(std::lround((stream[i].seen - stream[i - 1].seen) * 100)) - 2);
  EXPECT_NEAR(pairs / 20000.0, 0.04, 0.008);
}

TEST(Sensors, bursts_begin_and_last_as_asked) {
  SensorSettings s = plain();
  s.rate = 100;
  s.burst_rate = 0.5;
  s.burst_length = 0.3;
  const Stream stream = watch(s, {person_at("anna", 1.4, 0)}, 600);
  int bursts = 0;
  double silent = 0;
  for (std::size_t i = 1; i < stream.size(); ++i) {
    const double gap = stream[i].seen - stream[i - 1].seen - 0.01;
    if (gap > 0.005) ++bursts, silent += gap;
  }
  EXPECT_NEAR(bursts / 600.0, 0.5 / (1 + 0.5 * 0.3), 0.08);
  EXPECT_NEAR(silent / bursts, 0.3, 0.07);
}

TEST(Sensors, joints_are_missing_by_the_share_asked) {
  SensorSettings s = plain();
  s.joint_dropout = 0.3;
  double seen = 0, all = 0;
  for (const auto& d : watch(s, {person_at("anna", 1.4, 0)}, 60)) {
    all += kBodyJoints.size();
    if (!d.message.people.empty()) seen += static_cast<double>(d.message.people[0].joints.size());
  }
  EXPECT_NEAR(seen / all, 0.7, 0.012);
}

TEST(Sensors, one_arm_only) {
  SensorSettings s = plain();
  s.joints = {"r_shoulder", "r_elbow", "r_wrist", "r_hand"};
  for (const auto& d : watch(s, {person_at("anna", 1.4, 0)}, 1)) {
    ASSERT_EQ(d.message.people.at(0).joints.size(), 4u);
    for (const auto& joint : d.message.people[0].joints) EXPECT_EQ(joint.name[0], 'r');
  }
}

TEST(Sensors, gaze_is_missing_by_the_share_asked_or_comes_alone_or_not_at_all) {
  SensorSettings s = plain();
  s.gaze_dropout = 0.4;
  double with = 0, all = 0;
  for (const auto& d : watch(s, {person_at("anna", 1.4, 0)}, 60))
    ++all, with += d.message.people.at(0).has_gaze;
  EXPECT_NEAR(with / all, 0.6, 0.05);

  s = plain();
  s.gaze = GazeOutput::none;
  for (const auto& d : watch(s, {person_at("anna", 1.4, 0)}, 1))
    EXPECT_FALSE(d.message.people.at(0).has_gaze);
  s.gaze = GazeOutput::only;
  for (const auto& d : watch(s, {person_at("anna", 1.4, 0)}, 1)) {
    EXPECT_TRUE(d.message.people.at(0).has_gaze);
    EXPECT_TRUE(d.message.people.at(0).joints.empty());
    EXPECT_EQ(d.message.coverage.high, Vector3::Zero())
        << "a gaze tracker does not say that nobody is there";
  }
}

TEST(Sensors, a_wall_hides_what_is_behind_it_and_only_that) {
  SensorSettings s = plain();
  s.T_world_sensor = make_pose({0, 0, 1.6});
  s.occlusion = true;
  const Person anna = person_at("anna", 2, 0);
  const SightBox wall{make_pose({1, 0, 0.6}), {0.1, 1.5, 1.2}};
  const Stream open = watch(s, {anna}, 1), behind = watch(s, {anna}, 1, 3, {wall});
  ASSERT_FALSE(open.empty());
  EXPECT_TRUE(shows(open[0].message, "r_ankle"));
  for (const auto& d : behind) {
    EXPECT_FALSE(shows(d.message, "r_ankle"));
    EXPECT_FALSE(shows(d.message, "l_knee"));
    EXPECT_TRUE(shows(d.message, "head"));
    EXPECT_TRUE(shows(d.message, "neck"));
  }
  const SightBox beyond{make_pose({3, 0, 0.4}), {0.1, 1.5, 0.8}};
  EXPECT_TRUE(shows(watch(s, {anna}, 0.1, 3, {beyond}).at(0).message, "r_ankle"));
}

TEST(Sensors, robot_and_other_people_hide_too) {
  SensorSettings s = plain();
  s.T_world_sensor = make_pose({0, 0, 1.4});
  s.occlusion = true;
  const Person anna = person_at("anna", 2, 0);
  const SightCapsule arm{{1, -0.5, 1.44}, {1, 0.5, 1.44}, 0.06};
  EXPECT_TRUE(shows(watch(s, {anna}, 0.1).at(0).message, "neck"));
  EXPECT_FALSE(shows(watch(s, {anna}, 0.1, 3, {}, {arm}).at(0).message, "neck"));
  const Stream two = watch(s, {anna, person_at("bert", 1.2, 0)}, 0.1);
  for (const ObservedPerson& p : two.at(0).message.people)
    if (p.body == "anna") {
      for (const auto& joint : p.joints) EXPECT_NE(joint.name, "torso") << "bert stands before it";
    }
}

TEST(Sensors, eyes_are_not_seen_from_behind) {
  SensorSettings s = plain();
  s.T_world_sensor = make_pose({0, 0, 1.6});
  s.occlusion = true;
  EXPECT_TRUE(watch(s, {person_at("anna", 2, 0, M_PI)}, 0.1).at(0).message.people.at(0).has_gaze);
  EXPECT_FALSE(watch(s, {person_at("anna", 2, 0, 0)}, 0.1).at(0).message.people.at(0).has_gaze);
}

TEST(Sensors, field_of_view_and_range_limit_what_is_seen) {
  SensorSettings s = plain();
  s.T_world_sensor = make_pose({0, 0, 1.2});
  s.fov_horizontal = 1.0;
  s.fov_vertical = 0.6;
  s.range = 3;
  EXPECT_TRUE(in_view(s, {2, 0.9, 1.2}));
  EXPECT_FALSE(in_view(s, {2, 1.2, 1.2}));
  EXPECT_FALSE(in_view(s, {-2, 0, 1.2}));
  EXPECT_FALSE(in_view(s, {2, 0, 1.9}));
  EXPECT_FALSE(in_view(s, {3.1, 0, 1.2}));
  EXPECT_NE(coverage_error(s), "") << "the whole room is not in this view";
  s.coverage = {{1.5, -0.5, 1.0}, {2.5, 0.5, 1.4}};
  EXPECT_EQ(coverage_error(s), "");
}

TEST(Sensors, one_that_is_carried_sees_what_is_before_it_and_claims_nothing) {
  SensorSettings s = plain();
  s.link = "head";
  s.fov_horizontal = 1.0;
  s.fov_vertical = 1.2;
  const Person anna = person_at("anna", 1.8, 0);
  Sight sight;
  sight.people = {&anna};
  sight.bodies = {body_capsules(anna)};
  const auto sees_her = [&](double yaw) {
    HumanSensor sensor(s, 3);
    Stream seen;
    EXPECT_TRUE(sensor.due(0));
    sensor.carry_to(make_pose(Vector3(0, 0, 1.4),
                              Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3::UnitZ()))));
    sensor.observe(0, sight);
    sensor.collect(1, seen);
    EXPECT_EQ(seen.at(0).message.coverage.low, seen.at(0).message.coverage.high);
    return shows(seen.at(0).message, "head");
  };
  EXPECT_TRUE(sees_her(0));
  EXPECT_TRUE(sees_her(0.3));
  EXPECT_FALSE(sees_her(0.8));
  EXPECT_FALSE(sees_her(M_PI));
}

TEST(Sensors, in_the_world_the_head_sees_where_it_looks) {
  const auto gazes = [](double pan) {
    config::Scenario scenario = mug_in_hand();
    add_person(scenario, config::STILL)->set_x(in_hand().x() + 1.0);
    (*scenario.mutable_start())["head_pan"] = pan;
    (*scenario.mutable_start())["head_tilt"] = 0.0;
    auto* sensor = scenario.add_human_sensors();
    sensor->set_source("head");
    sensor->set_link("camera");
    sensor->set_rate(30);
    sensor->set_gaze(config::ONLY_GAZE);
    sensor->set_fov_horizontal(1.0);
    SimWorld world(jido(), library(), scenario, SimSettings{}, 1);
    Stream seen;
    for (int i = 0; i < 300; ++i) {
      world.step();
      world.human_observations(seen);
    }
    int count = 0;
    for (const auto& d : seen)
      for (const ObservedPerson& person : d.message.people) count += person.has_gaze;
    return count;
  };
  const Vector3 p_camera =
      jido().link_pose(jido().rest_configuration(), jido().link_index("camera")).translation();
  const Vector3 to_anna = in_hand() + Vector3(1.0, 0, 0) - p_camera;
  const double toward = std::atan2(to_anna.y(), to_anna.x());
  EXPECT_GE(gazes(toward), 5);
  EXPECT_EQ(gazes(toward + 1.0), 0);
}

TEST(Sensors, samples_are_as_frequent_as_requested_while_requests_are_received) {
  SampleClock clock(30, 10);
  auto samples = [&clock, now = 0.0](double seconds, double requested) mutable {
    int count = 0;
    for (int i = 0; i < std::lround(seconds * 1000); ++i, now += 0.001) {
      if (requested >= 0 && i % 100 == 0) clock.request(requested, now);
      count += clock.due(now);
    }
    return count;
  };
  EXPECT_EQ(samples(2, -1), 60) << "own rate without a request";
  EXPECT_NEAR(samples(2, 15), 30, 1);
  EXPECT_NEAR(samples(2, 1), 20, 1) << "not below min_rate";
  EXPECT_NEAR(samples(2, 500), 60, 1) << "not above the own rate";
  EXPECT_NEAR(samples(2, 12), 24, 1);
  EXPECT_NEAR(samples(0.1, 30), 3, 1) << "a higher rate applies at once";
  EXPECT_NEAR(samples(2, 12), 24, 1);
  EXPECT_NEAR(samples(2.5, -1), 6 + 60, 2) << "a request expires after 0.5 s";
  EXPECT_NEAR(samples(2, 0), 60, 1) << "0: own rate";
}

TEST(Sensors, a_request_is_followed_by_the_source_that_it_names) {
  HumanSensor sensor(plain(), 3);
  auto due = [&sensor, now = 0.0](const SensorRequest& request) mutable {
    int count = 0;
    for (int i = 0; i < 1000; ++i, now += 0.001) {
      if (i % 100 == 0) sensor.request(now, request);
      count += sensor.due(now);
    }
    return count;
  };
  SensorRequest request;
  request.people_rate = 12;
  EXPECT_NEAR(due(request), 12, 1) << "every source";
  request.source = "camera";
  request.people_rate = 15;
  EXPECT_NEAR(due(request), 15, 1);
  request.source = "other";
  request.people_rate = 10;
  EXPECT_NEAR(due(request), 23, 2) << "own rate once the last request has expired";
}

TEST(Sensors, knuckles_are_left_out_where_no_hands_are_wanted) {
  SensorSettings s = plain();
  HumanSensor sensor(s, 3);
  Person person = person_at("anna", 1.4, 0);
  person.palms = {{"l_hand", -Vector3::UnitZ()}};
  Sight sight;
  sight.people = {&person};
  sight.bodies = {body_capsules(person)};
  const auto knuckles = [&](bool hands, double now) {
    SensorRequest request;
    request.hands = hands;
    sensor.request(now, request);
    sensor.observe(now, sight);
    Stream out;
    sensor.collect(now + 1, out);
    const auto& joints = out.back().message.people.at(0).joints;
    return std::count_if(joints.begin(), joints.end(), [](const ObservedJoint& joint) {
      return joint.name.ends_with("index") || joint.name.ends_with("pinky");
    });
  };
  EXPECT_EQ(knuckles(true, 1), 2);
  EXPECT_EQ(knuckles(false, 2), 0);
  EXPECT_EQ(knuckles(true, 3), 2);
}

TEST(Sensors, between_samples_of_all_objects_come_those_requested) {
  SensorSettings s = plain();
  s.noise = 0;
  ObjectSensor sensor(s, 3);
  Sight sight;
  for (const auto& [id, x] :
       std::vector<std::pair<std::string, double>>{{"mug", 1.0}, {"can", 2.0}, {"box", 0.5}}) {
    sight.objects.push_back({id, id, Pose::Identity()});
    sight.objects.back().T_world_object.translation().x() = x;
  }
  SensorRequest request;
  request.objects_rate = 10;
  request.region_rate = 30;
  request.objects = {"can"};
  request.region = {{0.4, -0.1, -0.1}, {0.6, 0.1, 0.1}};
  std::map<std::string, int> seen;
  for (int i = 0; i < 2000; ++i) {
    const double now = 0.001 * i;
    if (i % 100 == 0) sensor.request(now, request);
    if (sensor.due(now)) sensor.observe(now, sight);
  }
  std::vector<Delivery<ObjectObservation>> out;
  sensor.collect(10, out);
  for (const auto& delivery : out)
    for (const ObservedObject& object : delivery.message.objects) ++seen[object.id];
  EXPECT_NEAR(seen["mug"], 20, 2) << "neither named nor in the region";
  EXPECT_GE(seen["can"], 58);
  EXPECT_GE(seen["box"], 58);
  EXPECT_LE(seen["can"], 82);
}

TEST(Sensors, identity_swaps_happen_as_often_as_asked_and_places_stay) {
  SensorSettings s = plain();
  s.swap_rate = 0.5;
  int swaps = 0;
  std::string before = "anna";
  for (const auto& d : watch(s, {person_at("anna", 1.4, 1), person_at("bert", 1.4, -1)}, 200)) {
    ASSERT_EQ(d.message.people.size(), 2u);
    const std::string& first = d.message.people[0].body;
    EXPECT_GT(d.message.people[0].joints[0].position.y(), 0) << "only names change";
    EXPECT_NE(first, d.message.people[1].body);
    swaps += first != before;
    before = first;
  }
  EXPECT_NEAR(swaps, 100, 35);
  std::set<std::string> names;
  for (const auto& d : watch(s, {person_at("anna", 1.4, 1)}, 60))
    names.insert(d.message.people.at(0).body);
  EXPECT_GT(names.size(), 10u) << "a single body gets new names";
}

TEST(Sensors, faults_in_time_do_what_they_say) {
  const Person anna = person_at("anna", 1.4, 0);
  const auto with = [&](SensorFaultKind kind) {
    SensorSettings s = plain();
    s.noise = 0.01;
    s.faults = {{kind, 1.0, 0.5, {0, 0.7, 0}, 0.25}};
    return watch(s, {anna}, 2);
  };
  const auto during = [](const Delivery<HumanObservation>& d) {
    return d.due - 0.04 > 1.0 - 1e-6 && d.due - 0.04 < 1.5 - 1e-6;
  };
  for (const auto& d : with(SensorFaultKind::gap)) EXPECT_FALSE(during(d));
  const auto nose = [](const Delivery<HumanObservation>& d) {
    return d.message.people.at(0).joints.at(0).position;
  };
  const auto changes = [&](const Stream& stream) {
    std::pair<int, int> out{0, 0};  // repeats of content and of capture time during the fault
    for (std::size_t i = 1; i < stream.size(); ++i) {
      if (!during(stream[i]) || !during(stream[i - 1])) continue;
      out.first += nose(stream[i]) != nose(stream[i - 1]);
      out.second += stream[i].seen != stream[i - 1].seen;
    }
    return out;
  };
  EXPECT_EQ(changes(with(SensorFaultKind::frozen)), (std::pair{0, 14}));
  EXPECT_EQ(changes(with(SensorFaultKind::repeated)), (std::pair{0, 0}));
  EXPECT_EQ(changes(with(SensorFaultKind::late)).first,
            0 + changes(with(SensorFaultKind::late)).second);
  double latest = 0;
  for (const auto& d : with(SensorFaultKind::late)) latest = std::max(latest, d.due - d.seen);
  EXPECT_NEAR(latest, 0.29, 0.002);
  for (const auto& d : with(SensorFaultKind::teleport))
    EXPECT_NEAR(nose(d).y(), during(d) ? 0.7 : 0.0, 0.05);
  for (const auto& d : with(SensorFaultKind::swap))
    EXPECT_EQ(d.message.people.at(0).body == "anna", !during(d));
  for (const auto& d : with(SensorFaultKind::blind)) EXPECT_EQ(d.message.people.empty(), during(d));
}

TEST(Sensors, a_disturbance_comes_and_goes_while_it_runs) {
  const Person anna = person_at("anna", 1.4, 0);
  Sight sight;
  sight.people = {&anna};
  SensorSettings s = plain();
  s.noise = 0.01;
  HumanSensor sensor(s, 3);
  double now = 0;
  const auto watch_for = [&](double seconds) {
    Stream out;
    for (const double end = now + seconds; now < end; now += 0.001) {
      if (sensor.due(now)) sensor.observe(now, sight);
      sensor.collect(now, out);
    }
    return out;
  };
  const auto healthy = [&] {
    for (const auto& d : watch_for(1.0))
      if (d.seen > now - 0.4) {
        EXPECT_EQ(d.message.people.size(), 1u);
        EXPECT_EQ(d.message.coverage.high, s.coverage.high);
        EXPECT_NEAR(d.due - d.seen, s.latency, 1e-9);
      }
  };
  const auto disturbed = [&](const SensorFault& fault) {
    sensor.disturb(fault);
    watch_for(0.6);
    const Stream out = watch_for(0.5);
    sensor.restore();
    return out;
  };
  healthy();
  const Stream empty = disturbed({SensorFaultKind::repeated_empty, now, 9});
  ASSERT_GT(empty.size(), 10u);
  for (const auto& d : empty) {
    EXPECT_TRUE(d.message.people.empty());
    EXPECT_EQ(d.message.coverage.high, s.coverage.high) << "it claims to see nobody";
    EXPECT_EQ(d.seen, empty.front().seen) << "and says so of the same instant";
  }
  healthy();
  for (const auto& d : disturbed({SensorFaultKind::elsewhere, now, 9, {100, 0, 0}})) {
    EXPECT_TRUE(d.message.people.empty());
    EXPECT_EQ(d.message.coverage.low.x(), s.coverage.low.x() + 100);
  }
  healthy();
  for (const auto& d : disturbed({SensorFaultKind::late, now, 9, Vector3::Zero(), 0.5}))
    EXPECT_NEAR(d.due - d.seen, 0.5 + s.latency, 1e-9);
  healthy();
  for (int again = 0; again < 2; ++again) {
    const Stream frozen = disturbed({SensorFaultKind::frozen, now, 9});
    ASSERT_GT(frozen.size(), 10u);
    EXPECT_NE(frozen.front().seen, frozen.back().seen) << "with new stamps";
    EXPECT_EQ(frozen.front().message.people.at(0).joints.at(0).position,
              frozen.back().message.people.at(0).joints.at(0).position);
    EXPECT_GT(frozen.front().seen, now - 0.6) << "not a picture of an earlier disturbance";
    healthy();
  }
}

TEST(Sensors, the_same_seed_gives_the_same_stream) {
  SensorSettings s = plain();
  s.noise = 0.01;
  s.jitter = 0.02;
  s.dropout = 0.1;
  s.swap_rate = 1;
  s.burst_rate = 0.2;
  s.burst_length = 0.2;
  const std::vector<Person> people{person_at("anna", 1.4, 1), person_at("bert", 1.4, -1)};
  const Stream a = watch(s, people, 10, 5), b = watch(s, people, 10, 5),
               other = watch(s, people, 10, 6);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].due, b[i].due);
    EXPECT_EQ(a[i].message.people[0].body, b[i].message.people[0].body);
    EXPECT_EQ(a[i].message.people[0].joints[0].position, b[i].message.people[0].joints[0].position);
  }
  EXPECT_TRUE(a.size() != other.size() || a[0].message.people[0].joints[0].position !=
                                              other[0].message.people[0].joints[0].position);
}

TEST(Sensors, in_the_world_the_robots_own_arm_hides_the_person_from_a_source_behind_it) {
  config::Scenario scenario = mug_in_hand();
  add_person(scenario, config::STILL);
  const auto sensor = [&](const char* name, bool occlusion) {
    auto* s = scenario.add_human_sensors();
    s->set_source(name);
    s->set_rate(30);
    const Vector3 eye = in_hand() - Vector3(0.35, 0, 0);
    s->mutable_pose()->mutable_xyz()->set_x(eye.x());
    s->mutable_pose()->mutable_xyz()->set_y(eye.y());
    s->mutable_pose()->mutable_xyz()->set_z(eye.z());
    s->set_occlusion(occlusion);
  };
  sensor("open", false);
  sensor("hidden", true);
  SimWorld world(jido(), library(), scenario, SimSettings{}, 1);
  std::vector<Delivery<HumanObservation>> seen;
  for (int i = 0; i < 100; ++i) {
    world.step();
    world.human_observations(seen);
  }
  std::map<std::string, std::size_t> joints;
  for (const auto& d : seen)
    for (const auto& p : d.message.people) joints[d.message.source] += p.joints.size();
  EXPECT_GT(joints["open"], 0u);
  EXPECT_LT(joints["hidden"], joints["open"]);
}

std::string refusal(const std::function<void(config::SensorDescription&)>& spoil,
                    bool of_people = true) {
  config::Scenario scenario;
  scenario.set_name("s");
  auto* sensor = of_people ? scenario.add_human_sensors() : scenario.add_object_sensors();
  sensor->set_source("camera");
  sensor->set_rate(30);
  spoil(*sensor);
  try {
    set_up(scenario, jido(), library(), 4, {}, 1);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(Sensors, settings_that_make_no_sense_are_refused_in_one_sentence) {
  using D = config::SensorDescription;
  EXPECT_EQ(refusal([](D&) {}), "");
  EXPECT_EQ(refusal([](D& d) { d.set_rate(0); }),
            "scenario s: sensor camera: rate is 0, must be between 1 and 1000");
  EXPECT_EQ(refusal([](D& d) { d.set_dropout(1.5); }),
            "scenario s: sensor camera: dropout is 1.5, must be between 0 and 0.999");
  EXPECT_NE(refusal([](D& d) { d.set_rate(std::nan("")); }), "");
  EXPECT_EQ(refusal([](D& d) { d.set_occlusion(true); }),
            "scenario s: sensor camera: occlusion, range and field of view need its pose");
  EXPECT_NE(refusal([](D& d) { d.add_joints("nose"); }).find("no REP-155 joint"),
            std::string::npos);
  EXPECT_NE(refusal([](D& d) { d.set_swap_rate(1); }, false).find("for sensors of people"),
            std::string::npos);
  EXPECT_EQ(refusal([](D& d) {
              d.set_link("camera");
              d.set_fov_horizontal(1);
            }),
            "");
  EXPECT_NE(
      refusal([](D& d) { d.set_link("nose"); }).find("carried by nose, which is no link of jido"),
      std::string::npos);
  EXPECT_NE(refusal([](D& d) {
              d.set_link("camera");
              d.mutable_coverage_low();
              d.mutable_coverage_high();
            }).find("it can claim no coverage"),
            std::string::npos);
  EXPECT_NE(refusal([](D& d) {
              d.mutable_pose();
              d.set_fov_horizontal(1);
            }).find("outside its field of view"),
            std::string::npos);
}

}  // namespace
}  // namespace handsel::sim::sensors_test
