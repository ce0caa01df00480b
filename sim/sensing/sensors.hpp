// Emulated perception: several sources of people and objects, each with its own rate, latency,
// jitter, noise, drop-outs, view and faults. Pure, seeded. Chance that is switched off is not
// drawn, so a source without it is the same bit for bit.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "common/geometry/line_of_sight.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::sim {

/// repeated_empty: the same picture, with nobody in it, again and again; elsewhere: the sensor
/// observes another place, `shift` away, where nobody is.
enum class SensorFaultKind {
  gap,
  frozen,
  repeated,
  teleport,
  swap,
  late,
  blind,
  repeated_empty,
  elsewhere
};

struct SensorFault {
  SensorFaultKind kind{};          ///< what goes wrong
  double at{}, length{};           ///< begin and duration [s]
  Vector3 shift{Vector3::Zero()};  ///< teleport, elsewhere: world [m]
  double delay{};                  ///< late [s]
};

enum class GazeOutput { with_body, none, only };

/// Fields as in SensorDescription of common/config/schema/scenario.proto.
struct SensorSettings {
  std::string source;                    ///< name in the observations; not empty
  double rate{30};                       ///< [Hz]
  double latency{0.03};                  ///< from the instant seen to delivery [s]
  double noise{0.0};                     ///< standard deviation of each coordinate [m]
  Coverage coverage;                     ///< box that the sensor claims to observe, world [m]
  double jitter{};                       ///< of the delivery, to either side [s]
  double dropout{}, joint_dropout{};     ///< fractions of samples and of joints that are lost
  double burst_rate{}, burst_length{};   ///< of losses: mean rate [1/s], mean length [s]
  std::optional<Pose> T_world_sensor;    ///< x forward; without it no field of view
  std::string link;                      ///< robot link that carries the sensor; empty: it is fixed
  Pose T_link_sensor{Pose::Identity()};  ///< pose on that link
  double fov_horizontal{}, fov_vertical{};  ///< full angles [rad], 0: unlimited
  double range{};                           ///< [m], 0: unlimited
  bool occlusion{};                         ///< robot, boxes and bodies hide points
  std::vector<std::string> joints;          ///< tracked; empty: all
  GazeOutput gaze{GazeOutput::with_body};   ///< whether the direction of gaze is observed too
  double gaze_noise{};                      ///< standard deviation [rad]; 0: follows `noise`
  double gaze_dropout{};                    ///< fraction of the gazes that are lost
  double swap_rate{};                       ///< rate at which two people's ids are swapped [1/s]
  std::vector<SensorFault> faults;          ///< of the scenario
};

/// Whether the point is inside range and field of view.
bool in_view(const SensorSettings&, const Vector3& point);

/// Moves the sensor. Its coverage becomes the point where the sensor is: it claims to observe
/// nothing.
void carried_to(SensorSettings&, const Pose& T_world_sensor);
/// Whether a point can be observed at all: a fixed sensor observes its coverage, one that the robot
/// carries everything in view.
bool in_reach(const SensorSettings&, const Vector3& point);

/// Returns an empty text, or one sentence: which corner of the coverage lies outside the sensor's
/// view.
std::string claims_too_much(const SensorSettings&);

/// A message with the instant it shows and the instant it is handed over [s of simulated time].
template <class M>
struct Delivery {
  double seen{}, due{};  ///< instant shown, instant of delivery [s]
  M message;             ///< without a stamp
};

/// An object as it truly is.
struct TrueObject {
  std::string id, model;                  ///< unique in the scene; name in the object library
  Pose T_world_object{Pose::Identity()};  ///< without noise
};

/// All there is to see.
struct Sight {
  std::vector<const Person*> people;             ///< ground truth; no null
  std::vector<std::vector<BodyCapsule>> bodies;  ///< of `people`, for occlusion
  std::vector<TrueObject> objects;               ///< all of the scene
  std::vector<SightCapsule> robot;               ///< its links, for occlusion; may be empty
  std::vector<SightBox> boxes;                   ///< furniture, for occlusion; may be empty
};

/// When samples are made, lost and handed over; shared by all kinds of sensors.
template <class M>
class SampleStream {
 public:
  SampleStream(const SensorSettings& settings, std::uint64_t seed)
      : settings_(settings), chance_(seed ^ 0xd1ce'5eedULL) {}

  /// Returns true once a period of the sensor.
  bool due(double now);
  /// Whether the sample of this instant is lost.
  bool lost(double now);
  /// Queues the sample of the instant `now` [s] with its latency and jitter, changed as the faults
  /// of that instant say. Samples are delivered in the order of their instants.
  void send(double now, M message);
  /// Moves what is due by `now` [s] to the end of `out`.
  void collect(double now, std::vector<Delivery<M>>& out);
  /// Returns a fault of this kind that is active at `now` [s], of the settings first; nullptr:
  /// none.
  const SensorFault* fault(double now, SensorFaultKind kind) const;
  /// Adds a fault to those of the settings; it replaces a disturbance of the same kind.
  void disturb(const SensorFault& fault);
  /// Ends all disturbances.
  void restore();
  /// True with this probability; draws only when it is above 0.
  bool happens(double probability) { return probability > 0 && uniform_(chance_) < probability; }
  double uniform() { return uniform_(chance_); }  ///< Draws from [0, 1).

 private:
  SensorSettings settings_;
  std::mt19937_64 chance_;
  std::uniform_real_distribution<double> uniform_{0, 1};
  double next_{0}, burst_until_{-1}, last_due_{0};
  std::optional<Delivery<M>> last_, empty_;  // sent last; the picture of repeated_empty
  std::deque<Delivery<M>> pending_;
  std::vector<SensorFault> disturbances_;
};

class HumanSensor {
 public:
  HumanSensor(const SensorSettings&, std::uint64_t seed);
  bool due(double now) { return stream_.due(now); }  ///< True once a period.
  /// Moves a sensor that the robot carries.
  void carry_to(const Pose& T_world_sensor) { carried_to(settings_, T_world_sensor); }
  /// Adds a fault to those of the settings; it replaces a disturbance of the same kind.
  void disturb(const SensorFault& fault) { stream_.disturb(fault); }
  /// Ends all disturbances.
  void restore() { stream_.restore(); }
  /// Takes a sample of people; to be called when due.
  void observe(double now, const Sight&);
  /// Moves what is due by `now` to `out`.
  void collect(double now, std::vector<Delivery<HumanObservation>>& out) {
    stream_.collect(now, out);
  }
  const SensorSettings& settings() const { return settings_; }  ///< with the pose of now

 private:
  bool sees(const Sight&, std::size_t person, const Vector3& point) const;
  void swap_ids(const Sight&);
  const std::string& shown_id(const std::string& id);

  SensorSettings settings_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0, 1};
  SampleStream<HumanObservation> stream_;
  std::map<std::string, std::string> shown_;  // true id -> the tracker's, where it differs
  int renamed_{0};
};

class ObjectSensor {
 public:
  ObjectSensor(const SensorSettings&, std::uint64_t seed);
  bool due(double now) { return stream_.due(now); }  ///< True once a period.
  /// Moves a sensor that the robot carries.
  void carry_to(const Pose& T_world_sensor) { carried_to(settings_, T_world_sensor); }
  /// Takes a sample of objects by their origins; to be called when due.
  void observe(double now, const Sight&);
  /// Moves what is due by `now` to `out`.
  void collect(double now, std::vector<Delivery<ObjectObservation>>& out) {
    stream_.collect(now, out);
  }
  const SensorSettings& settings() const { return settings_; }  ///< with the pose of now

 private:
  SensorSettings settings_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0, 1};
  SampleStream<ObjectObservation> stream_;
};

}  // namespace handsel::sim
