#include "common/bus/qos.hpp"

#include <cmath>

namespace handsel {
namespace {

constexpr int kKeepAllBound = 64;
constexpr int kInstances = 64;

struct Meaning {
  bool reliable;
  bool transient_local;
  bool exclusive;
  int depth;  // 0: keep all, bounded
};

constexpr Meaning meaning(Profile profile) {
  switch (profile) {
    case Profile::sensor:
      return {false, false, false, 1};
    case Profile::state:
      return {true, true, false, 1};
    case Profile::command:
      return {true, false, true, 8};
    case Profile::latch:
      return {true, true, true, 1};
    case Profile::goal:
      return {true, false, false, 8};
    case Profile::advice:
    case Profile::health:
      return {true, false, false, 1};
    case Profile::setpoint:
      return {false, false, true, 1};
    case Profile::request:
    case Profile::reply:
      return {true, false, false, 0};
  }
  return {true, false, false, 1};
}

Qos common(const TopicRow& row) {
  const Meaning m = meaning(row.profile);
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(qos.get(), m.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_durability(qos.get(), m.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (m.depth > 0) {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, m.depth);
    dds_qset_resource_limits(qos.get(), kInstances * m.depth, kInstances, m.depth);
  } else {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
    dds_qset_resource_limits(qos.get(), kKeepAllBound, 1, kKeepAllBound);
  }
  dds_qset_ownership(qos.get(), m.exclusive ? DDS_OWNERSHIP_EXCLUSIVE : DDS_OWNERSHIP_SHARED);
  if (row.deadline > 0) dds_qset_deadline(qos.get(), static_cast<dds_duration_t>(std::llround(row.deadline * 1e9)));
  dds_qset_destination_order(qos.get(), DDS_DESTINATIONORDER_BY_RECEPTION_TIMESTAMP);
  if (row.profile == Profile::health) dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC, kHealthLease);
  return qos;
}

}  // namespace

Qos reader_qos(const TopicRow& row) {
  Qos qos = common(row);
  dds_qset_type_consistency(qos.get(), DDS_TYPE_CONSISTENCY_DISALLOW_TYPE_COERCION, false, false, false, false, true);
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

Qos writer_qos(const TopicRow& row, int strength) {
  const Meaning m = meaning(row.profile);
  Qos qos = common(row);
  if (m.exclusive) dds_qset_ownership_strength(qos.get(), strength);
  if (m.transient_local) dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, 1, kInstances, kInstances, 1);
  dds_qset_writer_data_lifecycle(qos.get(), true);
  return qos;
}

Qos topic_qos(const TopicRow& row) {
  Qos qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(qos.get(), meaning(row.profile).reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, 0);
  return qos;
}

}  // namespace handsel
