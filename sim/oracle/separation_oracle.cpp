// SPDX-License-Identifier: Apache-2.0
#include "sim/oracle/separation_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace handsel::sim {

namespace {

struct Corners {
  std::vector<Vector3>& out;
  const Pose& T;
  void box(const Vector3& h) const {
    for (int i = 0; i < 8; ++i)
      out.push_back(T * Vector3((i & 1) ? h.x() : -h.x(), (i & 2) ? h.y() : -h.y(),
                                (i & 4) ? h.z() : -h.z()));
  }
  void operator()(const Sphere& s) const { box(Vector3::Constant(s.radius)); }
  void operator()(const Box& b) const { box(b.size / 2); }
  void operator()(const Cylinder& c) const { box({c.radius, c.radius, c.length / 2}); }
  void operator()(const Capsule& c) const { box({c.radius, c.radius, c.length / 2 + c.radius}); }
  void operator()(const MeshPtr& m) const {
    for (const Vector3& v : m->vertices) out.push_back(T * v);
  }
};

double closest(const Vector3& p0, const Vector3& p1, const Vector3& q0, const Vector3& q1,
               double& s, double& t) {
  const Vector3 u = p1 - p0, v = q1 - q0, w = p0 - q0;
  const double a = u.squaredNorm(), b = u.dot(v), c = v.squaredNorm(), d = u.dot(w), e = v.dot(w);
  const double det = a * c - b * b;
  s = det > 1e-12 * a * c && det > 0 ? std::clamp((b * e - c * d) / det, 0.0, 1.0) : 0.0;
  t = c > 1e-15 ? std::clamp((b * s + e) / c, 0.0, 1.0) : 0.0;
  s = a > 1e-15 ? std::clamp((b * t - d) / a, 0.0, 1.0) : 0.0;
  return (w + s * u - t * v).norm();
}

bool is_exempt_part(const PersonVolume& volume, BodyPart part) {
  if (!volume.exception) return false;
  const bool left = part == BodyPart::forearm_left || part == BodyPart::hand_left;
  const bool right = part == BodyPart::forearm_right || part == BodyPart::hand_right;
  return (left && (volume.both_sides || volume.side == Side::left)) ||
         (right && (volume.both_sides || volume.side == Side::right));
}

Vector3 velocity_near(const Person& person, const Vector3& point) {
  const BodyJoint* nearest = nullptr;
  double min_squared = std::numeric_limits<double>::infinity();
  for (const BodyJoint& joint : person.joints) {
    const double d = (joint.position - point).squaredNorm();
    if (d < min_squared) min_squared = d, nearest = &joint;
  }
  return nearest != nullptr ? nearest->velocity : Vector3(Vector3::Zero());
}

}  // namespace

void PeakSpeed::add(double speed) noexcept {
  last_[count_++ % last_.size()] = speed;
  if (count_ < last_.size()) return;
  std::array<double, 5> sorted = last_;
  std::nth_element(sorted.begin(), sorted.begin() + 2, sorted.end());
  peak_ = std::max(peak_, sorted[2]);
}

SeparationOracle::SeparationOracle(const RobotModel& model, const SsmSettings& settings)
    : settings_(settings), stop_(model.stop_limits()) {
  for (int l = 0; l < static_cast<int>(model.links().size()); ++l) {
    for (const PlacedShape& part : model.links()[l].collision) {
      std::vector<Vector3> points;
      std::visit(Corners{points, part.T_parent_shape}, part.shape);
      if (points.empty()) continue;
      Vector3 mean = Vector3::Zero();
      for (const Vector3& p : points) mean += p;
      mean /= static_cast<double>(points.size());
      Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
      for (const Vector3& p : points) spread += (p - mean) * (p - mean).transpose();
      const Vector3 axis =
          Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
      LinkVolume volume;
      volume.link = l;
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const Vector3& p : points) {
        const double along = axis.dot(p - mean);
        low = std::min(low, along), high = std::max(high, along);
        volume.radius = std::max(volume.radius, (p - mean - along * axis).norm());
      }
      const double middle = (low + high) / 2,
                   half = std::max(0.0, (high - low) / 2 - volume.radius * 0.5);
      volume.a = mean + (middle - half) * axis;
      volume.b = mean + (middle + half) * axis;
      for (const Vector3& p : points) {
        const double along = std::clamp(axis.dot(p - mean), middle - half, middle + half);
        volume.radius = std::max(volume.radius, (p - mean - along * axis).norm());
      }
      volume.bound = half + volume.radius;
      volumes_.push_back(volume);
    }
  }
}

TrueSeparation SeparationOracle::separation(const RobotBody& robot,
                                            const std::vector<PersonVolume>& people) const {
  TrueSeparation best;
  best.distance = std::numeric_limits<double>::infinity();
  for (const PersonVolume& volume : people) {
    const std::vector<BodyCapsule> body = body_capsules(*volume.person);
    // Skips parts whose bounding sphere is farther away than the best distance so far.
    std::vector<std::pair<Vector3, double>> spheres;
    spheres.reserve(body.size());
    for (const BodyCapsule& part : body)
      spheres.emplace_back((part.a + part.b) / 2, (part.b - part.a).norm() / 2 + part.radius);
    for (const LinkVolume& link : volumes_) {
      const Pose& T = robot.T_world_link(link.link);
      const Vector3 a = T * link.a, b = T * link.b, middle = (a + b) / 2;
      for (std::size_t i = 0; i < body.size(); ++i) {
        const BodyCapsule& part = body[i];
        if (is_exempt_part(volume, part.part)) continue;
        const double max_centre_distance = best.distance + link.bound + spheres[i].second;
        if (max_centre_distance < 0 ||
            (middle - spheres[i].first).squaredNorm() >= max_centre_distance * max_centre_distance)
          continue;
        double s = 0, t = 0;
        const double d = closest(a, b, part.a, part.b, s, t) - link.radius - part.radius;
        if (d >= best.distance) continue;
        best.distance = d;
        best.link = link.link;
        const Vector3 on_axis = a + s * (b - a), on_person = part.a + t * (part.b - part.a);
        const Vector3 n = (on_person - on_axis).stableNormalized();
        best.on_robot = on_axis + link.radius * n;
        best.on_person = on_person - part.radius * n;
        best.person_velocity = velocity_near(*volume.person, best.on_person);
      }
    }
  }
  return best;
}

void SeparationOracle::stop_measure(double v, double a, double A, double J, double& time,
                                    double& distance) {
  time = distance = 0;
  const auto advance = [&](double duration, double jerk) {
    distance += duration * (v + duration * (a / 2 + duration * jerk / 6));
    v += duration * (a + duration * jerk / 2);
    a += duration * jerk;
    time += duration;
  };
  if (std::abs(a) > A) advance((std::abs(a) - A) / J, a > 0 ? -J : J);
  const double v_left =
      v + a * std::abs(a) / (2 * J);        // speed once the acceleration has been reduced to 0
  const double sign = v_left > 0 ? -1 : 1;  // direction of the braking lobe
  // In mirrored coordinates (braking upward): from a to a1, hold, back to zero, gaining -v.
  const double a_m = sign * a, need = -sign * v;
  const double peak = std::sqrt(std::max(0.0, J * need + a_m * a_m / 2));
  const double a1 = std::min(peak, A);
  if (a1 > a_m) advance((a1 - a_m) / J, sign * J);
  const double gained = (2 * a1 * a1 - a_m * a_m) / (2 * J);
  const double hold = a1 > 0 ? (need - gained) / a1 : 0;
  if (peak > A && hold > 0) advance(hold, 0);
  if (std::abs(a) > 0) advance(std::abs(a) / J, a > 0 ? -J : J);
}

bool SeparationOracle::violates(const TrueSeparation& near, const RobotBody& robot,
                                const Vector& velocity, const Vector& acceleration) {
  if (!std::isfinite(near.distance) || near.link < 0) return false;
  const Vector3 n =
      (near.on_person - near.on_robot).stableNormalized() * (near.distance < 0 ? -1.0 : 1.0);
  const int body = robot.body_of(near.link);
  const double toward = robot.point_velocity(body, near.on_robot).dot(n);
  if (toward < settings_.moving) return false;
  robot.directed_jacobian(body, near.on_robot, n, jacobian_);
  double stop_time = 0, stop_distance = 0;
  for (Eigen::Index i = 0; i < velocity.size(); ++i) {
    if (jacobian_[i] == 0) continue;
    double time = 0, distance = 0;
    stop_measure(velocity[i], acceleration[i], stop_.acceleration[i], stop_.jerk[i], time,
                 distance);
    stop_time = std::max(stop_time, time);
    stop_distance += jacobian_[i] * distance;
  }
  const double human = std::clamp(near.person_velocity.dot(-n), 0.0, 2.2);
  const double protective = human * (settings_.reaction + stop_time) + toward * settings_.reaction +
                            std::max(0.0, stop_distance) + settings_.margin;
  return near.distance < protective;
}

bool SeparationOracle::presses(const RobotBody& robot, const std::vector<Touch>& touches,
                               const Vector& velocity) {
  double force = 0, power = 0;
  for (const Touch& t : touches) {
    robot.directed_jacobian(t.index_a, t.point, -t.normal, jacobian_);
    force += t.normal_force;
    power += t.normal_force * jacobian_.dot(velocity);
  }
  return power >= settings_.moving * force;
}

}  // namespace handsel::sim
