// SPDX-License-Identifier: Apache-2.0
#include "common/bus/dds/writer_discovery.hpp"

#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "common/base/errors.hpp"
#include "common/bus/dds/discovered_domain.hpp"
#include "common/bus/dds/qos.hpp"

namespace handsel {
namespace {

constexpr std::size_t kMaxWriters =
    1024;  // max writers followed; samples of further ones are refused

std::string own_host() {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  return host;
}

/// Returns the start of a process of this host [clock ticks since boot]; 0 if it has ended or is
/// not visible.
std::uint64_t start_of(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  std::getline(file, text);
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return 0;
  std::istringstream fields(text.substr(name_end + 1));
  std::string state, skipped;
  fields >> state;
  if (state == "Z" || state == "X") return 0;
  for (int field = 4; field < 22; ++field) fields >> skipped;
  std::uint64_t start = 0;
  fields >> start;
  return start;
}

std::string hexadecimal(const dds_guid_t& guid) {
  std::string text;
  char digits[3];
  for (const std::uint8_t byte : guid.v) {
    std::snprintf(digits, sizeof digits, "%02x", byte);
    text += digits;
  }
  return text;
}

std::string name_of(const DomainParticipant& owner, const dds_guid_t& participant) {
  std::string name = !owner.component.empty() ? owner.component
                     : !owner.process.empty() ? "process " + owner.process
                                              : "";
  if (name.empty() && owner.pid == 0) return "participant " + hexadecimal(participant);
  if (owner.pid == 0) return name + " (participant " + hexadecimal(participant) + ")";
  return name + (name.empty() ? "" : " ") + "(pid " + std::to_string(owner.pid) + " on host " +
         owner.host + ")";
}

}  // namespace

WriterDiscovery::WriterDiscovery(dds_entity_t participant, std::function<void()> on_news)
    : on_news_(std::move(on_news)) {
  participants_ =
      dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr);
  dds_listener_t* listener = dds_create_listener(this);
  dds_lset_data_available(
      listener, [](dds_entity_t, void* self) { static_cast<WriterDiscovery*>(self)->on_news_(); });
  publications_ =
      dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, listener);
  dds_delete_listener(listener);
  for (const dds_entity_t reader : {participants_, publications_})
    if (reader < 0)
      throw MissingError(std::string("DDS: reader of discovery: ") + dds_strretcode(-reader));
}

WriterDiscovery::~WriterDiscovery() {
  dds_delete(publications_);
  dds_delete(participants_);
}

WriterIdentity WriterDiscovery::identity_of(const dds_builtintopic_endpoint_t& endpoint,
                                            const TopicRow& row) const {
  DomainParticipant owner;
  void* samples[1] = {};
  dds_sample_info_t info{};
  const dds_return_t n =
      dds_read_instance(participants_, samples, &info, 1, 1, endpoint.participant_instance_handle);
  if (n > 0 && info.valid_data)
    owner = described(static_cast<const dds_builtintopic_participant_t*>(samples[0])->qos);
  if (n > 0) dds_return_loan(participants_, samples, n);

  WriterIdentity out;
  out.components = owner.component;
  out.name = name_of(owner, endpoint.participant_key);
  const Qos requested = reader_qos(row);
  out.matches = why_unmatched(endpoint.qos, requested.get()).empty();
  if (owner.pid == getpid() && owner.host == own_host()) {
    out.ended = [] { return false; };
  } else if (const std::uint64_t start =
                 owner.pid > 0 && owner.host == own_host() ? start_of(owner.pid) : 0;
             start != 0) {
    out.ended = [pid = owner.pid, start] { return start_of(pid) != start; };
  }
  return out;
}

void WriterDiscovery::take(
    const std::function<void(std::uint64_t, const TopicRow&, const Found*)>& visit) {
  for (;;) {
    void* samples[1] = {};
    dds_sample_info_t info{};
    const dds_return_t n = dds_take(publications_, samples, &info, 1, 1);
    if (n <= 0) return;
    const std::uint64_t writer = info.instance_handle;
    if (!info.valid_data || info.instance_state != DDS_IST_ALIVE) {
      if (const auto known = writers_.find(writer); known != writers_.end()) {
        const TopicRow& row = *known->second.row;
        writers_.erase(known);
        visit(writer, row, nullptr);
      }
    } else if (const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(samples[0]);
               endpoint.topic_name != nullptr) {
      const TopicRow* row = find_topic(endpoint.topic_name);
      const bool followed =
          row != nullptr && has_one_writer(*row) && std::string(row->topic) == endpoint.topic_name;
      if (followed && (writers_.size() < kMaxWriters || writers_.contains(writer))) {
        Found found{row, identity_of(endpoint, *row)};
        if (!is_of_other_system(endpoint.qos, *row, found.identity.components))
          visit(writer, *row, &(writers_[writer] = std::move(found)));
      }
    }
    dds_return_loan(publications_, samples, n);
  }
}

}  // namespace handsel
