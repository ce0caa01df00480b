// SPDX-License-Identifier: Apache-2.0
#include "common/bus/writer_gate.hpp"

#include "common/base/errors.hpp"
#include "common/bus/executor.hpp"

namespace handsel {
namespace {
constexpr Duration kCallPeriod = std::chrono::milliseconds(5);
}  // namespace

void WriterGate::filter(dds_entity_t topic, std::function<void()> on_refusal) {
  on_refusal_ = std::move(on_refusal);
  dds_topic_filter filter{};
  filter.mode = DDS_TOPIC_FILTER_SAMPLEINFO_ARG;
  filter.f.sampleinfo_arg = &WriterGate::passes;
  filter.arg = this;
  const dds_return_t result = dds_set_topic_filter_extended(topic, &filter);
  if (result != DDS_RETCODE_OK)
    throw MissingError(std::string("DDS: filter of a topic: ") + dds_strretcode(-result));
}

bool WriterGate::passes(const dds_sample_info_t* info, void* self) {
  WriterGate& gate = *static_cast<WriterGate*>(self);
  const std::uint64_t pinned = gate.pinned_.load(std::memory_order_acquire);
  if (pinned == 0 || info->publication_handle == pinned) return true;
  gate.refused_.fetch_add(1, std::memory_order_relaxed);
  gate.refused_writer_.store(info->publication_handle, std::memory_order_release);
  const std::int64_t now = monotonic_now().time_since_epoch().count();
  std::int64_t next = gate.next_call_.load(std::memory_order_relaxed);
  if (now >= next && gate.next_call_.compare_exchange_strong(next, now + kCallPeriod.count(),
                                                             std::memory_order_relaxed))
    gate.on_refusal_();
  return false;
}

void WriterGate::report_refusals(Intake& intake, TimePoint now) {
  const std::uint64_t writer = refused_writer_.exchange(0, std::memory_order_acq_rel);
  if (writer == 0) return;
  intake.count_refused(refused_.exchange(0, std::memory_order_relaxed));
  intake.contend(writer, now);
  open_for(intake.pinned());
}

}  // namespace handsel
