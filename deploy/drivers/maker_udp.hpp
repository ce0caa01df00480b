// What the drivers and the fakes of their makers' controllers say to each other: one datagram each way a cycle, on this machine. A real arm
// has its maker's library in this place. Ours.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/time.hpp"
#include "deploy/drivers/position_arm.hpp"
#include "deploy/drivers/reflex_arm.hpp"

namespace handsel::drivers {

/// What a driver tells its maker's controller. The values of each kind stand behind it.
enum class OrderKind : std::uint8_t {
  position,            ///< [rad] for this cycle, arm axes
  request_commanding,  ///< none
  recover,             ///< none
  load,                ///< mass [kg]
  gripper_move,        ///< width [m], speed [m/s]
  gripper_grasp,       ///< width [m], speed [m/s], force [N]
};

struct Order {
  OrderKind kind{};
  std::uint64_t cycle{};  ///< the state it answers: a position that comes after its cycle is not heard
  Vector values;
};

std::string encode(const CyclicState& state);
std::string encode(const ReflexState& state);
std::string encode(const Order& order);
/// False when the datagram is malformed: another kind, cut, too long, not finite. `out` is then left in any state.
bool decode(std::string_view datagram, CyclicState& out);
bool decode(std::string_view datagram, ReflexState& out);
bool decode(std::string_view datagram, Order& out);

/// A UDP port of this machine; answers go to whoever spoke last.
class UdpPort {
 public:
  /// 0: any free one. Throws MissingError when it is taken.
  explicit UdpPort(int port);
  ~UdpPort();
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  int port() const;
  /// Until something came; false after `at_most`.
  bool wait(Duration at_most) const;
  /// Never blocks; false when nothing waits.
  bool receive(std::string& datagram);
  void answer(const std::string& datagram) const;
  void send_to(int port, const std::string& datagram) const;

 private:
  int socket_{-1};
  std::uint16_t peer_{};  // port, network order; 0: nobody has spoken
};

class UdpCyclicLink : public CyclicLink {
 public:
  explicit UdpCyclicLink(UdpPort& port) : port_(port) {}
  bool receive(CyclicState& out) override;
  void answer(const Vector& position) override { tell(OrderKind::position, position); }
  void request_commanding() override { tell(OrderKind::request_commanding, {}); }
  void set_load(double mass) override;

 private:
  void tell(OrderKind kind, const Vector& values) const { port_.answer(encode(Order{kind, cycle_, values})); }
  UdpPort& port_;
  std::uint64_t cycle_{};
};

class UdpReflexLink : public ReflexLink {
 public:
  explicit UdpReflexLink(UdpPort& port) : port_(port) {}
  bool read(ReflexState& out) override;
  void move_to(const Vector& position) override { tell(OrderKind::position, position); }
  void recover() override { tell(OrderKind::recover, {}); }
  void set_load(double mass) override;
  void gripper_move(double width, double speed) override;
  void gripper_grasp(double width, double speed, double force) override;

 private:
  void tell(OrderKind kind, const Vector& values) const { port_.answer(encode(Order{kind, cycle_, values})); }
  UdpPort& port_;
  std::uint64_t cycle_{};
};

}  // namespace handsel::drivers
