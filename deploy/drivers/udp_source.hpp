// SPDX-License-Identifier: Apache-2.0
// The cycles of a fake arm, as its datagrams come.
#pragma once

#include "deploy/drivers/driver_node.hpp"
#include "deploy/drivers/maker_udp.hpp"

namespace handsel::drivers {

template <class Link>
struct UdpSource : CycleSource {
  explicit UdpSource(int number) : port(number), link(port) {}
  bool wait(Duration at_most) override { return port.wait(at_most); }
  UdpPort port;  ///< receives the states, sends the commands
  Link link;     ///< the maker's side for the driver; uses `port`
};

}  // namespace handsel::drivers
