// SPDX-License-Identifier: Apache-2.0
// All leaves of a wire sample, each with its name.
#pragma once

#include <string>
#include <vector>

#include "common/wire/message_type.hpp"

namespace handsel {

struct NamedLeaf : WireLeaf {
  std::string name;  ///< "position[3]"
};

inline std::vector<NamedLeaf> leaves_of(const MessageType& type, void* wire) {
  std::vector<NamedLeaf> out;
  type.leaves(wire, [&](const WireLeaf& leaf) { out.push_back({leaf, leaf.path()}); });
  return out;
}

}  // namespace handsel
