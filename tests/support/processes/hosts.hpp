// SPDX-License-Identifier: Apache-2.0
// Hosts of one network on this machine: network namespaces with own addresses, joined by a switch.
// Creating them requires root; the machine's own network is unaffected.
#pragma once

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/processes/shell.hpp"

namespace handsel::test {

class Hosts {
 public:
  /// Empty, or why there can be none here.
  static std::string why_not() {
    const Outcome tried = shell(
        "unshare --net --mount sh -c 'ip link add name br type bridge && ip link add name a type "
        "veth peer name b'");
    return tried.exit_code == 0 ? "" : "network namespaces are not permitted here: " + tried.err;
  }

  explicit Hosts(const std::vector<std::string>& names) : names_(names) {
    std::string script = "set -e\nip netns add " + space("switch") + "\n" + in("switch") +
                         "ip link add name br type bridge mcast_snooping 0\n" + in("switch") +
                         "ip link set dev br up\n";
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string port = "p" + std::to_string(i);
      script += "ip netns add " + space(names[i]) + "\n" + in("switch") + "ip link add name " +
                port + " type veth peer name eth0 netns " + space(names[i]) + "\n" + in("switch") +
                "ip link set dev " + port + " master br up\n" + in(names[i]) +
                "ip link set dev lo up\n" + in(names[i]) + "ip address add " + address(names[i]) +
                "/24 dev eth0\n" + in(names[i]) + "ip link set dev eth0 up\n" + in(names[i]) +
                "ip route add default dev eth0\n";
    }
    const Outcome made = shell(script + "true");
    if (made.exit_code != 0) {
      remove();
      throw std::runtime_error("no hosts: " + made.err);
    }
  }
  ~Hosts() { remove(); }
  Hosts(const Hosts&) = delete;
  Hosts& operator=(const Hosts&) = delete;

  /// A command line that runs there.
  std::vector<std::string> on(const std::string& host, std::vector<std::string> command) const {
    command.insert(command.begin(), {kIp, "netns", "exec", space(host)});
    return command;
  }
  std::string address(const std::string& host) const {
    return "10.77.0." + std::to_string(number(host) + 1);
  }
  /// Pulls the host's cable, or plugs it in again.
  void link(const std::string& host, bool up) const {
    shell(in("switch") + "ip link set dev p" + std::to_string(number(host)) +
          (up ? " up" : " down"));
  }
  /// Takes the host's network card away.
  void unplug(const std::string& host) const {
    shell(in("switch") + "ip link delete dev p" + std::to_string(number(host)));
  }
  /// The calling thread, and those it starts from now on, are there.
  void move_here(const std::string& host) const {
    const int fd = open(("/run/netns/" + space(host)).c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0 || setns(fd, CLONE_NEWNET) != 0)
      throw std::runtime_error("cannot go to the host " + host);
    close(fd);
  }

 private:
  static constexpr const char* kIp = "/sbin/ip";
  std::string space(const std::string& host) const {
    return "handsel-" + std::to_string(maker_) + "-" + host;
  }
  std::string in(const std::string& host) const { return "ip netns exec " + space(host) + " "; }
  std::size_t number(const std::string& host) const {
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (names_[i] == host) return i;
    throw std::runtime_error("there is no host " + host);
  }
  void remove() const {
    std::string script = "ip netns del " + space("switch") + "\n";
    for (const std::string& name : names_) script += "ip netns del " + space(name) + "\n";
    shell(script + "true");
  }

  const pid_t maker_{getpid()};
  std::vector<std::string> names_;
};

}  // namespace handsel::test
