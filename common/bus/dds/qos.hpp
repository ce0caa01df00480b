// What each QoS profile of the table of topics means to Cyclone DDS. Nowhere else is a QoS set.
// Ownership is shared everywhere: under exclusive ownership a stronger writer hides the rightful one, and anybody may be stronger. Which
// writer counts is decided by common/bus/writer_pin.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <dds/dds.h>

#include "common/topics/topics.hpp"

namespace handsel {

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

/// A health lease shorter than this gives false alarms on a loaded machine.
inline constexpr dds_duration_t kHealthLease = DDS_MSECS(300);

Qos reader_qos(const TopicRow& row);
/// Of a reader that must not hold up a writer, however slow or stopped it is: nothing is kept for it beyond the last samples.
Qos observer_qos(const TopicRow& row);
/// As observer_qos, for who wants all there is: the last 256 of each instance are kept.
Qos recorder_qos(const TopicRow& row);
Qos writer_qos(const TopicRow& row);
Qos topic_qos(const TopicRow& row);
/// Each policy for which a writer that offers this is not matched with a reader that requests that: "DEADLINE is none, asked for is 0.2 s
/// or shorter".
std::vector<std::string> why_unmatched(const dds_qos_t* offered, const dds_qos_t* requested);

}  // namespace handsel
