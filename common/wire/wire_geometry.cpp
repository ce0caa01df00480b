// SPDX-License-Identifier: Apache-2.0
// Points, directions, poses and wrenches of WireIo.
#include <cmath>

#include "common/wire/wire_io.hpp"
#include "common/wire/wire_text.hpp"

namespace handsel {

using detail::number_text;

void WireIo::point(const char* field, Vector3& m, handsel_Vector3& w, Range range) {
  if (failed_) return;
  double* const wire[] = {&w.x, &w.y, &w.z};
  static constexpr const char* kNames[] = {"x", "y", "z"};
  if (mode_ == Mode::json) {
    json_key(field);
    *text_ += '[';
    for (int i = 0; i < 3; ++i) {
      if (i) *text_ += ',';
      json_number(m[i]);
    }
    *text_ += ']';
    return;
  }
  stack_[depth_++] = {field, -1};
  for (int i = 0; i < 3; ++i) number(kNames[i], m[i], *wire[i], range);
  --depth_;
}

void WireIo::direction(const char* field, Vector3& m, handsel_Vector3& w, bool meant) {
  if (failed_) return;
  if (converting() && !meant) {
    m = mode_ == Mode::from_wire ? Vector3(Vector3::UnitX()) : m;
    w = {1, 0, 0};
    return;
  }
  point(field, m, w, Range{-2, 2});
  if (mode_ == Mode::fill) w = {1, 0, 0};
  if (!converting()) return;
  const double norm = m.norm();
  if (std::abs(norm - 1) > 1e-3)
    return fail(field, "has length " + number_text(norm) + ", must be a unit vector");
  if (mode_ == Mode::from_wire)
    m /= norm;
  else
    w = {w.x / norm, w.y / norm, w.z / norm};
}

void WireIo::pose(const char* field, Pose& m, handsel_Pose& w) {
  if (failed_) return;
  const Range unit{-2, 2};
  if (mode_ == Mode::json) {
    const Eigen::Quaterniond q(m.linear());
    json_key(field);
    *text_ += "{\"p\":[";
    for (int i = 0; i < 3; ++i) {
      if (i) *text_ += ',';
      json_number(m.translation()[i]);
    }
    *text_ += "],\"q\":[";
    for (int i = 0; i < 4; ++i) {
      if (i) *text_ += ',';
      json_number(q.coeffs()[i]);
    }
    *text_ += "]}";
    return;
  }
  stack_[depth_++] = {field, -1};
  Vector3 p = mode_ == Mode::to_wire ? Vector3(m.translation()) : Vector3(Vector3::Zero());
  point("position", p, w.position);
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  if (mode_ == Mode::to_wire && !failed_) {
    if (!m.linear().allFinite() || std::abs(m.linear().determinant() - 1) > 1e-3)
      fail("orientation", "is not a rotation");
    else
      q = Eigen::Quaterniond(m.linear()).normalized();
  }
  stack_[depth_++] = {"orientation", -1};
  number("x", q.x(), w.orientation.x, unit);
  number("y", q.y(), w.orientation.y, unit);
  number("z", q.z(), w.orientation.z, unit);
  number("w", q.w(), w.orientation.w, unit);
  --depth_;
  if (mode_ == Mode::fill) w.orientation = {0, 0, 0, 1};
  if (mode_ == Mode::from_wire && !failed_) {
    const double norm = q.norm();
    if (std::abs(norm - 1) > 1e-3)
      fail("orientation", "has norm " + number_text(norm) + ", must be a unit quaternion");
    else
      m = make_pose(p, q);
  }
  --depth_;
}

void WireIo::wrench(const char* field, Wrench& m, handsel_Wrench& w) {
  if (failed_) return;
  open(field);
  point("force", m.force, w.force, kForce);
  point("torque", m.torque, w.torque, kForce);
  close();
}

}  // namespace handsel
