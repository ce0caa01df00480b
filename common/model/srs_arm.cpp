// SPDX-License-Identifier: Apache-2.0
#include "common/model/srs_arm.hpp"

#include <limits>

namespace handsel::ik {
namespace {

constexpr double kSame = 1e-6;  // tolerance of the recognition of the shape [m], [rad]
constexpr int kCircleSamples = 48;
constexpr int kRefinements = 24;
constexpr double kViolation = 1e3;  // cost per radian outside the limits [1/rad]
constexpr double kArmOnLimit = 1e-7, kArmWorthTrying = 0.3;  // excess over the limits [rad]
constexpr double kRestWeight = 0.02;
constexpr double kMargin = 0.15;  // desired distance to the limits [rad]
constexpr double kMarginWeight = 4.0;

double wrap(double angle) { return angle - 2 * M_PI * std::nearbyint(angle / (2 * M_PI)); }

/// Computes the intersection of two lines; returns false if there is none.
bool meet(const Vector3& p, const Vector3& a, const Vector3& q, const Vector3& b, Vector3& at) {
  const Vector3 n = a.cross(b);
  if (n.norm() < 0.9) return false;
  at = p + a * ((q - p).cross(b).dot(n) / n.squaredNorm());
  return std::abs((q - p).dot(n)) < kSame;
}

bool on_line(const Vector3& x, const Vector3& p, const Vector3& a) {
  return a.cross(x - p).norm() < kSame;
}

}  // namespace

/// Values that are constant along the circle of elbow positions.
struct SrsArm::Problem {
  Axes seed;
  Eigen::Matrix3d R_tip;  // R_target * R_zero^T
  Vector3 to_target;      // desired vector from shoulder to wrist
  double elbow, elbow_cost;
  Eigen::Matrix3d R_elbow_t;  // rotation of the elbow, transposed
  Eigen::Matrix3d R_start;    // a rotation of the shoulder that puts the wrist in place
  Vector3 circle_axis;
};

std::string SrsArm::why_none(const Group& group) {
  const std::size_t axes = group.axes.size();
  return axes == 7 ? "the axes of the group \"" + group.name +
                         "\" do not meet in shoulder, elbow and wrist: they do not follow from "
                         "tool pose and elbow angle"
                   : "the group \"" + group.name + "\" has " + std::to_string(axes) +
                         " axes; the seven of an arm with shoulder, elbow and wrist are needed";
}

std::optional<SrsArm> SrsArm::recognise(const Chain& chain) {
  const auto& elements = chain.elements();
  if (chain.size() != 7 || elements.size() != 7) return std::nullopt;
  SrsArm arm(chain);
  std::array<Vector3, 7> point;
  Pose T = Pose::Identity();
  for (int i = 0; i < 7; ++i) {
    const Element& e = elements[i];
    if (e.prismatic || e.column != i || e.factor != 1 || e.offset != 0) return std::nullopt;
    T = T * e.T_before;
    point[i] = T.translation();
    arm.axis_[i] = T.linear() * e.axis;
    if (i > 0 && std::abs(arm.axis_[i].dot(arm.axis_[i - 1])) > kSame) return std::nullopt;
  }
  const auto& a = arm.axis_;
  Vector3 elbow, wrist;
  if (!meet(point[0], a[0], point[1], a[1], arm.shoulder_) ||
      !on_line(arm.shoulder_, point[2], a[2]))
    return std::nullopt;
  if (!meet(point[4], a[4], point[5], a[5], wrist) || !on_line(wrist, point[6], a[6]))
    return std::nullopt;
  if (!meet(point[2], a[2], point[3], a[3], elbow) || !on_line(elbow, point[4], a[4]))
    return std::nullopt;
  for (const auto& [i, k] : {std::pair(0, 2), std::pair(4, 6), std::pair(2, 4)})
    if (a[i].cross(a[k]).norm() > kSame) return std::nullopt;
  arm.to_elbow_ = elbow - arm.shoulder_;
  arm.to_wrist_ = wrist - elbow;
  if (arm.to_elbow_.norm() < 0.01 || arm.to_wrist_.norm() < 0.01) return std::nullopt;
  const Pose T_zero = chain.forward(Axes::Zero(7), nullptr);
  arm.R_zero_ = T_zero.linear();
  arm.p_tip_wrist_ = T_zero.inverse() * wrist;
  for (int k = 0; k < 2; ++k) {
    arm.basis_[k] << a[4 * k + 1].cross(a[4 * k]), a[4 * k + 1], a[4 * k];
    arm.last_sign_[k] = a[4 * k].dot(a[4 * k + 2]) > 0 ? 1.0 : -1.0;
  }
  return arm;
}

double SrsArm::axis_cost(const Problem& problem, int axis, double& angle) const {
  const double low = chain_->lower()[axis], high = chain_->upper()[axis], seed = problem.seed[axis];
  angle = seed + wrap(angle - seed);
  if (angle < low && angle + 2 * M_PI <= high) angle += 2 * M_PI;
  if (angle > high && angle - 2 * M_PI >= low) angle -= 2 * M_PI;
  const double outside = std::max({low - angle, angle - high, 0.0});
  if (outside > M_PI) angle = wrap(angle);
  const double inside = std::min(angle - low, high - angle),
               tight = std::max(kMargin - inside, 0.0);
  const double from_seed = angle - seed, from_rest = angle - chain_->rest()[axis];
  return from_seed * from_seed + kRestWeight * from_rest * from_rest +
         kMarginWeight * tight * tight + kViolation * std::max({low - angle, angle - high, 0.0});
}

/// Returns both decompositions of R into rotations about three axes from `first`; the same one
/// twice if the axes are aligned.
SrsArm::Solutions SrsArm::solutions(const Eigen::Matrix3d& R, int first,
                                    double first_when_in_line) const {
  const Eigen::Matrix3d& B = basis_[first / 4];
  const Eigen::Matrix3d Z = B.transpose() * R * B;
  const double sine = std::hypot(Z(0, 2), Z(1, 2)), middle = std::atan2(sine, Z(2, 2));
  double q0, q2;
  if (sine > 1e-9) {
    q0 = std::atan2(Z(1, 2), Z(0, 2));
    q2 = std::atan2(Z(2, 1), -Z(2, 0));
  } else {
    q0 = first_when_in_line;
    const double both = std::atan2(Z(1, 0), Z(1, 1));
    q2 = Z(2, 2) > 0 ? both - q0 : q0 - std::atan2(-Z(1, 0), Z(1, 1));
  }
  const double other = sine > 1e-9 ? M_PI : 0.0, sign = last_sign_[first / 4];
  return {{{q0, middle, sign * q2}, {q0 + other, -middle, sign * (q2 + other)}}};
}

/// Adds the cheaper of the two solutions to the candidate.
void SrsArm::choose(const Problem& problem, const Eigen::Matrix3d& R, int first,
                    Candidate& candidate) const {
  double best = std::numeric_limits<double>::infinity();
  std::array<double, 3> chosen{};
  for (std::array<double, 3> q : solutions(R, first, problem.seed[first])) {
    double cost = 0;
    for (int i = 0; i < 3; ++i) cost += axis_cost(problem, first + i, q[i]);
    if (cost < best) best = cost, chosen = q;
  }
  candidate.cost += best;
  for (int i = 0; i < 3; ++i) candidate.q[first + i] = chosen[i];
}

SrsArm::Candidate SrsArm::at(const Problem& problem, double circle) const {
  Candidate candidate{problem.elbow_cost, Axes::Zero(7)};
  candidate.q[3] = problem.elbow;
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(circle, problem.circle_axis).toRotationMatrix() * problem.R_start;
  choose(problem, R, 0, candidate);
  choose(problem, problem.R_elbow_t * (R.transpose() * problem.R_tip), 4, candidate);
  return candidate;
}

/// Refines by golden-section search between the samples beside `centre`.
SrsArm::Candidate SrsArm::refine(const Problem& problem, double centre) const {
  constexpr double kGolden = 0.6180339887498949;
  double low = centre - 2 * M_PI / kCircleSamples, high = centre + 2 * M_PI / kCircleSamples;
  double x = high - kGolden * (high - low), y = low + kGolden * (high - low);
  Candidate at_x = at(problem, x), at_y = at(problem, y), best = at(problem, centre);
  for (int i = 0; i < kRefinements; ++i) {
    if (at_x.cost < at_y.cost) {
      high = y, y = x, at_y = at_x;
      x = high - kGolden * (high - low);
      at_x = at(problem, x);
    } else {
      low = x, x = y, at_x = at_y;
      y = low + kGolden * (high - low);
      at_y = at(problem, y);
    }
  }
  for (const auto& c : {at_x, at_y})
    if (c.cost < best.cost) best = c;
  return best;
}

/// Returns the elbow rotation [rad]; nullopt if the wrist is out of reach.
std::optional<double> SrsArm::set_target(const Pose& T_root_tip, Problem& problem) const {
  problem.R_tip = T_root_tip.linear() * R_zero_.transpose();
  problem.to_target = T_root_tip * p_tip_wrist_ - shoulder_;
  const double upper = to_elbow_.norm(), fore = to_wrist_.norm(), d = problem.to_target.norm();
  const double cosine = (d * d - upper * upper - fore * fore) / (2 * upper * fore);
  if (!(d >= 1e-6 && std::abs(cosine) <= 1)) return std::nullopt;
  problem.circle_axis = problem.to_target / d;
  // Rotation from the straight arm; the arm may be folded back on itself if all joints are 0.
  return to_elbow_.dot(to_wrist_) > 0 ? std::acos(cosine) : M_PI - std::acos(cosine);
}

void SrsArm::bend(Problem& problem) const {
  const Eigen::Matrix3d R_elbow = Eigen::AngleAxisd(problem.elbow, axis_[3]).toRotationMatrix();
  problem.R_elbow_t = R_elbow.transpose();
  problem.R_start =
      Eigen::Quaterniond::FromTwoVectors(to_elbow_ + R_elbow * to_wrist_, problem.to_target)
          .toRotationMatrix();
}

double SrsArm::angle_of(const Vector3& to_elbow, const Vector3& to_wrist) const {
  const Vector3 line = to_wrist.normalized();
  Vector3 up = axis_[0] - line * line.dot(axis_[0]);
  if (up.norm() < 1e-6) up = line.unitOrthogonal();
  up.normalize();
  const Vector3 across = line.cross(up);
  return to_elbow.dot(across) == 0 && to_elbow.dot(up) == 0
             ? 0.0
             : std::atan2(to_elbow.dot(across), to_elbow.dot(up));
}

double SrsArm::elbow_angle(const Axes& q) const {
  const auto turn = [&](int i) { return Eigen::AngleAxisd(q[i], axis_[i]); };
  const Eigen::Quaterniond shoulder = turn(0) * turn(1) * turn(2);
  return angle_of(shoulder * to_elbow_, shoulder * (to_elbow_ + turn(3) * to_wrist_));
}

/// Computes one Newton step onto the pose: the axes of a chain from a file are perpendicular and
/// parallel only to the digits of the file.
Axes SrsArm::polished(const Pose& T_root_tip, const Axes& q) const {
  Jacobian J;
  const Vector6 error = error_of(T_root_tip, chain_->forward(q, &J));
  const Eigen::Matrix<double, 6, 6> JJ =
      J * J.transpose() + 1e-12 * Eigen::Matrix<double, 6, 6>::Identity();
  const Axes better = q + J.transpose() * JJ.ldlt().solve(error);
  return error_of(T_root_tip, chain_->forward(better, nullptr)).norm() < error.norm() ? better : q;
}

template <class Take>
void SrsArm::each_branch(const Pose& T_root_tip, double elbow_angle, const Take& take) const {
  Problem problem;
  const std::optional<double> bent = set_target(T_root_tip, problem);
  if (!bent) return;
  for (const double side : {1.0, -1.0}) {
    problem.elbow = side * *bent;
    bend(problem);
    const double circle = elbow_angle - angle_of(problem.R_start * to_elbow_, problem.to_target);
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(circle, problem.circle_axis).toRotationMatrix() * problem.R_start;
    const Solutions wrists = solutions(problem.R_elbow_t * (R.transpose() * problem.R_tip), 4, 0.0);
    for (const auto& shoulder : solutions(R, 0, 0.0))
      for (const auto& wrist : wrists) {
        Axes q(7);
        q << shoulder[0], shoulder[1], shoulder[2], problem.elbow, wrist[0], wrist[1], wrist[2];
        take(q);
      }
  }
}

std::vector<Axes> SrsArm::branches(const Pose& T_root_tip, double elbow_angle) const {
  std::vector<Axes> out;
  each_branch(T_root_tip, elbow_angle,
              [&](const Axes& q) { out.push_back(polished(T_root_tip, q)); });
  return out;
}

std::optional<Axes> SrsArm::turned_inside(const Axes& q, const Axes& near) const {
  Axes out(q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    out[i] = near[i] + std::remainder(q[i] - near[i], 2 * M_PI);
    if (out[i] < chain_->lower()[i]) out[i] += 2 * M_PI;
    if (out[i] > chain_->upper()[i]) out[i] -= 2 * M_PI;
    if (!(out[i] >= chain_->lower()[i] && out[i] <= chain_->upper()[i])) return std::nullopt;
  }
  return out;
}

std::optional<Axes> SrsArm::nearest(const Pose& T_root_tip, double elbow_angle,
                                    const Axes& near) const {
  double least = std::numeric_limits<double>::infinity();
  std::optional<Axes> best;
  each_branch(T_root_tip, elbow_angle, [&](const Axes& q) {
    const std::optional<Axes> inside = turned_inside(q, near);
    if (!inside) return;
    const double apart = (*inside - near).lpNorm<Eigen::Infinity>();
    if (apart >= least) return;
    least = apart;
    best = inside;
  });
  return best ? turned_inside(polished(T_root_tip, *best), near) : std::nullopt;
}

double SrsArm::outside(const Axes& q) const {
  return std::max({0.0, (chain_->lower() - q).maxCoeff(), (q - chain_->upper()).maxCoeff()});
}

std::optional<SrsArm::Solution> SrsArm::solve(const Pose& T_root_tip, const Axes& seed) const {
  Problem problem;
  problem.seed = seed;
  const std::optional<double> bent = set_target(T_root_tip, problem);
  if (!bent) return std::nullopt;
  Candidate best{std::numeric_limits<double>::infinity(), Axes::Zero(7)};
  const auto keep = [&best](const Candidate& c) {
    if (c.cost < best.cost) best = c;
  };
  for (const double side : {1.0, -1.0}) {
    problem.elbow = side * *bent;
    problem.elbow_cost = axis_cost(problem, 3, problem.elbow);
    bend(problem);
    std::array<double, kCircleSamples> cost;
    int least = 0;
    for (int i = 0; i < kCircleSamples; ++i) {
      cost[i] = at(problem, 2 * M_PI * i / kCircleSamples).cost;
      if (cost[i] < cost[least]) least = i;
    }
    keep(refine(problem, 2 * M_PI * least / kCircleSamples));
    for (int i = 0; i < kCircleSamples && outside(best.q) > kArmOnLimit; ++i) {
      const double before = cost[(i + kCircleSamples - 1) % kCircleSamples],
                   after = cost[(i + 1) % kCircleSamples];
      if (i != least && cost[i] <= before && cost[i] <= after &&
          cost[i] < kViolation * kArmWorthTrying)
        keep(refine(problem, 2 * M_PI * i / kCircleSamples));
    }
  }
  return Solution{best.q.cwiseMax(chain_->lower()).cwiseMin(chain_->upper()), outside(best.q)};
}

}  // namespace handsel::ik
