// SPDX-License-Identifier: Apache-2.0
// Samples as they are on the wire, not decoded: for the bridge and for recordings, which pass on
// what was sent.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/base/time.hpp"
#include "common/wire/message_type.hpp"

namespace handsel {

struct RawSample {
  Stamp stamp{};             ///< when it was written [ns, system clock of the writer]
  std::uint64_t instance{};  ///< which value of the key, stable while the reader lives
  bool gone{};               ///< the instance has no writer any more; `cdr` is empty
  /// The serialised sample with its encapsulation header; well-formed, values not validated.
  std::vector<std::uint8_t> cdr;
};

/// Samples kept for a raw reader that does not take them. A raw reader never blocks a writer:
/// requests and replies are read best-effort, and newer samples replace those not taken in time.
enum class RawDepth {
  newest,  ///< the last 64 of a queue, the last 1 or 8 of each instance elsewhere: for viewers
  many,    ///< the last 256 of each instance: for recordings
};

/// Reads one topic until it is destroyed.
class RawReader {
 public:
  virtual ~RawReader() = default;
  /// Takes the oldest waiting sample; false when there is none.
  virtual bool take(RawSample& out) = 0;
};

/// A bus that has serialised samples: DdsBus; LocalBus has none.
class RawBus {
 public:
  virtual ~RawBus() = default;
  /// Creates a reader of serialised samples. On the bus's own thread; the bus must outlive the
  /// reader. Throws MissingError when the transport refuses.
  virtual std::unique_ptr<RawReader> read_raw(const MessageType& type,
                                              RawDepth depth = RawDepth::newest) = 0;
  /// Returns the DDS domain the bus has entered.
  virtual std::uint32_t domain() const = 0;
};

}  // namespace handsel
