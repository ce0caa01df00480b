// SPDX-License-Identifier: Apache-2.0
// Descriptions of the parts that messages of several subjects share, and what turns a description
// into a MessageType.
#pragma once

#include <cmath>

#include "common/base/errors.hpp"
#include "common/messages/perception.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "common/wire/wire_io.hpp"
#include "idl/perception.h"
#include "idl/planning.h"
#include "idl/trajectory.h"
#include "idl/world.h"

namespace handsel {

using Text = WireIo::Text;

/// Texts that are too long are cut when sent.
void describe(WireIo& io, Refusal& m, handsel_Refusal& w);
void describe(WireIo& io, Segment& m, handsel_Segment& w);  ///< duration [0, 1e4] s, |jerk| <= 1e9
void describe(WireIo& io, AxisTrajectory& m, handsel_AxisTrajectory& w);  ///< at most 4096 segments
/// At most 64 axes of equal duration (1e-6 s).
void describe(WireIo& io, Trajectory& m, handsel_SoftMotion& w);
void describe(WireIo& io, Attachment& m, handsel_Attachment& w);  ///< object and hand may be empty
void describe(WireIo& io, RequestId& m, handsel_RequestId& w);    ///< any numbers
void describe(WireIo& io, Primitive& m, handsel_Primitive& w);    ///< extents [0, 1e4] m
void describe(WireIo& io, MovingPart& m, handsel_MovingPart& w);  ///< radius [0, 100] m
void describe(WireIo& io, Coverage& m, handsel_Coverage& w);      ///< no extent below 0
void describe(WireIo& io, BodyJoint& m, handsel_BodyJoint& w);    ///< needs a name; age [0, 1e9] s
/// Needs an id; at most 64 joints; stature [0.3, 3] m.
void describe(WireIo& io, Person& m, handsel_Person& w);

/// Describes the field `allowed_contacts`: at most 32 names, none empty.
inline void describe_contacts(WireIo& io, std::vector<std::string>& m, dds_sequence_string64& w) {
  io.texts("allowed_contacts", m, w, 32);
}

/// Describes one point of a path: a struct of its own on the wire, a vector in the domain.
void describe(WireIo& io, Vector& m, handsel_AxisPoint& w);

/// Returns whether all points have the same number of axes; true for none.
inline bool equally_wide(const std::vector<Vector>& points) {
  for (const Vector& p : points)
    if (p.size() != points.front().size()) return false;
  return true;
}

/// Binds a description to the untyped interface the bus uses. W has a field `stamp`.
template <class M, class W>
class DescribedType final : public MessageType {
 public:
  using Key = std::string_view (*)(const W&);
  DescribedType(const dds_topic_descriptor_t& description, Key key_of)
      : descriptor_(description), key_(key_of) {}

  const TopicRow& row() const override { return TopicOf<M>::row; }
  const void* descriptor() const override { return &descriptor_; }
  bool to_wire(const void* message, Stamp now, void* wire, std::string& why) const override {
    WireIo io = WireIo::to_wire(row().type, now, why);
    // Sending only reads the message.
    describe(io, *const_cast<M*>(static_cast<const M*>(message)), *static_cast<W*>(wire));
    return io.ok();
  }
  using MessageType::from_wire;
  bool from_wire(const void* wire, void* message, std::string& why,
                 LeftOutElements& left_out) const override {
    WireIo io = WireIo::from_wire(row().type, why, &left_out);
    describe(io, *static_cast<M*>(message), *const_cast<W*>(static_cast<const W*>(wire)));
    return io.ok();
  }
  Stamp stamp(const void* wire) const override { return static_cast<const W*>(wire)->stamp; }
  void set_stamp(void* wire, Stamp stamp) const override { static_cast<W*>(wire)->stamp = stamp; }
  std::string_view key(const void* wire) const override {
    return key_ ? key_(*static_cast<const W*>(wire)) : std::string_view();
  }
  std::string to_json(const void* message) const override {
    std::string out;
    W none{};
    WireIo io = WireIo::json(out);
    io.begin();
    describe(io, *const_cast<M*>(static_cast<const M*>(message)), none);
    io.end();
    return out;
  }
  void leaves(void* wire, const std::function<void(const WireLeaf&)>& visit) const override {
    M none{};
    WireIo io = WireIo::leaves(visit);
    describe(io, none, *static_cast<W*>(wire));
  }
  void fill(void* wire, bool full) const override {
    M none{};
    WireIo io = WireIo::fill(full);
    describe(io, none, *static_cast<W*>(wire));
  }
  std::shared_ptr<void> new_wire() const override {
    void* sample = dds_alloc(sizeof(W));
    std::memset(sample, 0, sizeof(W));
    return {sample, [d = &descriptor_](void* s) { dds_sample_free(s, d, DDS_FREE_ALL); }};
  }
  std::shared_ptr<void> new_message() const override { return std::make_shared<M>(); }

 private:
  const dds_topic_descriptor_t& descriptor_;
  Key key_;
};

}  // namespace handsel

/// Defines message_type<M>() for the IDL struct of the same name.
#define HANDSEL_WIRE(M)                                                           \
  template <>                                                                     \
  const MessageType& message_type<M>() {                                          \
    static const DescribedType<M, handsel_##M> type(handsel_##M##_desc, nullptr); \
    return type;                                                                  \
  }
#define HANDSEL_WIRE_KEYED(M, KEY)                                                         \
  template <>                                                                              \
  const MessageType& message_type<M>() {                                                   \
    static const DescribedType<M, handsel_##M> type(                                       \
        handsel_##M##_desc, [](const handsel_##M& w) { return std::string_view(w.KEY); }); \
    return type;                                                                           \
  }
