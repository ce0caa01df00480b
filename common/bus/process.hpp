// SPDX-License-Identifier: Apache-2.0
// One component as one operating-system process on DdsBus.
#pragma once

#include <functional>
#include <memory>

#include "common/bus/bus.hpp"
#include "common/bus/dds/dds_bus.hpp"
#include "common/bus/node_context.hpp"

namespace handsel {

using NodeFactory = std::function<std::shared_ptr<void>(Bus&, const NodeContext&)>;

/// Runs one component until it is asked to end. Options: --robot NAME|FILE (the scenario's, else
/// jido), --scenario NAME|FILE, --domain N (environment HANDSEL_DOMAIN, else 0), --config DIR,
/// --state DIR (environment HANDSEL_STATE, else domain_state_directory()), --seed N, --sim-time
/// (environment HANDSEL_SIM_TIME; the simulator gives the pace), --realtime (SCHED_FIFO and locked
/// memory where permitted), --cpu-affinity N, --standby (start beside a living twin). Prints one
/// line when ready, runs until SIGTERM or SIGINT, then returns 0 within a second. Returns 2 on
/// ConfigError and when the domain already has this component, 3 on MissingError, 1 on any other
/// error, each with one sentence on stderr.
int run_process(int argc, char** argv, const char* component, const NodeFactory& make_node,
                Urgency urgency = Urgency::perceive);

/// As above, with a node constructed as Node(bus, context).
template <class Node>
int run_process(int argc, char** argv, const char* component, Urgency urgency = Urgency::perceive) {
  return run_process(
      argc, argv, component,
      [](Bus& bus, const NodeContext& context) { return std::make_shared<Node>(bus, context); },
      urgency);
}

}  // namespace handsel
