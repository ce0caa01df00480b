// SPDX-License-Identifier: Apache-2.0
#include "common/bus/dds/qos.hpp"

#include <cmath>
#include <cstdio>

#include "common/bus/dds/dds_defaults.hpp"
#include "common/bus/foreign.hpp"

namespace handsel {
namespace {

constexpr int kKeepAllBound = 64;
constexpr int kInstances = 64;

struct Meaning {
  bool reliable;
  bool transient_local;
  int depth;  // 0: keep all, bounded
};

constexpr Meaning meaning(Profile profile) {
  switch (profile) {
    case Profile::sensor:
      return {false, false, 1};
    case Profile::state:
      return {true, true, 1};
    case Profile::command:
      return {true, false, 8};
    case Profile::latch:
      return {true, true, 1};
    case Profile::goal:
      return {true, false, 8};
    case Profile::advice:
    case Profile::health:
      return {true, false, 1};
    case Profile::setpoint:
      return {false, false, 32};
    case Profile::request:
    case Profile::reply:
      return {true, false, 0};
  }
  return {true, false, 1};
}

Qos common(const TopicRow& row) {
  const Meaning m = meaning(row.profile);
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(qos.get(),
                       m.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_durability(qos.get(),
                      m.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (m.depth > 0) {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, m.depth);
    dds_qset_resource_limits(qos.get(), kInstances * m.depth, kInstances, m.depth);
  } else {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
    dds_qset_resource_limits(qos.get(), kKeepAllBound, 1, kKeepAllBound);
  }
  dds_qset_ownership(qos.get(), DDS_OWNERSHIP_SHARED);
  if (row.deadline > 0)
    dds_qset_deadline(qos.get(), static_cast<dds_duration_t>(std::llround(row.deadline * 1e9)));
  dds_qset_destination_order(qos.get(), DDS_DESTINATIONORDER_BY_RECEPTION_TIMESTAMP);
  const bool apart = in_table(row) && !is_of_all_systems(row);
  if (const std::string system = system_name(); !system.empty() && apart)
    dds_qset_partition1(qos.get(), system.c_str());
  if (row.profile == Profile::health)
    dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC, kHealthLease);
  return qos;
}

std::string in_seconds(dds_duration_t d) {
  if (d == DDS_INFINITY) return "none";
  char text[40];
  std::snprintf(text, sizeof text, "%g s", static_cast<double>(d) * 1e-9);
  return text;
}

}  // namespace

std::vector<std::string> partitions(const dds_qos_t* qos) {
  std::vector<std::string> out;
  std::uint32_t n = 0;
  char** names = nullptr;
  if (!dds_qget_partition(qos, &n, &names)) return out;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (names[i][0] != '\0') out.emplace_back(names[i]);
    dds_free(names[i]);
  }
  dds_free(names);
  return out;
}

std::vector<std::string> why_unmatched(const dds_qos_t* offered, const dds_qos_t* requested) {
  std::vector<std::string> out;
  const auto text = [&](const char* policy, const std::string& has, const std::string& wants) {
    out.push_back(std::string(policy) + " is " + has + ", asked for is " + wants);
  };
  dds_reliability_kind_t r_offered = DDS_RELIABILITY_RELIABLE,
                         r_requested = DDS_RELIABILITY_BEST_EFFORT;
  dds_qget_reliability(offered, &r_offered, nullptr);
  dds_qget_reliability(requested, &r_requested, nullptr);
  if (r_offered < r_requested) text("RELIABILITY", "best effort", "reliable");
  dds_durability_kind_t d_offered = DDS_DURABILITY_VOLATILE, d_requested = DDS_DURABILITY_VOLATILE;
  dds_qget_durability(offered, &d_offered);
  dds_qget_durability(requested, &d_requested);
  if (d_offered < d_requested) text("DURABILITY", "volatile", "transient local");
  dds_duration_t offered_time = DDS_INFINITY, requested_time = DDS_INFINITY;
  dds_qget_deadline(offered, &offered_time);
  dds_qget_deadline(requested, &requested_time);
  if (offered_time > requested_time)
    text("DEADLINE", in_seconds(offered_time), in_seconds(requested_time) + " or shorter");
  offered_time = requested_time = 0;
  dds_qget_latency_budget(offered, &offered_time);
  dds_qget_latency_budget(requested, &requested_time);
  if (offered_time > requested_time)
    text("LATENCY_BUDGET", in_seconds(offered_time), in_seconds(requested_time) + " or shorter");
  dds_ownership_kind_t o_offered = DDS_OWNERSHIP_SHARED, o_requested = DDS_OWNERSHIP_SHARED;
  dds_qget_ownership(offered, &o_offered);
  dds_qget_ownership(requested, &o_requested);
  const auto owner = [](dds_ownership_kind_t kind) {
    return kind == DDS_OWNERSHIP_SHARED ? "shared" : "exclusive";
  };
  if (o_offered != o_requested) text("OWNERSHIP", owner(o_offered), owner(o_requested));
  dds_liveliness_kind_t l_offered = DDS_LIVELINESS_AUTOMATIC,
                        l_requested = DDS_LIVELINESS_AUTOMATIC;
  offered_time = requested_time = DDS_INFINITY;
  dds_qget_liveliness(offered, &l_offered, &offered_time);
  dds_qget_liveliness(requested, &l_requested, &requested_time);
  if (l_offered < l_requested) text("LIVELINESS", "automatic", "manual");
  if (offered_time > requested_time)
    text("LIVELINESS", "a lease of " + in_seconds(offered_time),
         in_seconds(requested_time) + " or shorter");
  dds_destination_order_kind_t s_offered = DDS_DESTINATIONORDER_BY_RECEPTION_TIMESTAMP,
                               s_requested = s_offered;
  dds_qget_destination_order(offered, &s_offered);
  dds_qget_destination_order(requested, &s_requested);
  if (s_offered < s_requested) text("DESTINATION_ORDER", "by reception", "by source");
  const auto ours = partitions(requested), theirs = partitions(offered);
  if (ours != theirs)
    text("PARTITION", theirs.empty() ? "none" : "\"" + theirs.front() + "\"",
         ours.empty() ? "none" : "\"" + ours.front() + "\"");
  return out;
}

Qos reader_qos(const TopicRow& row) {
  Qos qos = common(row);
  if (in_table(row))
    dds_qset_type_consistency(qos.get(), DDS_TYPE_CONSISTENCY_DISALLOW_TYPE_COERCION, false, false,
                              false, false, true);
  return qos;
}

Qos observer_qos(const TopicRow& row) {
  Qos qos = reader_qos(row);
  dds_qset_deadline(qos.get(), DDS_INFINITY);
  dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC, DDS_INFINITY);
  if (meaning(row.profile).depth > 0) return qos;
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kKeepAllBound);
  return qos;
}

Qos recorder_qos(const TopicRow& row) {
  constexpr int kMany = 256;
  Qos qos = observer_qos(row);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kMany);
  dds_qset_resource_limits(qos.get(), kInstances * kMany, kInstances, kMany);
  return qos;
}

Qos writer_qos(const TopicRow& row) {
  const Meaning m = meaning(row.profile);
  Qos qos = common(row);
  if (m.transient_local)
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, 1, kInstances, kInstances, 1);
  dds_qset_writer_data_lifecycle(qos.get(), true);
  return qos;
}

Qos topic_qos(const TopicRow& row) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(
      qos.get(),
      meaning(row.profile).reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, 0);
  return qos;
}

bool is_of_other_system(const dds_qos_t* endpoint, const TopicRow& row,
                        const std::string& component) {
  return !component.empty() && partitions(endpoint) != partitions(reader_qos(row).get());
}

}  // namespace handsel
