// SPDX-License-Identifier: Apache-2.0
// Participants and endpoints of a DDS domain as the transport reports them, foreign processes
// included.
#pragma once

#include <string>
#include <vector>

namespace handsel {

/// A process on the domain, as its participant announces it.
struct DomainParticipant {
  std::string component;      ///< entity name: the component of a Handsel process; may be empty
  std::string process, host;  ///< name of its executable and of its machine; empty: not announced
  int pid{0};                 ///< on its host; 0: not announced
};

/// A writer or reader of a topic.
struct DomainEndpoint {
  bool writes{};            ///< true: a writer; false: a reader
  std::string topic, type;  ///< as the transport names them
  /// Participant the endpoint belongs to; its fields are empty when unknown.
  DomainParticipant owner;
  /// On a topic of the table: QoS policies that do not match the components', one sentence each.
  std::vector<std::string> unmatched;
};

/// Result of DdsBus::discovered_domain().
struct DomainView {
  std::vector<DomainParticipant> participants;  ///< all discovered so far, the asking one included
  std::vector<DomainParticipant> commanders;    ///< one for each living writer of set-points
  /// Of others than the asking one, without the transport's own.
  std::vector<DomainEndpoint> endpoints;
};

}  // namespace handsel
