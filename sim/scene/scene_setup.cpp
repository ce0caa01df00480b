// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/scene_setup.hpp"

#include <algorithm>
#include <set>

#include "common/base/errors.hpp"
#include "common/messages/names.hpp"
#include "common/model/platform.hpp"
#include "sim/scene/free_place.hpp"

namespace handsel::sim {

namespace {

Vector3 vec(const config::Vec3& v) { return {v.x(), v.y(), v.z()}; }

PersonKind kind_of(config::PersonBehaviour behaviour) {
  switch (behaviour) {
    case config::STILL:
      return PersonKind::still;
    case config::WALKER:
      return PersonKind::walker;
    case config::RECORDING:
      return PersonKind::recording;
    case config::GIVER:
      return PersonKind::giver;
    case config::FETCHER:
      return PersonKind::fetcher;
    case config::PARTNER:
      return PersonKind::partner;
    case config::EXTERNAL:
      return PersonKind::external;
    default:
      return PersonKind::taker;
  }
}

class Reader {
 public:
  Reader(const config::Scenario& scenario, const RobotModel& robot, const ObjectLibrary& library,
         const std::filesystem::path& data_root, std::uint64_t seed)
      : scenario_(scenario),
        robot_(robot),
        library_(library),
        data_root_(data_root),
        random_(seed * 0x9e3779b97f4a7c15ULL + 0x5eed) {}

  SceneSetup read(double coverage) {
    require_names(scenario_.boxes(), "box");
    require_names(scenario_.objects(), "object");
    require_names(scenario_.people(), "person");
    out_.T_world_base = pose_of(scenario_.base());
    out_.p_world_robot = out_.T_world_base.translation();
    read_start();
    if (drives(robot_)) put_on_platform();
    for (const auto& box : scenario_.boxes()) read_box(box);
    for (const auto& object : scenario_.objects()) read_object(object);
    for (int i = 0; i < scenario_.objects_size(); ++i)
      if (scenario_.objects(i).free_place()) put_at_free_place(i);
    for (const auto& person : scenario_.people()) read_person(person);
    for (const auto& sensor : scenario_.human_sensors())
      out_.human_sensors.push_back(sensor_of(sensor, coverage, true));
    for (const auto& sensor : scenario_.object_sensors())
      out_.object_sensors.push_back(sensor_of(sensor, coverage, false));
    for (const auto& d : scenario_.disturbances())
      out_.disturbances.push_back({d.at(), {0, sim_action(d.action()), d.subject(), d.value()}});
    std::stable_sort(out_.disturbances.begin(), out_.disturbances.end(),
                     [](const auto& a, const auto& b) { return a.at < b.at; });
    if (!out_.objects.empty()) out_.watched = out_.objects.front().id;
    for (const auto& task : scenario_.tasks()) {
      if (task.object().empty()) continue;
      out_.watched = task.object();
      break;
    }
    out_.never_releases = scenario_.robot_never_releases();
    out_.help_hold = scenario_.help_hold();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw ConfigError("scenario " + scenario_.name() + ": " + what);
  }
  double jitter(double size) {
    return size * (2 * std::uniform_real_distribution<double>(0, 1)(random_) - 1);
  }

  template <class Entries>
  void require_names(const Entries& entries, const std::string& kind) const {
    // Max number of entries of one kind: each entry takes time in every physics step.
    constexpr int kMaxEntries = 200;
    if (entries.size() > kMaxEntries)
      fail(std::to_string(entries.size()) + " entries of kind " + kind + ", must be at most " +
           std::to_string(kMaxEntries));
    std::set<std::string> known;
    for (const auto& entry : entries) {
      if (entry.id().empty()) fail(kind + " has no id: each needs a name of its own");
      if (!known.insert(entry.id()).second) fail(kind + " \"" + entry.id() + "\" is there twice");
    }
  }

  void read_start() {
    out_.start = robot_.rest_configuration();
    if (out_.start.size() != robot_.dof()) out_.start = Vector::Zero(robot_.dof());
    std::vector<std::string> names;
    for (const auto& entry : scenario_.start()) names.push_back(entry.first);
    std::sort(names.begin(), names.end());
    for (const std::string& joint : names) {
      const auto axis = std::find_if(robot_.axes().begin(), robot_.axes().end(),
                                     [&](const Axis& a) { return a.name == joint; });
      if (axis == robot_.axes().end())
        fail("start names joint " + joint + ", which robot " + robot_.name() + " does not have");
      const double value = scenario_.start().at(joint);
      if (value < axis->lower || value > axis->upper) {
        fail("start of " + joint + " is " + std::to_string(value) + ", must be between " +
             std::to_string(axis->lower) + " and " + std::to_string(axis->upper));
      }
      out_.start[axis - robot_.axes().begin()] = value;
    }
  }

  /// Places the platform at the base of the scenario, world frame.
  void put_on_platform() {
    const Pose& T = out_.T_world_base;
    const double heading = std::atan2(T.linear()(1, 0), T.linear()(0, 0));
    out_.start =
        with_platform_at(robot_, out_.start, {T.translation().x(), T.translation().y(), heading});
    out_.T_world_base = make_pose({0, 0, T.translation().z()});
  }

  void read_box(const config::BoxDescription& box) {
    if (vec(box.size()).minCoeff() <= 0)
      fail("box " + box.id() + " has a size that is not above 0");
    out_.boxes.push_back({box.id(), pose_of(box.pose()), vec(box.size()), box.supports()});
  }

  void read_object(const config::ObjectPlacement& object) {
    StartObject o{object.id(), object.model(), library_(object.model()), pose_of(object.pose())};
    if (o.model == nullptr)
      fail(
          "object " + object.id() + " has the unknown model \"" + object.model() +
          "\"; a model is named without folder and ending, as \"mug\", and searched in the folders "
          "of --path and HANDSEL_PATH, the working directory and objects/");
    o.T_world_object.translation() += Vector3(jitter(object.jitter()), jitter(object.jitter()), 0);
    if (object.turn() > 0)
      o.T_world_object.linear() =
          Eigen::AngleAxisd(jitter(object.turn()), Vector3::UnitZ()).toRotationMatrix() *
          o.T_world_object.linear();
    if (object.on().empty() && object.free_place())
      fail("object " + object.id() + " is at a free place but `on` names no box");
    if (!object.on().empty() && object.pose().xyz().z() == 0) {
      const StartBox& box = surface_of(object);
      o.T_world_object.translation().z() =
          box.T_world_box.translation().z() + box.size.z() / 2 + o.model->height_above_support;
    }
    out_.objects.push_back(o);
  }

  const StartBox& surface_of(const config::ObjectPlacement& object) const {
    const auto box = std::find_if(out_.boxes.begin(), out_.boxes.end(),
                                  [&](const StartBox& b) { return b.id == object.on(); });
    if (box == out_.boxes.end())
      fail("object " + object.id() + " stands on " + object.on() +
           ", which is no box of the scenario");
    return *box;
  }

  /// Returns the radius of a circle about the origin that contains the object, seen from above [m].
  static double radius_of(const ObjectModel& model) {
    double radius = 0;
    for (const Vector3& v : model.mesh.vertices)
      radius = std::max(radius, Vector2(v.x(), v.y()).norm());
    return radius;
  }

  /// Returns the top of a box with the objects already placed there and the boxes that reach
  /// through.
  Surface surface_on(const StartBox& box) const {
    const Pose T_box_world = box.T_world_box.inverse();
    Surface surface;
    surface.size = Vector2(box.size.x(), box.size.y());
    for (int i = 0; i < scenario_.objects_size(); ++i) {
      const config::ObjectPlacement& other = scenario_.objects(i);
      if (other.on() != box.id || (other.free_place() && !placed_.contains(i))) continue;
      const Vector3 p = T_box_world * out_.objects[i].T_world_object.translation();
      surface.circles.push_back({{p.x(), p.y()}, radius_of(*out_.objects[i].model)});
    }
    const double top = box.size.z() / 2;
    for (const StartBox& other : out_.boxes) {
      if (other.id == box.id) continue;
      const Pose T = T_box_world * other.T_world_box;
      const Vector3 half = T.linear().cwiseAbs() * other.size / 2;
      const Vector3 low = T.translation() - half, high = T.translation() + half;
      constexpr double kMinHeadroom = 0.4;  // min free height above a place within reach [m]
      if (high.z() > top + 1e-3 && low.z() < top + kMinHeadroom)
        surface.rectangles.push_back({{low.x(), low.y()}, {high.x(), high.y()}});
    }
    return surface;
  }

  void put_at_free_place(int index) {
    const config::ObjectPlacement& object = scenario_.objects(index);
    const StartBox& box = surface_of(object);
    StartObject& start = out_.objects[index];
    const double clearance = object.clearance() > 0 ? object.clearance() : 0.05;
    const auto place = free_place(surface_on(box), radius_of(*start.model), clearance, [&] {
      return std::uniform_real_distribution<double>(0, 1)(random_);
    });
    if (!place) fail("there is no free place for object " + object.id() + " on " + box.id);
    const double z = start.T_world_object.translation().z();
    start.T_world_object.translation() = box.T_world_box * Vector3(place->x(), place->y(), 0);
    start.T_world_object.translation().z() = z;
    placed_.insert(index);
  }

  void read_person(const config::PersonDescription& person) {
    StartPerson p;
    PersonSettings& s = p.settings;
    s.id = person.id();
    s.feet = Vector3(person.x() + jitter(person.jitter()), person.y() + jitter(person.jitter()), 0);
    s.yaw = person.yaw();
    if (person.stature() > 0) s.stature = person.stature();
    if (s.stature < 1.2 || s.stature > 2.2)
      fail("stature of " + s.id + " is " + std::to_string(s.stature) +
           ", must be between 1.2 and 2.2");
    s.kind = kind_of(person.behaviour());
    for (const StartBox& box : out_.boxes) s.furniture.push_back({box.T_world_box, box.size});
    if (person.reaction() > 0) s.reaction = person.reaction();
    s.reaction *= 1 + (person.jitter() > 0 ? jitter(std::min(0.5, person.jitter() * 5)) : 0);
    s.approach_from = person.approach_from();
    if (person.pull() > 0) s.pull = person.pull();
    s.left_handed = person.left_handed();
    if (s.kind == PersonKind::recording) {
      if (person.recording().empty()) fail("person " + s.id + " plays a recording but names none");
      Recording recording = load_recording(resolve_recording(person.recording(), data_root_));
      if (person.stature() > 0) recording = retarget(recording, s.stature);
      s.stature = recording.stature;
      s.recording = std::make_shared<const Recording>(std::move(recording));
    }
    if (s.kind == PersonKind::external) {
      if (person.external().empty())
        fail("person " + s.id + " is moved from outside but `external` names no source");
      for (const auto& sensor : scenario_.human_sensors())
        if (sensor.source() == person.external())
          fail("person " + s.id + " would follow the simulator's own sensor " + sensor.source());
      s.external = person.external();
      if (person.correction() < 0 || person.correction() > 1)
        fail("correction of " + s.id + " is " + std::to_string(person.correction()) +
             ", must be between 0 and 1");
      if (person.correction() > 0) s.correction = person.correction();
    }
    s.holds = s.kind == PersonKind::partner && !person.object().empty();
    if (s.kind == PersonKind::giver || s.kind == PersonKind::fetcher || s.holds) {
      const bool gives = s.kind != PersonKind::fetcher;
      (gives ? p.holds : p.fetches) = person.object();
      if (std::none_of(out_.objects.begin(), out_.objects.end(),
                       [&](const StartObject& o) { return o.id == person.object(); })) {
        fail("person " + s.id + (gives ? " holds \"" : " fetches \"") + person.object() +
             "\", which is no object of the scenario");
      }
      if (person.fetches_at() < 0)
        fail("fetches_at of " + s.id + " is " + std::to_string(person.fetches_at()) +
             ", must not be negative");
      s.fetches_at = person.fetches_at();
    }
    if (person.has_puts_at() && s.kind != PersonKind::fetcher)
      fail("person " + s.id + " has puts_at but is not FETCHER");
    if (person.has_puts_at()) s.puts_at = vec(person.puts_at());
    if (person.has_varies() && !vary(s, person.varies())) return;
    if (person.has_moves()) read_motion(p, person.moves());
    if (person.has_steps_in()) read_step_in(s, person.steps_in());
    out_.people.push_back(std::move(p));
  }

  void read_step_in(PersonSettings& s, const config::StepIn& visit) {
    if (s.kind != PersonKind::still) fail("person " + s.id + " steps in but is not STILL");
    if (s.approach_from <= 0) fail("person " + s.id + " steps in but approach_from is not above 0");
    if (visit.speed() <= 0) fail("steps_in of " + s.id + ": speed must be above 0");
    if (visit.latest() < visit.earliest())
      fail("steps_in of " + s.id + ": latest must not be below earliest");
    const double draw = std::uniform_real_distribution<double>(0, 1)(random_);
    s.steps_in = {visit.earliest() + draw * (visit.latest() - visit.earliest()), visit.speed(),
                  visit.stays()};
  }

  void read_motion(StartPerson& p, const config::MovingOffer& moves) {
    PersonSettings& s = p.settings;
    if (s.kind != PersonKind::giver) fail("person " + s.id + " moves an offer but is no GIVER");
    if (moves.duration() <= 0) fail("moves of " + s.id + ": duration must be above 0");
    if (moves.fastest() < moves.slowest() || moves.fastest_turn() < moves.slowest_turn())
      fail("moves of " + s.id + ": the fastest must not be below the slowest");
    MovingOfferSettings& m = s.moving;
    m.duration = moves.duration();
    m.start_low = vec(moves.start_low()), m.start_high = vec(moves.start_high());
    m.next_low = vec(moves.next_low()), m.next_high = vec(moves.next_high());
    if ((m.start_high - m.start_low).minCoeff() < 0 || (m.next_high - m.next_low).minCoeff() < 0)
      fail("moves of " + s.id + ": a box has a high corner below its low corner");
    m.spread = moves.spread();
    m.min_speed = moves.slowest(), m.max_speed = moves.fastest();
    m.min_turn_speed = moves.slowest_turn(), m.max_turn_speed = moves.fastest_turn();
    m.max_turn = moves.max_turn(), m.waits_within = moves.waits_within();
    m.seed = random_();
    if (!moves.any_orientation()) return;
    std::normal_distribution<double> normal;
    Eigen::Vector4d turn;
    for (int i = 0; i < 4; ++i) turn[i] = normal(random_);
    p.hand_turn = Eigen::Quaterniond(turn.normalized());
  }

  /// Draws the individual variation of a person; returns false if the person is absent.
  bool vary(PersonSettings& s, const config::PersonVariation& v) {
    for (const double fraction :
         {v.absent(), v.left_handed(), v.hesitates(), v.withdraws(), v.looks_away(), v.sidesteps(),
          v.seated(), v.early(), v.readies(), v.changes_hand()})
      if (fraction < 0 || fraction > 1)
        fail("varies of " + s.id + ": a share is " + std::to_string(fraction) +
             ", must be between 0 and 1");
    for (const double size : {v.place(), v.turn(), v.stature(), v.hesitation(), v.away(),
                              v.sidestep(), v.slowest(), v.begins_after(), v.min_sidestep()})
      if (size < 0)
        fail("varies of " + s.id + ": " + std::to_string(size) + " must not be negative");
    if (v.fastest() < v.slowest())
      fail("varies of " + s.id + ": fastest must not be below slowest");
    if (v.begins_before() < v.begins_after())
      fail("varies of " + s.id + ": begins_before must not be below begins_after");
    // Every number is drawn even if not needed, so a changed fraction does not change other draws.
    const auto within = [this](double low, double high) {
      return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random_);
    };
    const auto chance = [&](double fraction) { return within(0, 1) < fraction; };
    const bool absent = chance(v.absent());
    s.feet += Vector3(jitter(v.place()), jitter(v.place()), 0);
    s.yaw += jitter(v.turn());
    s.stature = std::clamp(s.stature + jitter(v.stature()), 1.2, 2.2);
    s.left_handed = chance(v.left_handed());
    const double speed_scale = within(v.slowest(), v.fastest());
    if (v.fastest() > 0) s.behaviour.speed_scale = speed_scale;
    const auto draw_size = [&](double fraction, double max_value) {
      const bool does = chance(fraction);
      const double size = within(0.3, 1) * max_value;
      return does ? size : 0.0;
    };
    s.behaviour.hesitation = draw_size(v.hesitates(), v.hesitation());
    s.behaviour.withdraws = chance(v.withdraws());
    s.behaviour.look_away = draw_size(v.looks_away(), v.away());
    s.behaviour.look_away_at = within(v.begins_after(), v.begins_before());
    double step = draw_size(v.sidesteps(), v.sidestep()), direction = within(M_PI_2, 3 * M_PI_2);
    if (step > 0 && v.min_sidestep() > 0)
      step =
          v.min_sidestep() + (step / v.sidestep() - 0.3) / 0.7 * (v.sidestep() - v.min_sidestep());
    if (v.only_aside()) direction = direction < M_PI ? M_PI_2 : 3 * M_PI_2;
    s.behaviour.sidestep_at = within(v.begins_after(), v.begins_before());
    s.behaviour.seated = chance(v.seated());
    const Vector3 to_robot =
        (out_.p_world_robot - s.feet).cwiseProduct(Vector3(1, 1, 0)).stableNormalized();
    if (!s.behaviour.seated)
      s.behaviour.sidestep = step * (Eigen::AngleAxisd(direction, Vector3::UnitZ()) * to_robot);
    s.behaviour.early = chance(v.early());
    s.behaviour.from_carry = v.from_carry();
    vary_hands(s, v);
    return !absent;
  }

  /// Draws the variation of the hands from a separate sequence, so that all other draws stay the
  /// same.
  void vary_hands(PersonSettings& s, const config::PersonVariation& v) const {
    auto own = random_;
    std::mt19937_64 random(own());
    const auto unit = [&random] { return std::uniform_real_distribution<double>(0, 1)(random); };
    s.behaviour.readies = unit() < v.readies();
    const bool changes = unit() < v.changes_hand();
    const double at = v.begins_after() + (v.begins_before() - v.begins_after()) * unit();
    if (changes) s.behaviour.changes_hand_at = at;
  }

  SensorSettings sensor_of(const config::SensorDescription& sensor, double coverage,
                           bool of_people) const {
    const auto within = [&](double value, const char* key, double low, double high) {
      if (value >= low && value <= high) return value;
      char range[64];
      std::snprintf(range, sizeof range, "%g, must be between %g and %g", value, low, high);
      fail("sensor " + sensor.source() + ": " + key + " is " + range);
    };
    constexpr double kMaxDropout = 0.999;  // max fraction of lost samples or joints
    SensorSettings s;
    s.source = sensor.source();
    if (s.source.empty()) fail("a sensor has no source: it needs a name");
    s.rate = within(sensor.rate(), "rate", 1, 1000);
    s.latency = within(sensor.latency(), "latency", 0, 10);
    s.noise = within(sensor.noise(), "noise", 0, 1);
    s.jitter = within(sensor.jitter(), "jitter", 0, 10);
    s.dropout = within(sensor.dropout(), "dropout", 0, kMaxDropout);
    s.burst_rate = within(sensor.burst_rate(), "burst_rate", 0, 1000);
    s.burst_length =
        within(sensor.burst_length(), "burst_length", s.burst_rate > 0 ? 1e-3 : 0, 100);
    s.joint_dropout = within(sensor.joint_dropout(), "joint_dropout", 0, kMaxDropout);
    if (sensor.has_pose()) s.T_world_sensor = pose_of(sensor.pose());
    s.link = sensor.link();
    if (!s.link.empty()) {
      if (sensor.has_coverage_low())
        fail("sensor " + s.source + " is carried by " + s.link + ": it can claim no coverage");
      if (robot_.link_index(s.link) < 0)
        fail("sensor " + s.source + " is carried by " + s.link + ", which is no link of " +
             robot_.name());
      s.T_link_sensor = pose_of(sensor.pose());
      s.T_world_sensor = s.T_link_sensor;
    }
    s.fov_horizontal = within(sensor.fov_horizontal(), "fov_horizontal", 0, M_PI);
    s.fov_vertical = within(sensor.fov_vertical(), "fov_vertical", 0, M_PI);
    s.range = within(sensor.range(), "range", 0, 100);
    s.occlusion = sensor.occlusion();
    if (!s.T_world_sensor &&
        (s.occlusion || s.range > 0 || s.fov_horizontal > 0 || s.fov_vertical > 0))
      fail("sensor " + s.source + ": occlusion, range and field of view need its pose");
    const Vector3 centre = out_.p_world_robot;
    s.coverage.low = Vector3(centre.x() - coverage, centre.y() - coverage, -0.1);
    s.coverage.high = Vector3(centre.x() + coverage, centre.y() + coverage, 2.5);
    if (sensor.has_coverage_low() != sensor.has_coverage_high())
      fail("sensor " + s.source + ": coverage_low and coverage_high go together");
    if (sensor.has_coverage_low())
      s.coverage = {vec(sensor.coverage_low()), vec(sensor.coverage_high())};
    if ((s.coverage.low.array() > s.coverage.high.array()).any())
      fail("sensor " + s.source + ": coverage_high lies below coverage_low");
    if (of_people) {
      if (const std::string why = coverage_error(s); !why.empty())
        fail("sensor " + s.source + ": " + why);
    }
    for (const std::string& joint : sensor.joints()) {
      if (body_joint_index(joint) < 0)
        fail("sensor " + s.source + " tracks " + joint + ", which is no REP-155 joint of a body");
      s.joints.push_back(joint);
    }
    s.gaze = sensor.gaze() == config::NO_GAZE     ? GazeOutput::none
             : sensor.gaze() == config::ONLY_GAZE ? GazeOutput::only
                                                  : GazeOutput::with_body;
    s.gaze_noise = within(sensor.gaze_noise(), "gaze_noise", 0, 1);
    s.gaze_dropout = within(sensor.gaze_dropout(), "gaze_dropout", 0, 1);
    s.min_rate = std::min(s.rate, within(sensor.min_rate(), "min_rate", 0, 1000));
    if (s.min_rate == 0) s.min_rate = std::min(s.rate, SensorSettings{}.min_rate);
    s.swap_rate = within(sensor.swap_rate(), "swap_rate", 0, s.rate);
    const bool only_people = !s.joints.empty() || s.joint_dropout > 0 ||
                             sensor.gaze() != config::GAZE_WITH_BODY || s.gaze_noise > 0 ||
                             s.gaze_dropout > 0 || s.swap_rate > 0;
    if (!of_people && only_people)
      fail("sensor " + s.source +
           " sees objects: joints, joint_dropout, gaze and swap_rate are for sensors of people");
    for (const auto& fault : sensor.faults()) {
      s.faults.push_back({static_cast<SensorFaultKind>(fault.kind()),
                          within(fault.at(), "at of a fault", 0, 1e6),
                          within(fault.length(), "length of a fault", 1e-3, 1e6),
                          vec(fault.shift()), within(fault.delay(), "delay of a fault", 0, 10)});
    }
    return s;
  }

  const config::Scenario& scenario_;
  const RobotModel& robot_;
  const ObjectLibrary& library_;
  std::filesystem::path data_root_;
  std::mt19937_64 random_;
  std::set<int> placed_;  // objects already placed at a free place
  SceneSetup out_;
};

}  // namespace

Pose pose_of(const config::PoseRpy& p) {
  Pose T = Pose::Identity();
  T.translation() = vec(p.xyz());
  T.linear() = (Eigen::AngleAxisd(p.rpy().z(), Vector3::UnitZ()) *
                Eigen::AngleAxisd(p.rpy().y(), Vector3::UnitY()) *
                Eigen::AngleAxisd(p.rpy().x(), Vector3::UnitX()))
                   .toRotationMatrix();
  return T;
}

SimAction sim_action(const std::string& name) {
  std::string all;
  for (std::size_t i = 0; i < std::size(kSimActionNames); ++i) {
    if (name == kSimActionNames[i]) return static_cast<SimAction>(i);
    all += std::string(i > 0 ? ", " : "") + kSimActionNames[i];
  }
  throw ConfigError("disturbance " + name + " is unknown; there are " + all);
}

SceneSetup set_up(const config::Scenario& scenario, const RobotModel& robot,
                  const ObjectLibrary& library, double coverage,
                  const std::filesystem::path& data_root, std::uint64_t seed) {
  return Reader(scenario, robot, library, data_root, seed).read(coverage);
}

}  // namespace handsel::sim
