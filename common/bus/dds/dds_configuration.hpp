// SPDX-License-Identifier: Apache-2.0
// The DDS configuration in use, as far as Handsel depends on it: read from CYCLONEDDS_URI as
// Cyclone DDS reads it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

struct dds_qos;

namespace handsel {

struct DdsConfiguration {
  std::string source;  ///< file or "CYCLONEDDS_URI" that was read last; empty: none, all defaults
  std::string error;   ///< empty, or one sentence: which file is not there or not XML
  std::vector<std::string> interfaces;           ///< named ones; empty: Cyclone chooses
  std::vector<std::string> peers;                ///< unicast discovery asks them
  bool multicast{true};                          ///< AllowMulticast is not false
  std::string participant_index{"none"};         ///< "auto", "none" or a number
  int max_auto_index{9};                         ///< so many processes of a machine get an index
  std::optional<std::uint64_t> max_sample_size;  ///< [bytes]; nullopt: no bound worth the name
};

/// Returns the configuration of `domain` under `uri`: a comma-separated list of file URIs, paths
/// and inline XML, later ones win. Never throws.
DdsConfiguration read_dds_configuration(const std::string& uri, std::uint32_t domain);

/// Creates a participant in a domain and returns the transport's handle, below 0 for an error of
/// the transport that has nothing to do with its configuration. Throws MissingError when
/// CYCLONEDDS_URI names a file that is not there, ConfigError when the transport refuses what
/// CYCLONEDDS_URI says; both in one sentence, in place of the transport's own lines.
int create_participant(std::uint32_t domain, const ::dds_qos* qos);

/// The transport's library: the version this program was built for, and the file it runs with.
struct TransportLibrary {
  /// Version at compile time ("0.10.5"); path of the shared library, or empty.
  std::string built_for, file;
  bool agrees{};  ///< the file's name ends with that version
};
/// Returns the version this program was compiled for and the library it has loaded.
TransportLibrary transport_library();

/// Returns the first of the two UDP ports of participant `index` in `domain` (DDSI-RTPS 9.6.1.1);
/// the other is one above.
constexpr int participant_port(std::uint32_t domain, int index) {
  return 7400 + 250 * static_cast<int>(domain) + 10 + 2 * index;
}

}  // namespace handsel
