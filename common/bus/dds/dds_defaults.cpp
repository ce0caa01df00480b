// SPDX-License-Identifier: Apache-2.0
#include "common/bus/dds/dds_defaults.hpp"

#include <netdb.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <vector>

#include "common/base/errors.hpp"

namespace handsel {
namespace {

std::vector<std::string> words(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; (begin = text.find_first_not_of(", ", begin)) != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_of(", ", begin), text.size());
    out.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return out;
}

void require_address(const std::string& host) {
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_family = AF_INET;
  const int result = getaddrinfo(host.c_str(), nullptr, &wanted, &found);
  if (result != 0)
    throw MissingError("HANDSEL_PEERS names the host \"" + host +
                       "\", which has no address: " + gai_strerror(result));
  freeaddrinfo(found);
}

}  // namespace

int default_domain() {
  const char* text = std::getenv("HANDSEL_DOMAIN");
  if (!text || !*text) return 0;
  int domain = -1;
  const std::string value = text;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), domain);
  if (error != std::errc() || end != value.data() + value.size() || domain < 0 || domain > 230) {
    throw ConfigError("HANDSEL_DOMAIN is \"" + value + "\"; it must be a number from 0 to 230");
  }
  return domain;
}

std::string system_name() {
  constexpr std::size_t kMaxLength = 32;
  const char* text = std::getenv("HANDSEL_NAME");
  std::string name = text != nullptr ? text : "";
  const auto allowed = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; };
  if (name.size() > kMaxLength || !std::all_of(name.begin(), name.end(), allowed))
    throw ConfigError("HANDSEL_NAME is \"" + name +
                      "\"; it must have at most 32 letters, digits, \"_\" or \"-\"");
  return name;
}

void use_dds_configuration(const std::filesystem::path& folder) {
  if (std::getenv("CYCLONEDDS_URI")) return;
  const char* named = std::getenv("HANDSEL_PEERS");
  const bool alone = !named || !*named;
  const std::filesystem::path file = folder / (alone ? "loopback.xml" : "network.xml");
  if (!std::filesystem::exists(file)) return;
  std::string uri = "file://" + file.string(), peers;
  for (const std::string& host : words(alone ? "" : named)) {
    if (host == "multicast") continue;
    require_address(host);
    peers += "<Peer address=\"" + host + "\"/>";
  }
  if (!peers.empty())
    uri += ",<CycloneDDS><Domain Id=\"any\"><Discovery><Peers>" + peers +
           "</Peers></Discovery></Domain></CycloneDDS>";
  setenv("CYCLONEDDS_URI", uri.c_str(), 0);
}

}  // namespace handsel
