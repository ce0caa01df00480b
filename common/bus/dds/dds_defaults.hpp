// SPDX-License-Identifier: Apache-2.0
// How a process enters a DDS domain when nothing else is said: which domain, which hosts.
// Environment in, environment out.
#pragma once

#include <filesystem>
#include <string>

namespace handsel {

/// Returns $HANDSEL_DOMAIN, else 0. Throws ConfigError when it is no number from 0 to 230.
int default_domain();

/// Returns $HANDSEL_NAME: the name of this system, which keeps its topics apart from those of other
/// systems in the domain (a DDS partition); empty: none. Throws ConfigError when the name has other
/// characters than letters, digits, "_" and "-", or more than 32.
std::string system_name();

/// Sets CYCLONEDDS_URI when the environment has none. Without $HANDSEL_PEERS: loopback.xml of
/// `folder`, this machine only. With it: network.xml of `folder`, which discovers by multicast, and
/// the hosts it names (names or addresses, separated by commas or spaces) as peers; the word
/// "multicast" alone names no other peer. Changes nothing when the file is not there. Throws
/// MissingError naming the first host that has no address.
void use_dds_configuration(const std::filesystem::path& folder);

}  // namespace handsel
