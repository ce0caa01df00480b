// SPDX-License-Identifier: Apache-2.0
// Emulates perception: sources of people and objects, each with rate, latency, jitter, noise,
// drop-outs, field of view and faults. Pure, seeded. Random numbers of a disabled effect are not
// drawn, so disabled effects do not change a source by a bit.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "common/geometry/line_of_sight.hpp"
#include "common/messages/attention.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/world.hpp"
#include "common/model/human/human_body.hpp"

namespace handsel::sim {

/// Kinds of faults. repeated_empty: the sensor repeats one sample without people; elsewhere: the
/// sensor observes an empty place displaced by `shift`.
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
  SensorFaultKind kind{};          ///< kind of the fault
  double at{}, length{};           ///< begin and duration [s]
  Vector3 shift{Vector3::Zero()};  ///< teleport, elsewhere: world [m]
  double delay{};                  ///< late: additional latency [s]
};

enum class GazeOutput { with_body, none, only };

/// Fields as in SensorDescription of common/config/schema/scenario.proto.
struct SensorSettings {
  std::string source;                    ///< name in the observations; not empty
  double rate{30};                       ///< sample rate without a request [Hz]
  double min_rate{10};                   ///< min sample rate by request, at most `rate` [Hz]
  double latency{0.03};                  ///< from capture to delivery [s]
  double noise{0.0};                     ///< standard deviation of each coordinate [m]
  Coverage coverage;                     ///< box that the sensor claims to observe, world [m]
  double jitter{};                       ///< max deviation of the delivery time [s]
  double dropout{}, joint_dropout{};     ///< fractions of lost samples and of lost joints
  double burst_rate{}, burst_length{};   ///< bursts of losses: mean rate [1/s], mean length [s]
  std::optional<Pose> T_world_sensor;    ///< x forward; nullopt: no field of view
  std::string link;                      ///< robot link that carries the sensor; empty: it is fixed
  Pose T_link_sensor{Pose::Identity()};  ///< pose on that link
  double fov_horizontal{}, fov_vertical{};  ///< full angles [rad], 0: unlimited
  double range{};                           ///< max distance [m], 0: unlimited
  bool occlusion{};                         ///< whether robot, boxes and bodies occlude points
  std::vector<std::string> joints;          ///< tracked joints; empty: all
  GazeOutput gaze{GazeOutput::with_body};   ///< which of body and gaze is observed
  double gaze_noise{};                      ///< standard deviation [rad]; 0: follows `noise`
  double gaze_dropout{};                    ///< fraction of the gazes that are lost
  double swap_rate{};                       ///< rate at which two people's ids are swapped [1/s]
  std::vector<SensorFault> faults;          ///< faults of the scenario
};

/// Returns whether the point is within range and field of view.
bool in_view(const SensorSettings&, const Vector3& point);

/// Moves the sensor. The coverage becomes the sensor's position, so the sensor claims no coverage.
void carried_to(SensorSettings&, const Pose& T_world_sensor);
/// Returns whether the sensor can observe a point: a fixed sensor observes its coverage, a sensor
/// on the robot everything in view.
bool in_reach(const SensorSettings&, const Vector3& point);

/// Returns an empty text, or one sentence that names a corner of the coverage outside the sensor's
/// view.
std::string coverage_error(const SensorSettings&);

/// A message with the instants of capture and delivery [s of simulated time].
template <class M>
struct Delivery {
  double seen{}, due{};  ///< instant of capture, instant of delivery [s]
  M message;             ///< without a stamp
};

/// The ground truth of an object.
struct TrueObject {
  std::string id, model;                  ///< unique in the scene; name in the object library
  Pose T_world_object{Pose::Identity()};  ///< without noise
};

/// The ground truth of everything that sensors observe.
struct Sight {
  std::vector<const Person*> people;             ///< ground truth; no null
  std::vector<std::vector<BodyCapsule>> bodies;  ///< capsules of `people`, for occlusion
  std::vector<TrueObject> objects;               ///< all objects of the scene
  std::vector<SightCapsule> robot;               ///< robot links, for occlusion; may be empty
  std::vector<SightBox> boxes;                   ///< furniture, for occlusion; may be empty
};

/// Times at which a sensor samples: at its own rate, or as requested while requests are received.
class SampleClock {
 public:
  /// Rates [Hz]: without a request, and min by request; min_rate <= rate.
  SampleClock(double rate, double min_rate) : rate_(rate), min_rate_(min_rate), now_(rate) {}

  /// Sets the requested rate [Hz]; 0: the own rate. The request expires after 0.5 s. Times in [s].
  void request(double rate, double now);
  /// Returns true once per period.
  bool due(double now);
  /// Returns the rate in force at the last call of due() [Hz].
  double rate() const { return now_; }

 private:
  double rate_, min_rate_, now_;
  double requested_{0}, requested_at_{-1}, next_{0};
};

/// Times of samples, losses and deliveries, common to all kinds of sensors.
template <class M>
class SampleStream {
 public:
  SampleStream(const SensorSettings& settings, std::uint64_t seed)
      : settings_(settings),
        clock_(settings.rate, settings.min_rate),
        chance_(seed ^ 0xd1ce'5eedULL) {}

  SampleClock& clock() { return clock_; }  ///< Returns the times of the samples.
  /// Returns whether the sample of this instant is lost.
  bool lost(double now);
  /// Queues the sample of the instant `now` [s] with latency, jitter and the faults of that
  /// instant. Samples are delivered in the order of capture.
  void send(double now, M message);
  /// Moves the samples due by `now` [s] to the end of `out`.
  void collect(double now, std::vector<Delivery<M>>& out);
  /// Returns a fault of this kind that is active at `now` [s], first from the settings; nullptr:
  /// none.
  const SensorFault* fault(double now, SensorFaultKind kind) const;
  /// Adds a fault to the faults of the settings; replaces a disturbance of the same kind.
  void disturb(const SensorFault& fault);
  /// Ends all disturbances.
  void restore();
  /// Returns true with this probability; draws only if the probability is above 0.
  bool happens(double probability) { return probability > 0 && uniform_(chance_) < probability; }
  double uniform() { return uniform_(chance_); }  ///< Draws a number from [0, 1).

 private:
  SensorSettings settings_;
  SampleClock clock_;
  std::mt19937_64 chance_;
  std::uniform_real_distribution<double> uniform_{0, 1};
  double burst_until_{-1}, last_due_{0};
  std::optional<Delivery<M>> last_, empty_;  // last sample sent; sample of repeated_empty
  std::deque<Delivery<M>> pending_;
  std::vector<SensorFault> disturbances_;
};

class HumanSensor {
 public:
  HumanSensor(const SensorSettings&, std::uint64_t seed);
  bool due(double now) { return stream_.clock().due(now); }  ///< Returns true once per period.
  /// Samples people, and knuckles, as requested; ignores requests to other sources.
  void request(double now, const SensorRequest&);
  /// Moves a sensor on the robot.
  void carry_to(const Pose& T_world_sensor) { carried_to(settings_, T_world_sensor); }
  /// Adds a fault to the faults of the settings; replaces a disturbance of the same kind.
  void disturb(const SensorFault& fault) { stream_.disturb(fault); }
  /// Ends all disturbances.
  void restore() { stream_.restore(); }
  /// Takes a sample of people; to be called when due.
  void observe(double now, const Sight&);
  /// Moves the samples due by `now` [s] to the end of `out`.
  void collect(double now, std::vector<Delivery<HumanObservation>>& out) {
    stream_.collect(now, out);
  }
  const SensorSettings& settings() const { return settings_; }  ///< with the present pose

 private:
  bool sees(const Sight&, std::size_t person, const Vector3& point) const;
  bool is_tracked(const std::string& joint) const;
  /// Adds the knuckles of the hands whose palm direction is known.
  void add_knuckles(const Sight&, std::size_t person, const Vector3& shift, ObservedPerson&);
  void swap_ids(const Sight&);
  const std::string& shown_id(const std::string& id);

  SensorSettings settings_;
  std::mt19937_64 random_, knuckle_random_;
  std::normal_distribution<double> normal_{0, 1}, knuckle_normal_{0, 1};
  SampleStream<HumanObservation> stream_;
  std::map<std::string, std::string> shown_;  // true id -> tracker's id, where these differ
  int renamed_{0};
  double without_knuckles_until_{-1};  // [s]
};

class ObjectSensor {
 public:
  ObjectSensor(const SensorSettings&, std::uint64_t seed);
  /// Returns true once per period of all objects, and of the requested region.
  bool due(double now);
  /// Samples all objects, and those of a region, as requested; ignores requests to other sources.
  void request(double now, const SensorRequest&);
  /// Moves a sensor on the robot.
  void carry_to(const Pose& T_world_sensor) { carried_to(settings_, T_world_sensor); }
  /// Takes a sample of objects, observed by their origins; to be called when due. Between the
  /// samples of all objects only the requested ones are observed.
  void observe(double now, const Sight&);
  /// Moves the samples due by `now` [s] to the end of `out`.
  void collect(double now, std::vector<Delivery<ObjectObservation>>& out) {
    stream_.collect(now, out);
  }
  const SensorSettings& settings() const { return settings_; }  ///< with the present pose

 private:
  /// Returns whether the request names the object or its region contains the object.
  bool is_requested(const TrueObject&) const;

  SensorSettings settings_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0, 1};
  SampleStream<ObjectObservation> stream_;
  SampleClock region_clock_;
  SensorRequest request_;    // the last one
  double region_until_{-1};  // end of its region's samples [s]
  bool observes_all_{true};  // the due sample is of all objects
};

}  // namespace handsel::sim
