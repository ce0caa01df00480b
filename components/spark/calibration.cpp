// SPDX-License-Identifier: Apache-2.0
#include "components/spark/calibration.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"
#include "common/config/schema/calibration.pb.h"

namespace handsel::spark {
namespace {

constexpr double kMaxRotationError = 1e-3;  // max error of a quaternion's norm or matrix product
constexpr double kMaxSensorDistance = 50;   // max distance from the world's origin [m]

std::optional<std::chrono::sys_days> date(const std::string& text) {
  int y = 0, m = 0, d = 0, used = 0;
  if (std::sscanf(text.c_str(), "%4d-%2d-%2d%n", &y, &m, &d, &used) != 3 || used != 10 ||
      text.size() != 10)
    return std::nullopt;
  const std::chrono::year_month_day day{std::chrono::year(y),
                                        std::chrono::month(static_cast<unsigned>(m)),
                                        std::chrono::day(static_cast<unsigned>(d))};
  return day.ok() ? std::optional(std::chrono::sys_days(day)) : std::nullopt;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// Returns the pose in a file. `fail` throws an error with the position in the file.
template <class Fail>
Pose read(const config::Rigid& in, const Fail& fail) {
  const Vector3 p(in.position().x(), in.position().y(), in.position().z());
  if (!p.allFinite() || p.norm() > kMaxSensorDistance)
    fail("stands " + number(p.norm()) +
         " m from the world's origin; positions are in metres, no farther than " +
         number(kMaxSensorDistance));
  if (in.has_orientation() && in.rotation_size() > 0)
    fail("has an orientation and a rotation; it must be one of them");
  if (in.rotation_size() > 0) {
    if (in.rotation_size() != 9)
      fail("has a rotation of " + std::to_string(in.rotation_size()) +
           " numbers; it must be nine, row by row");
    Eigen::Matrix3d R;
    for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = in.rotation(i);
    const double error = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (!(error <= kMaxRotationError))
      fail("has a rotation whose rows are not at right angles and of length 1 (off by " +
           number(error) + ")");
    if (R.determinant() < 0) fail("has a rotation that mirrors; its determinant must be 1");
    return make_pose(p, Eigen::Quaterniond(R));
  }
  if (!in.has_orientation()) return make_pose(p);
  const Eigen::Quaterniond q(in.orientation().w(), in.orientation().x(), in.orientation().y(),
                             in.orientation().z());
  if (!(std::abs(q.norm() - 1) <= kMaxRotationError))
    fail("has an orientation of norm " + number(q.norm()) +
         "; a rotation is a quaternion x y z w of norm 1");
  return make_pose(p, q);
}

}  // namespace

std::optional<double> days_between(const std::string& first, const std::string& second) {
  const auto a = date(first), b = date(second);
  return a && b ? std::optional(static_cast<double>((*b - *a).count())) : std::nullopt;
}

Coverage inscribed(const Coverage& box, const Pose& T_world_box) {
  const Vector3 half = (box.high - box.low) / 2,
                middle = T_world_box * Vector3((box.low + box.high) / 2);
  const Eigen::Matrix3d R = T_world_box.linear().cwiseAbs();
  const Vector3 half_bounding = R * half, half_needed = R.transpose() * half_bounding;
  double scale = 1;
  for (int i = 0; i < 3; ++i)
    if (half_needed[i] > 0) scale = std::min(scale, half[i] / half_needed[i]);
  return {middle - scale * half_bounding, middle + scale * half_bounding};
}

Calibration::Calibration(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return;
  config::Calibration in;
  load_text_proto(file, in);
  const auto failing = [&](const std::string& kind, const std::string& name) {
    return [&file, kind, name](const std::string& what) {
      throw ConfigError(locate(file, "\"" + name + "\"") + ": " + kind + " " + name + " " + what);
    };
  };
  valid_days_ = in.valid_days();
  if (!(valid_days_ >= 0))
    throw ConfigError(locate(file, "valid_days") + ": valid_days must be >= 0");
  for (const config::CalibratedSource& s : in.sources()) {
    const auto fail = failing("source", s.source());
    if (s.source().empty())
      throw ConfigError(locate(file, "sources") +
                        ": a source has no name; `source` is the one its observations carry");
    if (sources_.contains(s.source())) fail("is there twice");
    if (!s.measured().empty() && !date(s.measured()))
      fail("was measured on " + s.measured() + ", which is no date of the form YYYY-MM-DD");
    Source& source = sources_[s.source()];
    source.own_frame = s.speaks_in() == config::CAMERA;
    if (source.own_frame && !s.has_t_world_camera())
      fail("speaks in its own frame, but where that is (T_world_camera) is not said");
    source.T_world_camera = read(s.t_world_camera(), fail);
    source.measured = s.measured();
    if (s.has_coverage_low() != s.has_coverage_high())
      fail("has one of coverage_low and coverage_high; it must be both or none");
    if (!s.has_coverage_low()) continue;
    if (!source.own_frame)
      fail(
          "tells its own coverage in frame world; one here is for a source that speaks in its "
          "camera's");
    const auto &low = s.coverage_low(), &high = s.coverage_high();
    source.coverage = Coverage{{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}};
    if (!(source.coverage->low.array() < source.coverage->high.array()).all())
      fail("has a coverage_low that is not below its coverage_high");
  }
  for (const config::CalibratedRobot& r : in.robots()) {
    const auto fail = failing("robot", r.robot());
    if (r.robot().empty())
      throw ConfigError(locate(file, "robots") +
                        ": a robot has no name; `robot` is the one of its description");
    if (robots_.contains(r.robot())) fail("is there twice");
    if (!r.measured().empty() && !date(r.measured()))
      fail("was measured on " + r.measured() + ", which is no date of the form YYYY-MM-DD");
    robots_[r.robot()] = {read(r.t_world_base(), fail), r.measured()};
  }
}

void Calibration::to_world(HumanObservation& observation) const {
  const auto found = sources_.find(observation.source);
  if (found == sources_.end() || !found->second.own_frame) return;
  const Pose& T = found->second.T_world_camera;
  observation.coverage =
      found->second.coverage ? *found->second.coverage : inscribed(observation.coverage, T);
  for (ObservedPerson& person : observation.people) {
    for (ObservedJoint& joint : person.joints) joint.position = T * joint.position;
    if (!person.has_gaze) continue;
    person.gaze_origin = T * person.gaze_origin;
    person.gaze_direction = T.linear() * person.gaze_direction;
  }
}

void Calibration::to_world(ObjectObservation& observation) const {
  const auto found = sources_.find(observation.source);
  if (found == sources_.end() || !found->second.own_frame) return;
  const Pose& T = found->second.T_world_camera;
  for (ObservedObject& object : observation.objects) {
    object.T_world_object = T * object.T_world_object;
    for (ObservedGrip& grip : object.grips) grip.position = T * grip.position;
  }
}

}  // namespace handsel::spark
