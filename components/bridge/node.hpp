// The wall screen: listens to everything, serves a page on 127.0.0.1. Nothing depends on it.
#pragma once

#include <memory>

#include "common/bus/bus.hpp"
#include "common/bus/node_context.hpp"
#include "components/bridge/http_server.hpp"
#include "components/bridge/view.hpp"

namespace handsel::bridge {

class Node {
 public:
  /// Throws ConfigError for settings out of range; a port that is taken only degrades it, and is tried again every 5 s.
  Node(Bus& bus, const NodeContext& context);

 private:
  template <class M>
  void show(double max_rate);
  void open_page();

  Bus& bus_;
  View view_;
  HttpSettings settings_;
  std::unique_ptr<HttpServer> server_;
};

}  // namespace handsel::bridge
