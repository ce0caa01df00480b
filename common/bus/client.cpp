// SPDX-License-Identifier: Apache-2.0
#include "common/bus/client.h"

#include <dlfcn.h>

#include <cstdio>
#include <exception>
#include <filesystem>

#include "common/bus/dds/dds_defaults.hpp"
#include "common/bus/dds/qos.hpp"
#include "idl/attention.h"
#include "idl/execution.h"
#include "idl/perception.h"
#include "idl/planning.h"
#include "idl/robot.h"
#include "idl/system.h"
#include "idl/task.h"
#include "idl/world.h"

namespace handsel {
namespace {

#define HANDSEL_ROW(type, topic, profile, rate, deadline, largest, writers, readers) \
  handsel_topic{#type,   "handsel/" topic, rate,    deadline,                        \
                largest, writers,          readers, &handsel_##type##_desc},
const handsel_topic kClientTopics[] = {HANDSEL_TOPICS(HANDSEL_ROW)};
#undef HANDSEL_ROW

const TopicRow* row_of(const char* topic) {
  const TopicRow* row = topic ? find_topic(topic) : nullptr;
  if (!row) std::fprintf(stderr, "handsel: there is no topic \"%s\"\n", topic ? topic : "");
  return row;
}

/// Returns the DDS folder of the installed tree that contains this library; the folder may be
/// missing if the library was not installed.
std::filesystem::path dds_folder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&handsel_participant), &info) == 0 || !info.dli_fname)
    return {};
  std::error_code error;
  return std::filesystem::canonical(info.dli_fname, error).parent_path().parent_path() /
         "share/handsel/dds";
}

dds_entity_t checked(dds_entity_t entity, const char* what, const char* topic) {
  if (entity < 0)
    std::fprintf(stderr, "handsel: no %s of %s: %s\n", what, topic, dds_strretcode(-entity));
  return entity;
}

using MakeEnd = dds_entity_t (*)(dds_entity_t, dds_entity_t, const dds_qos_t*,
                                 const dds_listener_t*);

dds_entity_t endpoint(dds_entity_t participant, const char* topic, Qos (*qos)(const TopicRow&),
                      MakeEnd make, const char* what) {
  const TopicRow* row = row_of(topic);
  if (!row) return DDS_RETCODE_BAD_PARAMETER;
  const Qos of_topic = topic_qos(*row);
  const dds_entity_t entity =
      checked(dds_create_topic(participant, kClientTopics[row - kTopics].descriptor, row->topic,
                               of_topic.get(), nullptr),
              "topic", row->topic);
  if (entity < 0) return entity;
  const Qos of_end = qos(*row);
  return checked(make(participant, entity, of_end.get(), nullptr), what, row->topic);
}

}  // namespace
}  // namespace handsel

using namespace handsel;

const handsel_topic* handsel_topics(size_t* count) {
  *count = std::size(kClientTopics);
  return kClientTopics;
}

const handsel_topic* handsel_find_topic(const char* topic) {
  const TopicRow* row = topic ? find_topic(topic) : nullptr;
  return row ? &kClientTopics[row - kTopics] : nullptr;
}

dds_qos_t* handsel_topic_qos(const char* topic) {
  const TopicRow* row = topic ? find_topic(topic) : nullptr;
  if (!row) return nullptr;
  Qos qos = writer_qos(*row);
  const Qos of_reader = reader_qos(*row);
  dds_merge_qos(qos.get(), of_reader.get());
  return qos.release();
}

dds_entity_t handsel_participant(const char* component) {
  try {
    use_dds_configuration(dds_folder());
    const Qos qos(dds_create_qos(), &dds_delete_qos);
    dds_qset_entity_name(qos.get(), component);
    const int domain = default_domain();
    return checked(dds_create_participant(static_cast<dds_domainid_t>(domain), qos.get(), nullptr),
                   "participant", ("domain " + std::to_string(domain)).c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "handsel: %s\n", error.what());
    return DDS_RETCODE_BAD_PARAMETER;
  }
}

dds_entity_t handsel_writer(dds_entity_t participant, const char* topic) {
  return endpoint(
      participant, topic, [](const TopicRow& row) { return writer_qos(row); }, &dds_create_writer,
      "writer");
}

dds_entity_t handsel_reader(dds_entity_t participant, const char* topic) {
  return endpoint(participant, topic, &observer_qos, &dds_create_reader, "reader");
}
