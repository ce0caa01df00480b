// SPDX-License-Identifier: Apache-2.0
#include "common/bus/dds/domain_view.hpp"

#include <cstdlib>
#include <cstring>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "common/bus/dds/discovered_domain.hpp"
#include "common/bus/dds/qos.hpp"
#include "common/messages/robot.hpp"
#include "common/topics/topics.hpp"

namespace handsel {
namespace {

constexpr std::int32_t kMaxTaken = 256;  // samples at a time

/// Calls a function with every living sample of a builtin topic.
template <class Sample, class Visit>
void each(dds_entity_t participant, dds_entity_t topic, Visit visit) {
  const dds_entity_t reader = dds_create_reader(participant, topic, nullptr, nullptr);
  if (reader < 0) return;
  dds_return_t n = 0;
  do {
    void* samples[kMaxTaken] = {};
    dds_sample_info_t infos[kMaxTaken];
    n = dds_take(reader, samples, infos, kMaxTaken, kMaxTaken);
    for (dds_return_t i = 0; i < n; ++i)
      if (infos[i].valid_data && infos[i].instance_state == DDS_IST_ALIVE)
        visit(*static_cast<const Sample*>(samples[i]));
    if (n > 0) dds_return_loan(reader, samples, n);
  } while (n == kMaxTaken);
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

dds_entity_t endpoints_topic(bool writes) {
  return writes ? DDS_BUILTIN_TOPIC_DCPSPUBLICATION : DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION;
}

/// Which participants belong to the system of a partition: those with an endpoint there that meets
/// one of another participant.
class Systems {
 public:
  explicit Systems(dds_entity_t participant) {
    std::map<End, std::set<std::string>> owners;
    for (const bool writes : {true, false})
      each<dds_builtintopic_endpoint_t>(
          participant, endpoints_topic(writes), [&](const dds_builtintopic_endpoint_t& sample) {
            owners[{writes, sample.topic_name, partitions(sample.qos)}].insert(
                key_of(sample.participant_key));
          });
    for (const auto& [end, here] : owners) {
      const auto& [writes, topic, names] = end;
      const auto there = owners.find({!writes, topic, names});
      if (there == owners.end()) continue;
      for (const std::string& owner : here)
        if (there->second.size() > there->second.count(owner)) members_.insert({owner, names});
    }
  }
  /// Returns whether the endpoint's participant belongs to the system of its partition.
  bool have(const dds_builtintopic_endpoint_t& endpoint) const {
    return members_.contains({key_of(endpoint.participant_key), partitions(endpoint.qos)});
  }

 private:
  using End = std::tuple<bool, std::string, std::vector<std::string>>;  // writes, topic, partitions
  std::set<std::pair<std::string, std::vector<std::string>>> members_;
};

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
  const Systems systems(participant);
  for (const bool writes : {true, false}) {
    each<dds_builtintopic_endpoint_t>(
        participant, endpoints_topic(writes), [&](const dds_builtintopic_endpoint_t& sample) {
          const DomainParticipant& owner = known[key_of(sample.participant_key)];
          const TopicRow* row = find_topic(sample.topic_name);
          // A process that meets nobody in its partition has chosen the partition wrongly.
          if (row != nullptr && is_of_other_system(sample.qos, *row, owner.component) &&
              systems.have(sample))
            return;
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
