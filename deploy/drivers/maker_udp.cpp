// SPDX-License-Identifier: Apache-2.0
#include "deploy/drivers/maker_udp.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <type_traits>

#include "common/base/errors.hpp"

namespace handsel::drivers {

namespace {

constexpr std::uint32_t kCyclic = 0x48434131, kReflex = 0x48524131,
                        kOrder = 0x484f5231;  // first word of each kind
constexpr std::uint32_t kMaxValues = 32, kMaxText = 200;

class Writer {
 public:
  template <class T>
  Writer& operator<<(T value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Writer& operator<<(const Vector& v) {
    *this << static_cast<std::uint32_t>(v.size());
    for (double x : v) *this << x;
    return *this;
  }
  Writer& operator<<(const std::string& text) {
    const auto size = static_cast<std::uint32_t>(std::min<std::size_t>(text.size(), kMaxText));
    *this << size;
    bytes_.append(text, 0, size);
    return *this;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  Reader& operator>>(T& value) {
    if constexpr (std::is_enum_v<T>) return read_enum(value);
    if (bytes_.size() < sizeof value) return fail();
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    if constexpr (std::is_floating_point_v<T>)
      if (!std::isfinite(value)) return fail();
    return *this;
  }
  Reader& operator>>(bool& value) {
    std::uint8_t byte = 2;
    *this >> byte;
    value = byte == 1;
    return byte < 2 ? *this : fail();
  }
  Reader& operator>>(Vector& v) {
    std::uint32_t size = 0;
    if (!(*this >> size).good_ || size > kMaxValues) return fail();
    v.resize(size);
    for (double& x : v) *this >> x;
    return *this;
  }
  Reader& operator>>(Vector3& v) { return *this >> v.x() >> v.y() >> v.z(); }
  Reader& operator>>(std::string& text) {
    std::uint32_t size = 0;
    if (!(*this >> size).good_ || size > kMaxText || size > bytes_.size()) return fail();
    text.assign(bytes_.substr(0, size));
    bytes_.remove_prefix(size);
    return *this;
  }
  bool done() const { return good_ && bytes_.empty(); }

 private:
  static constexpr int last(Session) { return static_cast<int>(Session::commanding_active); }
  static constexpr int last(Safety) { return static_cast<int>(Safety::emergency_stop); }
  static constexpr int last(ArmMode) { return static_cast<int>(ArmMode::emergency_stopped); }
  static constexpr int last(OrderKind) { return static_cast<int>(OrderKind::gripper_grasp); }
  template <class E>
  Reader& read_enum(E& value) {
    std::uint8_t number = 255;
    if (!(*this >> number).good_ || number > last(E{})) return fail();
    value = static_cast<E>(number);
    return *this;
  }
  Reader& fail() {
    good_ = false;
    bytes_ = {};
    return *this;
  }
  std::string_view bytes_;
  bool good_{true};
};

bool is(Reader& in, std::uint32_t kind) {
  std::uint32_t word = 0;
  in >> word;
  return word == kind;
}

template <class State>
bool newest(UdpPort& port, State& out, std::uint64_t& cycle) {
  bool came = false;
  std::string datagram;
  State state;
  while (port.receive(datagram)) {
    if (!decode(datagram, state)) continue;
    out = state;
    cycle = state.cycle;
    came = true;
  }
  return came;
}

Vector values(std::initializer_list<double> list) {
  Vector v(static_cast<Eigen::Index>(list.size()));
  std::copy(list.begin(), list.end(), v.begin());
  return v;
}

sockaddr_in here(std::uint16_t port_in_network_order) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = port_in_network_order;
  return address;
}

}  // namespace

std::string encode(const CyclicState& s) {
  Writer out;
  out << kCyclic << s.cycle << s.session << s.safety << s.drives_on << s.brakes_open << s.position
      << s.velocity << s.torque << s.external_torque << s.interpolated;
  return out.take();
}

bool decode(std::string_view datagram, CyclicState& s) {
  Reader in(datagram);
  if (!is(in, kCyclic)) return false;
  in >> s.cycle >> s.session >> s.safety >> s.drives_on >> s.brakes_open >> s.position >>
      s.velocity >> s.torque >> s.external_torque >> s.interpolated;
  const auto n = s.position.size();
  return in.done() && s.velocity.size() == n && s.torque.size() == n &&
         s.external_torque.size() == n && s.interpolated.size() == n;
}

std::string encode(const ReflexState& s) {
  Writer out;
  out << kReflex << s.cycle << s.mode << s.powered << s.brakes_open << s.position << s.velocity
      << s.torque << s.external_torque;
  for (const Vector3& v : {s.wrist_wrench.force, s.wrist_wrench.torque})
    out << v.x() << v.y() << v.z();
  out << s.gripper_width << s.gripper_force << s.error;
  return out.take();
}

bool decode(std::string_view datagram, ReflexState& s) {
  Reader in(datagram);
  if (!is(in, kReflex)) return false;
  in >> s.cycle >> s.mode >> s.powered >> s.brakes_open >> s.position >> s.velocity >> s.torque >>
      s.external_torque >> s.wrist_wrench.force >> s.wrist_wrench.torque >> s.gripper_width >>
      s.gripper_force >> s.error;
  const auto n = s.position.size();
  return in.done() && s.velocity.size() == n && s.torque.size() == n &&
         s.external_torque.size() == n;
}

std::string encode(const Order& order) {
  Writer out;
  out << kOrder << order.kind << order.cycle << order.values;
  return out.take();
}

bool decode(std::string_view datagram, Order& order) {
  Reader in(datagram);
  if (!is(in, kOrder)) return false;
  in >> order.kind >> order.cycle >> order.values;
  static constexpr std::array<int, 6> kSize{-1, 0, 0, 1, 2, 3};  // per kind; -1: one per axis
  const int size = kSize[static_cast<std::size_t>(order.kind)];
  return in.done() && (size < 0 || order.values.size() == size);
}

UdpPort::UdpPort(int port)
    : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  const sockaddr_in address = here(htons(static_cast<std::uint16_t>(port)));
  if (socket_ >= 0 &&
      bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
    return;
  const std::string why = std::strerror(errno);
  if (socket_ >= 0) close(socket_);
  throw MissingError("UDP port " + std::to_string(port) + " cannot be had: " + why);
}

UdpPort::~UdpPort() { close(socket_); }

int UdpPort::port() const {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

bool UdpPort::wait(Duration at_most) const {
  pollfd ready{socket_, POLLIN, 0};
  const auto ns = std::max<std::int64_t>(0, at_most.count());
  const timespec limit{ns / 1'000'000'000, ns % 1'000'000'000};
  return ppoll(&ready, 1, &limit, nullptr) == 1;
}

bool UdpPort::receive(std::string& datagram) {
  std::array<char, 4096> buffer;
  sockaddr_in from{};
  socklen_t size = sizeof from;
  const ssize_t n =
      recvfrom(socket_, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
  if (n < 0) return false;
  peer_ = from.sin_port;
  datagram.assign(buffer.data(), static_cast<std::size_t>(n));
  return true;
}

void UdpPort::answer(const std::string& datagram) const {
  if (peer_ != 0) send_to(ntohs(peer_), datagram);
}

void UdpPort::send_to(int port, const std::string& datagram) const {
  const sockaddr_in to = here(htons(static_cast<std::uint16_t>(port)));
  // An unread datagram counts as lost: both sides tolerate that.
  (void)sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to),
               sizeof to);
}

bool UdpCyclicLink::receive(CyclicState& out) { return newest(port_, out, cycle_); }
void UdpCyclicLink::set_load(double mass) { send_order(OrderKind::load, values({mass})); }

bool UdpReflexLink::read(ReflexState& out) { return newest(port_, out, cycle_); }
void UdpReflexLink::set_load(double mass) { send_order(OrderKind::load, values({mass})); }
void UdpReflexLink::gripper_move(double width, double speed) {
  send_order(OrderKind::gripper_move, values({width, speed}));
}
void UdpReflexLink::gripper_grasp(double width, double speed, double force) {
  send_order(OrderKind::gripper_grasp, values({width, speed, force}));
}

}  // namespace handsel::drivers
