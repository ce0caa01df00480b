// SPDX-License-Identifier: Apache-2.0
// Binds the bridge to a bus: passes the samples of every topic unchanged to all viewers and serves
// the page on 127.0.0.1. With a token, publishes the commands of visitors. No other component
// depends on the bridge.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/dds/raw.hpp"
#include "common/bus/node_context.hpp"
#include "components/bridge/commands/steering.hpp"
#include "components/bridge/drawing.hpp"
#include "components/bridge/server.hpp"
#include "components/bridge/system_graph.hpp"

namespace handsel::bridge {

class Node {
 public:
  /// Throws ConfigError for settings out of range; a port that is taken only degrades it, and is
  /// tried again every 5 s.
  Node(Bus& bus, const NodeContext& context);

 private:
  void start_server();
  void publish_samples();
  bool read(std::size_t topic);
  void draw();
  Graph graph(TimePoint now) const;

  Bus& bus_;
  RawBus* raw_;  ///< null: a bus without serialised samples
  ServerSettings settings_;
  Site site_;
  Catalogue catalogue_;
  std::string config_;
  /// By place in the table of topics; null: no viewer.
  std::vector<std::unique_ptr<RawReader>> readers_;
  SystemGraph graph_;
  Drawing drawing_;
  bool drawing_listens_{false};       ///< from the first viewer that wants it
  std::optional<Steering> steering_;  ///< with a token only
  std::unique_ptr<Server> server_;
};

}  // namespace handsel::bridge
