// SPDX-License-Identifier: Apache-2.0
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

  /// Returns the serialised sample with its encapsulation header; empty when `wire`, which is of
  /// the type, exceeds its bounds.
  std::vector<std::uint8_t> encode(const MessageType& type, const void* wire);
  /// Decodes into `wire`, which is of the type and reused; its values are not validated. Returns
  /// false for bytes that are no such sample.
  bool decode(const MessageType& type, const std::vector<std::uint8_t>& cdr, void* wire);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace handsel
