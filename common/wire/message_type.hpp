// SPDX-License-Identifier: Apache-2.0
// What the bus knows about a message type: its topic, its IDL type and the validated conversions
// between domain and wire.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "common/base/time.hpp"
#include "common/topics/topics.hpp"

namespace handsel {

class WireIo;

/// A leaf of a wire sample while it is visited, for a hash over all of them and for tests that
/// damage samples field by field.
struct WireLeaf {
  enum class Kind { number, integer, choice, text, flag };
  Kind kind{};              ///< type behind `value`
  void* value{};            ///< double*, the integer, the IDL enum, char*, bool*
  std::size_t size{};       ///< [bytes] of the value
  const WireIo* visitor{};  ///< visitor in which the leaf is open; valid during the visit only
  const char* field{};      ///< name of the innermost field; null in a list of bytes

  /// Returns e.g. "position[3]"; composed on demand, as a map has 10^5 leaves.
  std::string path() const;
};

/// Elements of lists that were left out of a sample when it was read.
struct LeftOutElements {
  std::uint64_t count{};  ///< 0: the sample is complete
  std::string why;        ///< of the first one: field and what is wrong, one sentence
};

/// Converts one message between domain struct and IDL struct, passed as untyped pointers. Types of
/// the table are singletons (message_type()); others, e.g. of ros2_type(), belong to their maker.
class MessageType {
 public:
  virtual ~MessageType() = default;

  /// Returns the topic's row; it lives as long as the type.
  virtual const TopicRow& row() const = 0;
  /// Returns the dds_topic_descriptor_t of the IDL struct.
  virtual const void* descriptor() const = 0;

  /// Converts domain -> IDL. Returns false, with one sentence that names message and field in
  /// `why`, when the message breaks its contract. A stamp of 0 becomes `now`. `wire` is reused: its
  /// buffers grow and stay.
  virtual bool to_wire(const void* message, Stamp now, void* wire, std::string& why) const = 0;
  /// Converts IDL -> domain with validation; false with one sentence in `why` for a malformed
  /// sample; `message` is reused and undefined after a rejection.
  bool from_wire(const void* wire, void* message, std::string& why) const {
    LeftOutElements left_out;
    return from_wire(wire, message, why, left_out);
  }
  /// As above. Malformed elements of HumanObservation and ObjectObservation are left out singly and
  /// added to `left_out` (idl/README.md); every other message is accepted or rejected whole.
  virtual bool from_wire(const void* wire, void* message, std::string& why,
                         LeftOutElements& left_out) const = 0;
  /// Returns the stamp of an IDL sample [ns]; 0: unknown.
  virtual Stamp stamp(const void* wire) const = 0;
  /// Replaces the stamp of an IDL sample [ns].
  virtual void set_stamp(void* wire, Stamp stamp) const = 0;
  /// Returns the value of the key field, valid as long as the sample; empty for topics without key.
  virtual std::string_view key(const void* wire) const = 0;
  /// Returns the message as to_json() below; text that is not valid UTF-8 is cut there.
  virtual std::string to_json(const void* message) const = 0;
  /// Calls with every leaf value of the sample.
  virtual void leaves(void* wire, const std::function<void(const WireLeaf&)>& visit) const = 0;
  /// Fills in a valid sample for tests, with two elements per list (one per list of bytes) or, if
  /// `full`, every list and text at its bound.
  virtual void fill(void* wire, bool full) const = 0;

  /// Returns a zeroed IDL sample whose deleter also frees its buffers.
  virtual std::shared_ptr<void> new_wire() const = 0;
  /// Returns a default-constructed domain message.
  virtual std::shared_ptr<void> new_message() const = 0;
};

/// Returns the one type of a message; defined for every message of the table.
template <class M>
const MessageType& message_type();
#define HANDSEL_ROW(type, topic, ...) \
  template <>                         \
  const MessageType& message_type<type>();
/// Returns the type of the row's message.
HANDSEL_TOPICS(HANDSEL_ROW)
#undef HANDSEL_ROW

/// Returns the type of row `index` of the table.
const MessageType& message_type(std::size_t index);
/// Returns the type by type or topic name; nullptr if there is none.
const MessageType* find_message_type(std::string_view type_or_topic);

/// Returns one line of JSON: field names of the domain struct, enumerators by name, poses as {"p":
/// [x,y,z], "q": [x,y,z,w]}.
template <class M>
std::string to_json(const M& message) {
  return message_type<M>().to_json(&message);
}

}  // namespace handsel
