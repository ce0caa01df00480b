// SPDX-License-Identifier: Apache-2.0
// samples DOMAIN SEED: publishes one random valid sample of every message type over DDS repeatedly
// until its input ends. Prints one line of JSON per type before: {"topic", "type", "leaves":
// {"path": value}}, integers of 64 bits as text.
#include <poll.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "common/bus/dds/dds_bus.hpp"
#include "tests/support/oracles/wire_leaves.hpp"

namespace {

using namespace handsel;
using Leaves = std::vector<NamedLeaf>;

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}

  double share() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  std::uint64_t whole() { return random_(); }

  void throw_leaf(const WireLeaf& leaf, int attempt) {
    switch (leaf.kind) {
      case WireLeaf::Kind::number: {
        const double scale[] = {1e3, 1.0, 1.0, 1e-3};
        const double value = scale[attempt % 4] * (attempt % 2 ? share() : 2 * share() - 1);
        std::memcpy(leaf.value, &value, sizeof value);
        break;
      }
      case WireLeaf::Kind::integer: {
        const std::uint64_t value = attempt == 0 ? whole() >> 1 : whole() % (attempt == 1 ? 30 : 2);
        std::memcpy(leaf.value, &value, leaf.size);  // little-endian
        break;
      }
      case WireLeaf::Kind::choice: {
        const std::uint32_t value = static_cast<std::uint32_t>(whole() % (attempt == 0 ? 7 : 3));
        std::memcpy(leaf.value, &value, sizeof value);
        break;
      }
      case WireLeaf::Kind::flag:
        *static_cast<bool*>(leaf.value) = whole() % 2 != 0;
        break;
      case WireLeaf::Kind::text: {
        std::string text;
        const std::size_t length = whole() % leaf.size;
        const char* letters[] = {"a", "Z", "7", "_", "\xc3\xa9", "\xe2\x82\xac", " ", "\"", "\\"};
        for (std::size_t most = attempt == 0 ? 9 : 4; text.size() + 3 < length;)
          text += letters[whole() % most];
        std::memset(leaf.value, 0, leaf.size);
        std::memcpy(leaf.value, text.c_str(), text.size());
      }
    }
  }

 private:
  std::mt19937_64 random_;
};

bool valid(const MessageType& type, void* wire) {
  std::string why;
  return type.from_wire(wire, type.new_message().get(), why);
}

void rotate(const Leaves& leaves, std::size_t w, Dice& dice) {
  double q[4], norm = 0;
  for (double& value : q) {
    value = 2 * dice.share() - 1;
    norm += value * value;
  }
  for (std::size_t i = 0; i < 4; ++i)
    *static_cast<double*>(leaves[w - 3 + i].value) = q[i] / std::sqrt(norm);
}

/// Returns a message with random leaves; values that violate a rule are reverted.
std::shared_ptr<void> random_message(const MessageType& type, Dice& dice) {
  auto wire = type.new_wire();
  type.fill(wire.get(), false);
  const Leaves leaves = leaves_of(type, wire.get());
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    std::vector<char> before(static_cast<char*>(leaves[i].value),
                             static_cast<char*>(leaves[i].value) + leaves[i].size);
    bool accepted = false;
    for (int attempt = 0; attempt < 4 && !accepted; ++attempt) {
      dice.throw_leaf(leaves[i], attempt);
      accepted = valid(type, wire.get());
    }
    if (!accepted) std::memcpy(leaves[i].value, before.data(), before.size());
    if (leaves[i].name.ends_with(".orientation.w")) rotate(leaves, i, dice);
  }
  auto message = type.new_message();
  std::string why;
  if (!type.from_wire(wire.get(), message.get(), why)) throw std::runtime_error(why);
  return message;
}

nlohmann::json value_of(const WireLeaf& leaf) {
  switch (leaf.kind) {
    case WireLeaf::Kind::number:
      return *static_cast<double*>(leaf.value);
    case WireLeaf::Kind::integer: {
      std::uint64_t value = 0;
      std::memcpy(&value, leaf.value, leaf.size);
      if (leaf.size == 8) return std::to_string(value);
      return value;
    }
    case WireLeaf::Kind::choice: {
      std::uint32_t value = 0;
      std::memcpy(&value, leaf.value, sizeof value);
      return value;
    }
    case WireLeaf::Kind::flag:
      return *static_cast<bool*>(leaf.value);
    case WireLeaf::Kind::text:
      return static_cast<char*>(leaf.value);
  }
  return {};
}

std::string printed(const MessageType& type, const void* message) {
  auto wire = type.new_wire();
  std::string why;
  if (!type.to_wire(message, 1, wire.get(), why)) throw std::runtime_error(why);
  nlohmann::json values;
  for (const NamedLeaf& leaf : leaves_of(type, wire.get())) values[leaf.name] = value_of(leaf);
  return nlohmann::json{{"topic", type.row().topic}, {"type", type.row().type}, {"leaves", values}}
      .dump();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: samples DOMAIN SEED\n"), 2;
  try {
    DdsBus bus(
        {.component = "samples sim spark supervisor manipulation_planner trajectory_controller",
         .domain = static_cast<std::uint32_t>(std::stoul(argv[1])),
         .health = false});
    Dice dice(std::stoull(argv[2]));
    std::vector<std::unique_ptr<AnyPublisher>> publishers;
    std::vector<std::shared_ptr<void>> messages;
    for (std::size_t i = 0; i < topics().size(); ++i) {
      publishers.push_back(bus.advertise_any(message_type(i), 1));
      messages.push_back(random_message(message_type(i), dice));
      std::puts(printed(message_type(i), messages.back().get()).c_str());
    }
    std::fflush(stdout);
    pollfd input{STDIN_FILENO, POLLIN, 0};
    bus.every(std::chrono::milliseconds(100), [&](TimePoint) {
      for (std::size_t i = 0; i < publishers.size(); ++i)
        if (publishers[i]->readers() > 0) publishers[i]->publish(messages[i].get());
      if (poll(&input, 1, 0) > 0) bus.stop();
    });
    bus.run();
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "samples: %s\n", error.what()), 1;
  }
}
