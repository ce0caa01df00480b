#include "sim/sensors.hpp"

namespace handsel::sim {

namespace {

Vector3 noise(std::mt19937_64& random, std::normal_distribution<double>& normal, double sigma) {
  const double x = normal(random), y = normal(random), z = normal(random);
  return sigma * Vector3(x, y, z);
}

bool inside(const Coverage& c, const Vector3& p) { return (p.array() >= c.low.array()).all() && (p.array() <= c.high.array()).all(); }

template <class M>
void take_due(double now, std::deque<Delivery<M>>& pending, std::vector<Delivery<M>>& out) {
  while (!pending.empty() && pending.front().due <= now + 1e-9) {
    out.push_back(std::move(pending.front()));
    pending.pop_front();
  }
}

}  // namespace

HumanSensor::HumanSensor(const SensorSettings& settings, std::uint64_t seed) : settings_(settings), random_(seed) {}

void HumanSensor::observe(double now, const std::vector<const Person*>& people) {
  if (now + 1e-9 < next_) return;
  next_ += 1 / settings_.rate;
  HumanObservation seen;
  seen.source = settings_.source;
  seen.coverage = settings_.coverage;
  for (const Person* person : people) {
    ObservedPerson observed;
    observed.body = person->id;
    for (const BodyJoint& joint : person->joints) {
      if (!inside(settings_.coverage, joint.position)) continue;
      observed.joints.push_back({joint.name, joint.position + noise(random_, normal_, settings_.noise), 0.9});
    }
    if (observed.joints.empty()) continue;
    observed.has_gaze = person->gaze_known;
    observed.gaze_origin = person->gaze_origin + noise(random_, normal_, settings_.noise);
    observed.gaze_direction = (person->gaze_direction + noise(random_, normal_, 2 * settings_.noise)).normalized();
    seen.people.push_back(std::move(observed));
  }
  pending_.push_back({now, now + settings_.latency, std::move(seen)});
}

void HumanSensor::collect(double now, std::vector<Delivery<HumanObservation>>& out) { take_due(now, pending_, out); }

ObjectSensor::ObjectSensor(const SensorSettings& settings, std::uint64_t seed) : settings_(settings), random_(seed) {}

void ObjectSensor::observe(double now, const std::vector<TrueObject>& objects) {
  if (now + 1e-9 < next_) return;
  next_ += 1 / settings_.rate;
  ObjectObservation seen;
  seen.source = settings_.source;
  for (const TrueObject& object : objects) {
    if (!inside(settings_.coverage, object.T_world_object.translation())) continue;
    ObservedObject observed{object.id, object.model, object.T_world_object, 0.95};
    observed.T_world_object.translation() += noise(random_, normal_, settings_.noise);
    const Vector3 turn = noise(random_, normal_, 5 * settings_.noise);
    if (turn.norm() > 0) observed.T_world_object.linear() *= Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    seen.objects.push_back(std::move(observed));
  }
  pending_.push_back({now, now + settings_.latency, std::move(seen)});
}

void ObjectSensor::collect(double now, std::vector<Delivery<ObjectObservation>>& out) { take_due(now, pending_, out); }

}  // namespace handsel::sim
