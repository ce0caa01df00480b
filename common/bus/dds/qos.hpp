// SPDX-License-Identifier: Apache-2.0
// What each QoS profile of the table of topics means to Cyclone DDS. Nowhere else is a QoS set.
// Ownership is shared everywhere: under exclusive ownership a stronger writer hides the rightful
// one, and anybody may be stronger. Which writer counts is decided by common/bus/writer_pin.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <dds/dds.h>

#include "common/topics/topics.hpp"

namespace handsel {

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

/// After a lease without a sign of life a process counts as ended, which must be within a second.
/// A shorter lease costs processor time: each process sends several signs of life a lease to every
/// other one.
inline constexpr dds_duration_t kHealthLease = DDS_MSECS(800);

/// Returns the QoS of a component's reader; the types must be equal on topics of the table.
Qos reader_qos(const TopicRow& row);
/// Returns the QoS of a reader that never blocks a writer, even when stopped: nothing is kept for
/// that reader beyond the last samples, and neither deadline nor lease is requested.
Qos observer_qos(const TopicRow& row);
/// Returns observer_qos() with the last 256 samples of each instance kept, for recordings.
Qos recorder_qos(const TopicRow& row);
/// Returns the QoS of a component's writer; it disposes its instances when it is deleted.
Qos writer_qos(const TopicRow& row);
/// Returns the QoS of a topic entity: reliability only, the rest stands at readers and writers.
Qos topic_qos(const TopicRow& row);
/// Returns the names of the partitions that are not empty.
std::vector<std::string> partitions(const dds_qos_t* qos);
/// Returns whether an endpoint of a topic belongs to a system of another name: to a process that is
/// a component, in another partition. `component`: of the process; empty: none.
bool is_of_other_system(const dds_qos_t* endpoint, const TopicRow& row,
                        const std::string& component);
/// Returns each policy for which a writer that offers this is not matched with a reader that
/// requests that: "DEADLINE is none, asked for is 0.2 s or shorter".
std::vector<std::string> why_unmatched(const dds_qos_t* offered, const dds_qos_t* requested);

}  // namespace handsel
