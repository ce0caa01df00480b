// SPDX-License-Identifier: Apache-2.0
// Follows, by the transport's discovery, the writers of topics with one writer, also those that no
// reader is matched with.
#pragma once

#include <cstdint>
#include <functional>
#include <map>

#include <dds/dds.h>

#include "common/bus/writer_pin.hpp"

namespace handsel {

class WriterDiscovery {
 public:
  struct Found {
    const TopicRow* row{};    ///< topic the writer writes; not null after take()
    WriterIdentity identity;  ///< of the writer's participant, and whether its type and QoS match
  };
  /// `on_news` is called on a thread of the transport when there is something for take(). Throws
  /// MissingError when the transport refuses.
  WriterDiscovery(dds_entity_t participant, std::function<void()> on_news);
  ~WriterDiscovery();
  WriterDiscovery(const WriterDiscovery&) = delete;
  WriterDiscovery& operator=(const WriterDiscovery&) = delete;

  /// Takes the news and calls with each: `found` is null for a writer that is gone.
  void take(const std::function<void(std::uint64_t writer, const TopicRow& row,
                                     const Found* found)>& visit);
  /// Writers known by the last take(), by handle (as in dds_sample_info_t::publication_handle).
  const std::map<std::uint64_t, Found>& writers() const { return writers_; }

 private:
  WriterIdentity identity_of(const dds_builtintopic_endpoint_t& endpoint,
                             const TopicRow& row) const;

  std::function<void()> on_news_;
  dds_entity_t participants_{0}, publications_{0};
  std::map<std::uint64_t, Found> writers_;
};

}  // namespace handsel
