// SPDX-License-Identifier: Apache-2.0
#include "sim/sensing/sensors.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/human/body_index.hpp"
#include "common/model/human/palm.hpp"

namespace handsel::sim {

namespace {

// Time for which a request holds [s].
constexpr double kRequestDuration = 0.5;

// Max distance of a joint outside the surface of a capsule to which it belongs [m].
constexpr double kMaxOutsideOwnBody = 0.02;

Vector3 noise(std::mt19937_64& random, std::normal_distribution<double>& normal, double sigma) {
  const double x = normal(random), y = normal(random), z = normal(random);
  return sigma * Vector3(x, y, z);
}

bool inside(const Coverage& c, const Vector3& p) {
  return (p.array() >= c.low.array()).all() && (p.array() <= c.high.array()).all();
}

/// Returns whether robot, boxes, people other than `own`, or other parts of `own` occlude the
/// point. The link that contains the eye of a sensor on the robot occludes nothing.
bool is_occluded(const Sight& sight, std::size_t own, const Vector3& eye, const Vector3& point) {
  for (const SightCapsule& link : sight.robot)
    if (!contains(link, eye) && hides(link, eye, point)) return true;
  for (const SightBox& box : sight.boxes)
    if (hides(box, eye, point)) return true;
  for (std::size_t p = 0; p < sight.bodies.size(); ++p) {
    for (const BodyCapsule& part : sight.bodies[p]) {
      if (p == own && contains({part.a, part.b, part.radius + kMaxOutsideOwnBody}, point)) continue;
      if (hides(SightCapsule{part.a, part.b, part.radius}, eye, point)) return true;
    }
  }
  return false;
}

}  // namespace

bool in_view(const SensorSettings& s, const Vector3& point) {
  if (!s.T_world_sensor) return true;
  const Vector3 p = s.T_world_sensor->inverse() * point;
  if (s.range > 0 && p.norm() > s.range) return false;
  if (s.fov_horizontal > 0 && std::abs(std::atan2(p.y(), p.x())) > s.fov_horizontal / 2)
    return false;
  return s.fov_vertical <= 0 ||
         std::abs(std::atan2(p.z(), std::hypot(p.x(), p.y()))) <= s.fov_vertical / 2;
}

void carried_to(SensorSettings& s, const Pose& T_world_sensor) {
  s.T_world_sensor = T_world_sensor;
  s.coverage.low = s.coverage.high = T_world_sensor.translation();
}

bool in_reach(const SensorSettings& s, const Vector3& point) {
  return !s.link.empty() || inside(s.coverage, point);
}

std::string coverage_error(const SensorSettings& s) {
  if (!s.link.empty()) return "";
  if (s.gaze == GazeOutput::only) return "";
  for (int corner = 0; corner < 8; ++corner) {
    Vector3 p = s.coverage.low;
    for (int i = 0; i < 3; ++i)
      if (corner >> i & 1) p[i] = s.coverage.high[i];
    if (in_view(s, p)) continue;
    char text[96];
    std::snprintf(text, sizeof text,
                  "its coverage has a corner (%.2f, %.2f, %.2f) outside its field of view or range",
                  p.x(), p.y(), p.z());
    return text;
  }
  return "";
}

void SampleClock::request(double rate, double now) {
  requested_ = rate;
  requested_at_ = now;
}

bool SampleClock::due(double now) {
  const bool is_requested =
      requested_ > 0 && requested_at_ >= 0 && now - requested_at_ <= kRequestDuration;
  const double rate = is_requested ? std::clamp(requested_, min_rate_, rate_) : rate_;
  if (rate != now_) {
    next_ = std::max(now, next_ + 1 / rate - 1 / now_);
    now_ = rate;
  }
  if (now + 1e-9 < next_) return false;
  next_ += 1 / rate;
  return true;
}

template <class M>
bool SampleStream<M>::lost(double now) {
  if (settings_.burst_rate > 0 && now >= burst_until_ &&
      happens(std::min(1.0, settings_.burst_rate / clock_.rate())))
    burst_until_ = now - settings_.burst_length * std::log(1 - uniform());
  const bool is_dropped = happens(settings_.dropout);
  return is_dropped || now < burst_until_ || fault(now, SensorFaultKind::gap) != nullptr;
}

template <class M>
void SampleStream<M>::send(double now, M message) {
  Delivery<M> sample{now, now + settings_.latency, std::move(message)};
  if (settings_.jitter > 0) sample.due += settings_.jitter * (2 * uniform() - 1);
  if (const SensorFault* late = fault(now, SensorFaultKind::late)) sample.due += late->delay;
  sample.due = last_due_ = std::max({sample.due, now, last_due_});
  if (fault(now, SensorFaultKind::repeated_empty) == nullptr) {
    empty_.reset();
  } else if (!empty_) {
    empty_ = sample;
  }
  if (empty_) {
    sample.seen = empty_->seen;
    sample.message = empty_->message;
  } else if (last_ && fault(now, SensorFaultKind::repeated) != nullptr) {
    sample.seen = last_->seen;
    sample.message = last_->message;
  } else if (last_ && fault(now, SensorFaultKind::frozen) != nullptr) {
    sample.message = last_->message;
  } else if (!settings_.faults.empty() || !disturbances_.empty()) {
    last_ = sample;
  }
  pending_.push_back(std::move(sample));
}

template <class M>
void SampleStream<M>::collect(double now, std::vector<Delivery<M>>& out) {
  while (!pending_.empty() && pending_.front().due <= now + 1e-9) {
    out.push_back(std::move(pending_.front()));
    pending_.pop_front();
  }
}

template <class M>
const SensorFault* SampleStream<M>::fault(double now, SensorFaultKind kind) const {
  for (const std::vector<SensorFault>* faults : {&settings_.faults, &disturbances_})
    for (const SensorFault& f : *faults)
      if (f.kind == kind && now + 1e-9 >= f.at && now + 1e-9 < f.at + f.length) return &f;
  return nullptr;
}

template <class M>
void SampleStream<M>::disturb(const SensorFault& fault) {
  std::erase_if(disturbances_, [&](const SensorFault& f) {
    return f.kind == fault.kind || f.at + f.length <= fault.at;
  });
  disturbances_.push_back(fault);
}

template <class M>
void SampleStream<M>::restore() {
  disturbances_.clear();
  if (settings_.faults.empty()) last_.reset();
}

template class SampleStream<HumanObservation>;
template class SampleStream<ObjectObservation>;

HumanSensor::HumanSensor(const SensorSettings& settings, std::uint64_t seed)
    : settings_(settings),
      random_(seed),
      knuckle_random_(seed ^ 0x6a09'e667ULL),
      stream_(settings, seed) {}

void HumanSensor::request(double now, const SensorRequest& request) {
  if (!request.source.empty() && request.source != settings_.source) return;
  stream_.clock().request(request.people_rate, now);
  without_knuckles_until_ = request.hands ? -1 : now + kRequestDuration;
}

bool HumanSensor::is_tracked(const std::string& joint) const {
  const auto& tracked = settings_.joints;
  return tracked.empty() || std::find(tracked.begin(), tracked.end(), joint) != tracked.end();
}

bool HumanSensor::sees(const Sight& sight, std::size_t person, const Vector3& point) const {
  if (settings_.gaze != GazeOutput::only && !in_reach(settings_, point)) return false;
  if (!in_view(settings_, point)) return false;
  return !settings_.occlusion ||
         !is_occluded(sight, person, settings_.T_world_sensor->translation(), point);
}

const std::string& HumanSensor::shown_id(const std::string& id) {
  const auto other = shown_.find(id);
  return other == shown_.end() ? id : other->second;
}

void HumanSensor::swap_ids(const Sight& sight) {
  if (sight.people.empty()) return;
  const std::size_t n = sight.people.size();
  const auto first = static_cast<std::size_t>(stream_.uniform() * static_cast<double>(n)) % n;
  const std::string& id = sight.people[first]->id;
  if (n == 1) {
    shown_[id] = "body" + std::to_string(++renamed_);
    return;
  }
  const auto step =
      1 + static_cast<std::size_t>(stream_.uniform() * static_cast<double>(n - 1)) % (n - 1);
  const std::string& other = sight.people[(first + step) % n]->id;
  const std::string a = shown_id(id), b = shown_id(other);
  shown_[id] = b;
  shown_[other] = a;
}

void HumanSensor::add_knuckles(const Sight& sight, std::size_t person, const Vector3& shift,
                               ObservedPerson& observed) {
  constexpr double kHalfWidth = 0.03;  // of a hand at its knuckles [m]
  const Person& truth = *sight.people[person];
  for (const Side side : {Side::left, Side::right}) {
    const auto normal = palm_of(truth, side);
    if (!normal || truth.joints.size() != kBodyJoints.size()) continue;
    const Knuckles& names = kKnuckles[side == Side::left ? 0 : 1];
    const Vector3& p_hand = truth.joints[side == Side::left ? body::l_hand : body::r_hand].position;
    const Vector3& p_wrist =
        truth.joints[side == Side::left ? body::l_wrist : body::r_wrist].position;
    const Vector3 across =
        kHalfWidth * across_palm(side, (p_hand - p_wrist).stableNormalized(), *normal);
    for (const auto& [name, p] : {std::pair(names.index, Vector3(p_hand + across)),
                                  std::pair(names.pinky, Vector3(p_hand - across))}) {
      const Vector3 error = noise(knuckle_random_, knuckle_normal_, settings_.noise);
      if (is_tracked(name) && sees(sight, person, p) && !stream_.happens(settings_.joint_dropout))
        observed.joints.push_back({name, p + shift + error, 0.9});
    }
  }
}

void HumanSensor::observe(double now, const Sight& sight) {
  const bool lost = stream_.lost(now);
  if (stream_.happens(settings_.swap_rate / stream_.clock().rate())) swap_ids(sight);
  HumanObservation seen;
  seen.source = settings_.source;
  if (settings_.gaze != GazeOutput::only) seen.coverage = settings_.coverage;
  const SensorFault* elsewhere = stream_.fault(now, SensorFaultKind::elsewhere);
  if (elsewhere != nullptr) {
    seen.coverage.low += elsewhere->shift;
    seen.coverage.high += elsewhere->shift;
  }
  const bool sees_nobody = elsewhere != nullptr ||
                           stream_.fault(now, SensorFaultKind::blind) != nullptr ||
                           stream_.fault(now, SensorFaultKind::repeated_empty) != nullptr;
  const SensorFault* teleport = stream_.fault(now, SensorFaultKind::teleport);
  const Vector3 shift = teleport != nullptr ? teleport->shift : Vector3(Vector3::Zero());
  for (std::size_t p = 0; p < sight.people.size() && !sees_nobody; ++p) {
    const Person& person = *sight.people[p];
    ObservedPerson observed;
    observed.body = shown_id(person.id);
    for (const BodyJoint& joint : person.joints) {
      if (settings_.gaze == GazeOutput::only || !sees(sight, p, joint.position)) continue;
      if (!is_tracked(joint.name)) continue;
      if (stream_.happens(settings_.joint_dropout)) continue;
      observed.joints.push_back(
          {joint.name, joint.position + shift + noise(random_, normal_, settings_.noise), 0.9});
    }
    if (settings_.gaze != GazeOutput::only && now > without_knuckles_until_)
      add_knuckles(sight, p, shift, observed);
    observed.has_gaze = person.gaze_known && settings_.gaze != GazeOutput::none &&
                        !stream_.happens(settings_.gaze_dropout);
    if (observed.has_gaze && settings_.gaze == GazeOutput::only)
      observed.has_gaze = sees(sight, p, person.gaze_origin);
    if (observed.has_gaze && settings_.occlusion) {
      const Vector3 to_eye = settings_.T_world_sensor->translation() - person.gaze_origin;
      observed.has_gaze =
          person.gaze_direction.dot(to_eye) > 0 && sees(sight, p, person.gaze_origin);
    }
    if (observed.joints.empty() && !(observed.has_gaze && settings_.gaze == GazeOutput::only))
      continue;
    observed.gaze_origin = person.gaze_origin + shift + noise(random_, normal_, settings_.noise);
    const double gaze_noise = settings_.gaze_noise > 0 ? settings_.gaze_noise : 2 * settings_.noise;
    observed.gaze_direction =
        (person.gaze_direction + noise(random_, normal_, gaze_noise)).normalized();
    seen.people.push_back(std::move(observed));
  }
  if (stream_.fault(now, SensorFaultKind::swap) != nullptr && !seen.people.empty()) {
    if (seen.people.size() == 1)
      seen.people[0].body += "-other";
    else
      std::swap(seen.people[0].body, seen.people[1].body);
  }
  if (!lost) stream_.send(now, std::move(seen));
}

ObjectSensor::ObjectSensor(const SensorSettings& settings, std::uint64_t seed)
    : settings_(settings),
      random_(seed),
      stream_(settings, seed),
      region_clock_(settings.rate, settings.min_rate) {}

void ObjectSensor::request(double now, const SensorRequest& request) {
  if (!request.source.empty() && request.source != settings_.source) return;
  stream_.clock().request(request.objects_rate, now);
  region_clock_.request(request.region_rate, now);
  region_until_ = request.region_rate > 0 ? now + kRequestDuration : -1;
  request_ = request;
}

bool ObjectSensor::due(double now) {
  observes_all_ = stream_.clock().due(now);
  const bool is_region_due = region_clock_.due(now);
  return observes_all_ || (is_region_due && now <= region_until_);
}

bool ObjectSensor::is_requested(const TrueObject& object) const {
  const auto& ids = request_.objects;
  return std::find(ids.begin(), ids.end(), object.id) != ids.end() ||
         (request_.region.low != request_.region.high &&
          inside(request_.region, object.T_world_object.translation()));
}

void ObjectSensor::observe(double now, const Sight& sight) {
  const bool lost = stream_.lost(now);
  ObjectObservation seen;
  seen.source = settings_.source;
  const SensorFault* teleport = stream_.fault(now, SensorFaultKind::teleport);
  const bool blind = stream_.fault(now, SensorFaultKind::blind) != nullptr;
  for (const TrueObject& object : sight.objects) {
    const Vector3 p_world = object.T_world_object.translation();
    if (!observes_all_ && !is_requested(object)) continue;
    if (blind || !in_reach(settings_, p_world) || !in_view(settings_, p_world)) continue;
    if (settings_.occlusion &&
        is_occluded(sight, sight.people.size(), settings_.T_world_sensor->translation(), p_world))
      continue;
    ObservedObject observed{object.id, object.model, object.T_world_object, 0.95};
    observed.T_world_object.translation() += noise(random_, normal_, settings_.noise);
    if (teleport != nullptr) observed.T_world_object.translation() += teleport->shift;
    const Vector3 turn = noise(random_, normal_, 5 * settings_.noise);
    if (turn.norm() > 0)
      observed.T_world_object.linear() *=
          Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    seen.objects.push_back(std::move(observed));
  }
  if (!lost) stream_.send(now, std::move(seen));
}

}  // namespace handsel::sim
