// Samples to and from the bytes they have on the wire, without a network: for recordings.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/wire/message_type.hpp"

namespace handsel {

/// One at a time in a process. Not for several threads.
class CdrCodec {
 public:
  /// Throws MissingError when the transport refuses.
  CdrCodec();
  ~CdrCodec();

  /// The serialised sample with its encapsulation header. `wire` is of the type; empty when it does not fit its bounds.
  std::vector<std::uint8_t> encode(const MessageType& type, const void* wire);
  /// Into `wire`, which is of the type and reused; its values are not judged. False for bytes that are no such sample.
  bool decode(const MessageType& type, const std::vector<std::uint8_t>& cdr, void* wire);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handsel
