// Who is on a DDS domain, as the transport itself tells it: also processes that are not Handsel's.
#pragma once

#include <string>
#include <vector>

namespace handsel {

struct DomainParticipant {
  std::string component;  ///< entity name: the component of a Handsel process; may be empty
  std::string process, host;
  int pid{0};  ///< on its host; 0: not told
};

/// Somebody's writer or reader of a topic.
struct DomainEndpoint {
  bool writes{};
  std::string topic, type;  ///< as the transport names them
  DomainParticipant owner;
  std::vector<std::string> unmatched;  ///< of a topic of the table: policies for which it does not match the components', one sentence each
};

struct DomainView {
  std::vector<DomainParticipant> participants;  ///< all discovered so far, the asking one included
  std::vector<DomainParticipant> commanders;    ///< one for each living writer of set-points
  std::vector<DomainEndpoint> endpoints;        ///< of others than the asking one, without the transport's own
};

}  // namespace handsel
