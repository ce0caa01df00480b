// What the bus knows about a message type: its topic, its IDL type and how to go to and fro. The customs office of the system.
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

/// A leaf of a wire sample while it is visited, for a hash over all of them and for tests that damage samples field by field.
struct WireLeaf {
  enum class Kind { number, integer, choice, text, flag };
  Kind kind{};
  void* value{};       ///< double*, the integer, the IDL enum, char*, bool*
  std::size_t size{};  ///< [bytes] of the value
  const WireIo* visitor{};
  const char* field{};

  std::string path() const;  ///< "position[3]"; put together when asked for, for a map has 10^5 leaves
};

/// Elements of lists that were left out of a sample when it was read.
struct LeftOutElements {
  std::uint64_t count{};
  std::string why;  ///< of the first one: field and what is wrong, one sentence
};

/// Conversion of one message between its domain struct and its IDL struct. Both are passed as untyped pointers to the right struct.
class MessageType {
 public:
  virtual ~MessageType() = default;

  virtual const TopicRow& row() const = 0;
  /// dds_topic_descriptor_t of the IDL struct.
  virtual const void* descriptor() const = 0;

  /// Domain -> IDL. False, with one sentence that names message and field in `why`, when the message breaks its contract.
  /// A stamp of 0 becomes `now`. `wire` is reused: its buffers grow and stay.
  virtual bool to_wire(const void* message, Stamp now, void* wire, std::string& why) const = 0;
  /// IDL -> domain, validated; `message` is reused and undefined after a rejection.
  bool from_wire(const void* wire, void* message, std::string& why) const {
    LeftOutElements left_out;
    return from_wire(wire, message, why, left_out);
  }
  /// Of an observation, malformed elements of a list are left out singly and counted (idl/README.md); every other message is accepted or
  /// rejected whole.
  virtual bool from_wire(const void* wire, void* message, std::string& why, LeftOutElements& left_out) const = 0;
  virtual Stamp stamp(const void* wire) const = 0;
  virtual void set_stamp(void* wire, Stamp stamp) const = 0;
  /// Value of the key field; empty for topics without key.
  virtual std::string_view key(const void* wire) const = 0;
  virtual std::string to_json(const void* message) const = 0;
  /// Calls with every leaf value of the sample.
  virtual void leaves(void* wire, const std::function<void(const WireLeaf&)>& visit) const = 0;
  /// For tests: a valid sample with two elements a list, or one with every list and text at its bound.
  virtual void fill(void* wire, bool full) const = 0;

  /// Zeroed IDL sample with its buffers' deleter; default domain message.
  virtual std::shared_ptr<void> new_wire() const = 0;
  virtual std::shared_ptr<void> new_message() const = 0;
};

/// Defined for every message of the table.
template <class M>
const MessageType& message_type();
#define HANDSEL_ROW(type, topic, ...) \
  template <>                         \
  const MessageType& message_type<type>();
HANDSEL_TOPICS(HANDSEL_ROW)
#undef HANDSEL_ROW

/// In the order of the table.
const MessageType& message_type(std::size_t index);
/// By type or topic name; nullptr if there is none.
const MessageType* find_message_type(std::string_view type_or_topic);

/// One line of JSON: field names of the domain struct, enumerators by name, poses as {"p": [x,y,z], "q": [x,y,z,w]}.
template <class M>
std::string to_json(const M& message) {
  return message_type<M>().to_json(&message);
}

}  // namespace handsel
