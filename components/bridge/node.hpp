// The wall screen: passes every topic on unchanged to all viewers, serves the page on 127.0.0.1.
// Nothing depends on it.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/dds/raw.hpp"
#include "common/bus/node_context.hpp"
#include "components/bridge/drawing.hpp"
#include "components/bridge/server.hpp"

namespace handsel::bridge {

class Node {
 public:
  /// Throws ConfigError for settings out of range; a port that is taken only degrades it, and is
  /// tried again every 5 s.
  Node(Bus& bus, const NodeContext& context);

 private:
  void open_page();
  void look();
  bool read(std::size_t topic);
  void draw();
  Graph graph(TimePoint now) const;

  Bus& bus_;
  RawBus* raw_;  ///< null: a bus without serialised samples
  ServerSettings settings_;
  Site site_;
  Catalogue catalogue_;
  std::string config_;
  /// By place in the table of topics; null: nobody watches.
  std::vector<std::unique_ptr<RawReader>> readers_;
  std::map<std::string, TimePoint> heard_;  ///< components, by their health
  Drawing drawing_;
  bool drawing_listens_{false};  ///< from the first viewer that wants it
  std::unique_ptr<Server> server_;
};

}  // namespace handsel::bridge
