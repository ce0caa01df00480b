// SPDX-License-Identifier: Apache-2.0
#include "common/wire/ros2.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <dds/dds.h>

#include "idl/ros2/ros2.h"

namespace handsel {
namespace {

constexpr double kMaxValue = 1e4;     // as in all messages: [m], [rad], and their first derivatives
constexpr double kForce = 1e5;        // [N], [Nm]
constexpr double kUnit = 1e-3;        // max deviation of a quaternion's norm from 1
constexpr double kMaxDuration = 1e4;  // max duration of a trajectory [s]

/// Records the first error of a message.
struct ReadCheck {
  std::string& why;
  bool good{true};
  bool fail(const std::string& field, const std::string& sentence) {
    if (good) why = field + " " + sentence;
    return good = false;
  }
};

Stamp stamp_of(const builtin_interfaces_msg_dds__Time_& t) {
  return t.sec_ * 1'000'000'000LL + t.nanosec_;
}
void put(Stamp stamp, builtin_interfaces_msg_dds__Time_& out) {
  out.sec_ = static_cast<std::int32_t>(stamp / 1'000'000'000);
  out.nanosec_ = static_cast<std::uint32_t>(stamp % 1'000'000'000);
}

std::string text_of(ReadCheck& check, const char* field, const char* text) {
  std::string value = text ? text : "";
  const bool printable =
      std::all_of(value.begin(), value.end(), [](char c) { return c > 31 && c < 127; });
  if (value.size() > kRosText)
    check.fail(field, "is longer than " + std::to_string(kRosText) + " bytes");
  if (!printable) check.fail(field, "holds bytes that are not printable ASCII");
  return value;
}

void put(const std::string& text, char*& out) {
  dds_free(out);
  out = dds_string_dup(text.c_str());
}

template <class Seq>
void texts_of(ReadCheck& check, const char* field, const Seq& seq, std::size_t max_count,
              std::vector<std::string>& out) {
  out.clear();
  if (seq._length > max_count) {
    check.fail(field, "has " + std::to_string(seq._length) + " elements, at most " +
                          std::to_string(max_count) + " are taken");
    return;
  }
  for (std::uint32_t i = 0; i < seq._length && check.good; ++i)
    out.push_back(text_of(check, field, seq._buffer[i]));
}

/// Reads exactly `count` numbers, or none.
template <class Seq>
void numbers_of(ReadCheck& check, const char* field, const Seq& seq, std::size_t count,
                double largest, Vector& out) {
  if (seq._length != count && seq._length != 0) {
    check.fail(field, "has " + std::to_string(seq._length) + " elements for " +
                          std::to_string(count) + " names");
    return;
  }
  out.resize(static_cast<Eigen::Index>(seq._length));
  for (std::uint32_t i = 0; i < seq._length; ++i) {
    out[i] = seq._buffer[i];
    if (std::abs(out[i]) <= largest) continue;
    check.fail(std::string(field) + "[" + std::to_string(i) + "]",
               std::isfinite(out[i]) ? "is out of range" : "is not finite");
    return;
  }
}

template <class Seq>
void resize(Seq& seq, std::size_t n) {
  seq._buffer = static_cast<decltype(seq._buffer)>(
      dds_alloc(std::max<std::size_t>(1, n * sizeof *seq._buffer)));
  std::memset(static_cast<void*>(seq._buffer), 0, n * sizeof *seq._buffer);
  seq._maximum = seq._length = static_cast<std::uint32_t>(n);
  seq._release = true;
}

template <class Seq>
void put(const Vector& values, Seq& seq) {
  resize(seq, static_cast<std::size_t>(values.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i) seq._buffer[i] = values[i];
}

template <class Seq>
void put(const std::vector<std::string>& values, Seq& seq) {
  resize(seq, values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    seq._buffer[i] = dds_string_dup(values[i].c_str());
}

void put_header(Stamp stamp, const std::string& frame, std_msgs_msg_dds__Header_& out) {
  put(stamp, out.stamp_);
  put(frame, out.frame_id_);
}

bool read(const sensor_msgs_msg_dds__JointState_& w, ros2::JointState& m, ReadCheck& check) {
  m.stamp = stamp_of(w.header_.stamp_);
  texts_of(check, "name", w.name_, kRosJoints, m.names);
  numbers_of(check, "position", w.position_, m.names.size(), kMaxValue, m.position);
  numbers_of(check, "velocity", w.velocity_, m.names.size(), kMaxValue, m.velocity);
  numbers_of(check, "effort", w.effort_, m.names.size(), kForce, m.effort);
  return check.good;
}

void write(const ros2::JointState& m, sensor_msgs_msg_dds__JointState_& w) {
  put_header(m.stamp, "", w.header_);
  put(m.names, w.name_);
  put(m.position, w.position_);
  put(m.velocity, w.velocity_);
  put(m.effort, w.effort_);
}

bool read(const trajectory_msgs_msg_dds__JointTrajectory_& w, ros2::JointTrajectory& m,
          ReadCheck& check) {
  m.stamp = stamp_of(w.header_.stamp_);
  texts_of(check, "joint_names", w.joint_names_, kRosJoints, m.joint_names);
  if (w.points_._length > kRosPoints)
    return check.fail("points", "are more than " + std::to_string(kRosPoints));
  m.points.assign(w.points_._length, {});
  double before = 0;
  for (std::uint32_t i = 0; i < w.points_._length && check.good; ++i) {
    const auto& point = w.points_._buffer[i];
    const std::string field = "points[" + std::to_string(i) + "].";
    numbers_of(check, (field + "positions").c_str(), point.positions_, m.joint_names.size(),
               kMaxValue, m.points[i].positions);
    if (point.positions_._length == 0) return check.fail(field + "positions", "are missing");
    m.points[i].time_from_start =
        point.time_from_start_.sec_ + 1e-9 * point.time_from_start_.nanosec_;
    if (m.points[i].time_from_start < before || m.points[i].time_from_start > kMaxDuration)
      return check.fail(field + "time_from_start", "is not between that of the point before and " +
                                                       std::to_string(int(kMaxDuration)) + " s");
    before = m.points[i].time_from_start;
  }
  return check.good;
}

void write(const ros2::JointTrajectory& m, trajectory_msgs_msg_dds__JointTrajectory_& w) {
  put_header(m.stamp, "", w.header_);
  put(m.joint_names, w.joint_names_);
  resize(w.points_, m.points.size());
  for (std::size_t i = 0; i < m.points.size(); ++i) {
    auto& point = w.points_._buffer[i];
    put(m.points[i].positions, point.positions_);
    for (auto* empty : {&point.velocities_, &point.accelerations_, &point.effort_})
      resize(*empty, 0);
    point.time_from_start_.sec_ = static_cast<std::int32_t>(m.points[i].time_from_start);
    point.time_from_start_.nanosec_ = static_cast<std::uint32_t>(
        1e9 * (m.points[i].time_from_start - point.time_from_start_.sec_));
  }
}

std::string frame_of(ReadCheck& check, const std::string& field, const char* text) {
  const std::string frame = text_of(check, field.c_str(), text);
  if (frame.empty() || frame == "/") check.fail(field, "is empty");
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

bool read(const tf2_msgs_msg_dds__TFMessage_& w, ros2::Transforms& m, ReadCheck& check) {
  if (w.transforms_._length > kRosTransforms)
    return check.fail("transforms", "are more than " + std::to_string(kRosTransforms));
  m.transforms.assign(w.transforms_._length, {});
  for (std::uint32_t i = 0; i < w.transforms_._length && check.good; ++i) {
    const auto& from = w.transforms_._buffer[i];
    ros2::Transform& to = m.transforms[i];
    const std::string field = "transforms[" + std::to_string(i) + "].";
    to.stamp = stamp_of(from.header_.stamp_);
    to.parent = frame_of(check, field + "header.frame_id", from.header_.frame_id_);
    to.child = frame_of(check, field + "child_frame_id", from.child_frame_id_);
    const auto& t = from.transform_.translation_;
    const auto& q = from.transform_.rotation_;
    const Vector3 p(t.x_, t.y_, t.z_);
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kMaxValue)
      check.fail(field + "translation", "is not finite within 1e4 m");
    const Eigen::Quaterniond rotation(q.w_, q.x_, q.y_, q.z_);
    if (!(std::abs(rotation.norm() - 1) <= kUnit))
      check.fail(field + "rotation", "is no unit quaternion");
    to.T_parent_child = make_pose(p, rotation.normalized());
  }
  return check.good;
}

void write(const ros2::Transforms& m, tf2_msgs_msg_dds__TFMessage_& w) {
  resize(w.transforms_, m.transforms.size());
  for (std::size_t i = 0; i < m.transforms.size(); ++i) {
    const ros2::Transform& from = m.transforms[i];
    auto& to = w.transforms_._buffer[i];
    put_header(from.stamp, from.parent, to.header_);
    put(from.child, to.child_frame_id_);
    const Vector3 p = from.T_parent_child.translation();
    const Eigen::Quaterniond q(from.T_parent_child.linear());
    to.transform_.translation_ = {p.x(), p.y(), p.z()};
    to.transform_.rotation_ = {q.x(), q.y(), q.z(), q.w()};
  }
}

bool read(const hri_msgs_msg_dds__IdsList_& w, ros2::Ids& m, ReadCheck& check) {
  m.stamp = stamp_of(w.header_.stamp_);
  texts_of(check, "ids", w.ids_, kRosJoints, m.ids);
  return check.good;
}

void write(const ros2::Ids& m, hri_msgs_msg_dds__IdsList_& w) {
  put_header(m.stamp, "", w.header_);
  put(m.ids, w.ids_);
}

bool read(const std_msgs_msg_dds__String_& w, ros2::Text& m, ReadCheck& check) {
  m.data = text_of(check, "data", w.data_);
  return check.good;
}

void write(const ros2::Text& m, std_msgs_msg_dds__String_& w) { put(m.data, w.data_); }

template <class W>
Stamp stamp_in(const W& w) {
  if constexpr (requires { w.header_; })
    return stamp_of(w.header_.stamp_);
  else
    return 0;
}
Stamp stamp_in(const tf2_msgs_msg_dds__TFMessage_& w) {
  return w.transforms_._length > 0 ? stamp_of(w.transforms_._buffer[0].header_.stamp_) : 0;
}

/// Name and row are part of the type.
template <class M, class W>
class RosType final : public MessageType {
 public:
  RosType(const dds_topic_descriptor_t& descriptor, const std::string& name, Profile profile)
      : descriptor_(descriptor),
        topic_("rt/" + name),
        row_{descriptor.m_typename, topic_.c_str(), profile, 0, 0, 0, "", ""} {}

  const TopicRow& row() const override { return row_; }
  const void* descriptor() const override { return &descriptor_; }
  bool to_wire(const void* message, Stamp, void* wire, std::string&) const override {
    dds_sample_free(wire, &descriptor_, DDS_FREE_CONTENTS);
    std::memset(wire, 0, sizeof(W));
    write(*static_cast<const M*>(message), *static_cast<W*>(wire));
    return true;
  }
  using MessageType::from_wire;
  bool from_wire(const void* wire, void* message, std::string& why,
                 LeftOutElements&) const override {
    ReadCheck check{why};
    if (read(*static_cast<const W*>(wire), *static_cast<M*>(message), check)) return true;
    why = topic_ + ": " + why;
    return false;
  }
  Stamp stamp(const void* wire) const override { return stamp_in(*static_cast<const W*>(wire)); }
  void set_stamp(void*, Stamp) const override {}
  std::string_view key(const void*) const override { return {}; }
  /// Converts own messages only; foreign ones have no viewer and no generic tests.
  std::string to_json(const void*) const override {
    return std::string("{\"type\":\"") + row_.type + "\"}";
  }
  void leaves(void*, const std::function<void(const WireLeaf&)>&) const override {}
  void fill(void*, bool) const override {}
  std::shared_ptr<void> new_wire() const override {
    void* sample = dds_alloc(sizeof(W));
    std::memset(sample, 0, sizeof(W));
    return {sample, [d = &descriptor_](void* s) { dds_sample_free(s, d, DDS_FREE_ALL); }};
  }
  std::shared_ptr<void> new_message() const override { return std::make_shared<M>(); }

 private:
  const dds_topic_descriptor_t& descriptor_;
  std::string topic_;
  TopicRow row_;
};

}  // namespace

template <>
std::unique_ptr<MessageType> ros2_type<ros2::JointState>(const std::string& name, Profile profile) {
  return std::make_unique<RosType<ros2::JointState, sensor_msgs_msg_dds__JointState_>>(
      sensor_msgs_msg_dds__JointState__desc, name, profile);
}

template <>
std::unique_ptr<MessageType> ros2_type<ros2::JointTrajectory>(const std::string& name,
                                                              Profile profile) {
  return std::make_unique<
      RosType<ros2::JointTrajectory, trajectory_msgs_msg_dds__JointTrajectory_>>(
      trajectory_msgs_msg_dds__JointTrajectory__desc, name, profile);
}

template <>
std::unique_ptr<MessageType> ros2_type<ros2::Transforms>(const std::string& name, Profile profile) {
  return std::make_unique<RosType<ros2::Transforms, tf2_msgs_msg_dds__TFMessage_>>(
      tf2_msgs_msg_dds__TFMessage__desc, name, profile);
}

template <>
std::unique_ptr<MessageType> ros2_type<ros2::Ids>(const std::string& name, Profile profile) {
  return std::make_unique<RosType<ros2::Ids, hri_msgs_msg_dds__IdsList_>>(
      hri_msgs_msg_dds__IdsList__desc, name, profile);
}

template <>
std::unique_ptr<MessageType> ros2_type<ros2::Text>(const std::string& name, Profile profile) {
  return std::make_unique<RosType<ros2::Text, std_msgs_msg_dds__String_>>(
      std_msgs_msg_dds__String__desc, name, profile);
}

}  // namespace handsel
