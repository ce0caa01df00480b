// SPDX-License-Identifier: Apache-2.0
#include "common/wire/interface_id.hpp"

#include <cstdint>
#include <cstdio>
#include <string_view>

#include <dds/dds.h>

#include "common/wire/message_type.hpp"

namespace handsel {

std::string interface_id() {
  std::uint32_t hash = 2166136261u;  // FNV-1a
  const auto add = [&hash](const void* data, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
      hash = (hash ^ static_cast<const unsigned char*>(data)[i]) * 16777619u;
  };
  for (std::size_t i = 0; i < std::size(kTopics); ++i) {
    const auto& descriptor =
        *static_cast<const dds_topic_descriptor_t*>(message_type(i).descriptor());
    add(kTopics[i].topic, std::string_view(kTopics[i].topic).size());
    add(&kTopics[i].profile, sizeof kTopics[i].profile);
    add(descriptor.type_information.data, descriptor.type_information.sz);
  }
  char text[9];
  std::snprintf(text, sizeof text, "%08x", hash);
  return text;
}

std::string version_text() { return "handsel " HANDSEL_VERSION ", interface " + interface_id(); }

}  // namespace handsel
