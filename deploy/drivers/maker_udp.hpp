// SPDX-License-Identifier: Apache-2.0
// The messages between the drivers and the fakes of their makers' controllers: one datagram in each
// direction a cycle, on this machine. A real arm has its maker's library in this place. Own
// protocol: the fakes run without a maker's library.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/time.hpp"
#include "deploy/drivers/position_arm.hpp"
#include "deploy/drivers/reflex_arm.hpp"

namespace handsel::drivers {

/// Commands of a driver to its maker's controller, with the values that follow each kind.
enum class OrderKind : std::uint8_t {
  position,            ///< [rad] for this cycle, arm axes
  request_commanding,  ///< none
  recover,             ///< none
  load,                ///< mass [kg]
  gripper_move,        ///< width [m], speed [m/s]
  gripper_grasp,       ///< width [m], speed [m/s], force [N]
};

struct Order {
  OrderKind kind{};  ///< decides the number and the units of `values`
  /// Of the state it answers: a position that comes after its cycle is ignored.
  std::uint64_t cycle{};
  Vector values;  ///< as listed at OrderKind; at most 32
};

/// Returns the datagram of a state; the byte order is the machine's.
std::string encode(const CyclicState& state);
/// Returns the datagram of a state; its error text is cut to 200 bytes.
std::string encode(const ReflexState& state);
/// Returns the datagram of a command.
std::string encode(const Order& order);
/// Returns false when the datagram is malformed: another kind, cut, too long, not finite, vectors
/// of unequal lengths. `out` is then left in any state.
bool decode(std::string_view datagram, CyclicState& out);
/// Returns false when the datagram is malformed, as above.
bool decode(std::string_view datagram, ReflexState& out);
/// Returns false also for a number of values that the kind does not have.
bool decode(std::string_view datagram, Order& out);

/// A UDP port on the loopback interface; answers go to the sender of the newest datagram.
class UdpPort {
 public:
  /// 0: any free one. Throws MissingError when it is taken.
  explicit UdpPort(int port);
  ~UdpPort();
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  /// Returns the number of the bound port.
  int port() const;
  /// Until something came; false after `at_most`.
  bool wait(Duration at_most) const;
  /// Never blocks; false when nothing waits.
  bool receive(std::string& datagram);
  /// Sends to the sender of the newest datagram; does nothing before the first.
  void answer(const std::string& datagram) const;
  /// Sends to a port of this machine; a lost datagram is not reported.
  void send_to(int port, const std::string& datagram) const;

 private:
  int socket_{-1};
  std::uint16_t peer_{};  // port, network order; 0: nothing received yet
};

class UdpCyclicLink : public CyclicLink {
 public:
  explicit UdpCyclicLink(UdpPort& port) : port_(port) {}
  bool receive(CyclicState& out) override;
  void answer(const Vector& position) override { send_order(OrderKind::position, position); }
  void request_commanding() override { send_order(OrderKind::request_commanding, {}); }
  void set_load(double mass) override;

 private:
  void send_order(OrderKind kind, const Vector& values) const {
    port_.answer(encode(Order{kind, cycle_, values}));
  }
  UdpPort& port_;
  std::uint64_t cycle_{};
};

class UdpReflexLink : public ReflexLink {
 public:
  explicit UdpReflexLink(UdpPort& port) : port_(port) {}
  bool read(ReflexState& out) override;
  void move_to(const Vector& position) override { send_order(OrderKind::position, position); }
  void recover() override { send_order(OrderKind::recover, {}); }
  void set_load(double mass) override;
  void gripper_move(double width, double speed) override;
  void gripper_grasp(double width, double speed, double force) override;

 private:
  void send_order(OrderKind kind, const Vector& values) const {
    port_.answer(encode(Order{kind, cycle_, values}));
  }
  UdpPort& port_;
  std::uint64_t cycle_{};
};

}  // namespace handsel::drivers
