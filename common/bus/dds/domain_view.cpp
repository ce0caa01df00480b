// SPDX-License-Identifier: Apache-2.0
#include "common/bus/dds/domain_view.hpp"

#include <cstdlib>
#include <cstring>
#include <map>

#include "common/bus/dds/discovered_domain.hpp"
#include "common/bus/dds/qos.hpp"
#include "common/messages/robot.hpp"
#include "common/topics/topics.hpp"

namespace handsel {
namespace {

constexpr std::int32_t kMaxRead = 256;

/// Calls a function with every living sample of a builtin topic.
template <class Sample, class Visit>
void each(dds_entity_t participant, dds_entity_t topic, Visit visit) {
  const dds_entity_t reader = dds_create_reader(participant, topic, nullptr, nullptr);
  if (reader < 0) return;
  void* samples[kMaxRead] = {};
  dds_sample_info_t infos[kMaxRead];
  const dds_return_t n = dds_read(reader, samples, infos, kMaxRead, kMaxRead);
  for (dds_return_t i = 0; i < n; ++i)
    if (infos[i].valid_data && infos[i].instance_state == DDS_IST_ALIVE)
      visit(*static_cast<const Sample*>(samples[i]));
  if (n > 0) dds_return_loan(reader, samples, n);
  dds_delete(reader);
}

std::string taken(char* text) {
  std::string copy = text ? text : "";
  dds_free(text);
  return copy;
}

std::string property(const dds_qos_t* qos, const char* name) {
  char* value = nullptr;
  return dds_qget_prop(qos, name, &value) ? taken(value) : std::string();
}

std::string key_of(const dds_guid_t& guid) {
  return {reinterpret_cast<const char*>(guid.v), sizeof guid.v};
}

}  // namespace

DomainParticipant described(const dds_qos_t* qos) {
  DomainParticipant out;
  char* name = nullptr;
  if (dds_qget_entity_name(qos, &name)) out.component = taken(name);
  out.process = property(qos, "__ProcessName");
  out.host = property(qos, "__Hostname");
  out.pid = std::atoi(property(qos, "__Pid").c_str());
  return out;
}

DomainView discovered_domain(dds_entity_t participant) {
  std::map<std::string, DomainParticipant> known;
  each<dds_builtintopic_participant_t>(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT,
                                       [&](const dds_builtintopic_participant_t& sample) {
                                         known[key_of(sample.key)] = described(sample.qos);
                                       });
  DomainView view;
  for (const auto& [key, one] : known) view.participants.push_back(one);
  dds_guid_t self{};
  dds_get_guid(participant, &self);
  for (const bool writes : {true, false}) {
    const dds_entity_t topic =
        writes ? DDS_BUILTIN_TOPIC_DCPSPUBLICATION : DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION;
    each<dds_builtintopic_endpoint_t>(
        participant, topic, [&](const dds_builtintopic_endpoint_t& sample) {
          const DomainParticipant& owner = known[key_of(sample.participant_key)];
          const TopicRow* row = find_topic(sample.topic_name);
          if (row != nullptr && is_of_other_system(sample.qos, *row, owner.component)) return;
          if (writes && std::strcmp(sample.topic_name, TopicOf<JointCommand>::row.topic) == 0)
            view.commanders.push_back(owner);
          if (key_of(sample.participant_key) == key_of(self)) return;
          DomainEndpoint endpoint{writes,
                                  sample.topic_name,
                                  sample.type_name,
                                  known[key_of(sample.participant_key)],
                                  {}};
          if (row != nullptr) {
            const Qos ours = writes ? reader_qos(*row) : writer_qos(*row);
            endpoint.unmatched = writes ? why_unmatched(sample.qos, ours.get())
                                        : why_unmatched(ours.get(), sample.qos);
          }
          view.endpoints.push_back(std::move(endpoint));
        });
  }
  return view;
}

}  // namespace handsel
