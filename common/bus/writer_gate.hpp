// SPDX-License-Identifier: Apache-2.0
// Keeps the samples of a second writer out of a DDS reader's cache, where they would replace those
// of the accepted writer.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include <dds/dds.h>

#include "common/bus/intake.hpp"

namespace handsel {

class WriterGate {
 public:
  /// Sets the filter of a topic entity that no reader uses yet. `on_refusal` is called on a thread
  /// of the transport, at most every 5 ms, so that the executor calls hear().
  void filter(dds_entity_t topic, std::function<void()> on_refusal);
  /// Lets only samples of `writer` pass from now on; 0: all.
  void open_for(std::uint64_t writer) { pinned_.store(writer, std::memory_order_release); }
  /// Reports the refusals since the last call to the intake, which may accept the refused writer
  /// from now on. On the executor.
  void report_refusals(Intake& intake, TimePoint now);

 private:
  static bool passes(const dds_sample_info_t* info, void* self);

  std::function<void()> on_refusal_;
  std::atomic<std::uint64_t> pinned_{0}, refused_writer_{0}, refused_{0};
  std::atomic<std::int64_t> next_call_{0};  // [ns] on the monotonic clock
};

}  // namespace handsel
