// SPDX-License-Identifier: Apache-2.0
// Malformed RTPS datagrams at the ports of running participants: they continue with constant
// memory.
#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <random>
#include <vector>

#include "common/messages/robot.hpp"
#include "tests/unit/bus/bus_stage.hpp"

namespace handsel::garbage_test {
namespace {

constexpr int kDatagrams = 10000;

double resident_mb() {
  double total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

class Sender {
 public:
  Sender() : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~Sender() { close(socket_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;
  void send(const std::vector<unsigned char>& bytes, int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    sent_ += sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&address),
                    sizeof address) > 0;
  }
  int sent() const { return sent_; }

 private:
  int socket_;
  int sent_{0};
};

/// Random bytes; of each four, three with an RTPS header and submessages of random kind, flags and
/// length.
std::vector<unsigned char> datagram(std::mt19937_64& random) {
  std::vector<unsigned char> out(20 + random() % 1200);
  for (unsigned char& byte : out) byte = static_cast<unsigned char>(random());
  if (random() % 4 == 0) return out;
  constexpr unsigned char kHeader[] = {'R', 'T', 'P', 'S', 2, 1, 1, 16};
  std::memcpy(out.data(), kHeader, sizeof kHeader);
  constexpr unsigned char kKinds[] = {0x01, 0x06, 0x07, 0x08, 0x09, 0x0c,
                                      0x0d, 0x0e, 0x12, 0x13, 0x15, 0x16};
  for (std::size_t at = 20; at + 4 < out.size();) {
    out[at] = kKinds[random() % std::size(kKinds)];
    out[at + 1] = static_cast<unsigned char>(random() % 16 | 1);
    const std::size_t length = random() % 3 == 0 ? random() % 65536 : 4 * (random() % 40);
    out[at + 2] = static_cast<unsigned char>(length & 255);
    out[at + 3] = static_cast<unsigned char>(length >> 8);
    at += 4 + length;
  }
  return out;
}

TEST(Garbage, ten_thousand_datagrams_do_not_stop_a_bus_or_grow_it) {
  // As shipped, without the log line of the transport about each datagram.
  setenv("CYCLONEDDS_URI",
         "file://" HANDSEL_SOURCE_DIR
         "/deploy/dds/loopback.xml,<CycloneDDS><Domain><Tracing><Verbosity>severe</Verbosity></"
         "Tracing></Domain></CycloneDDS>",
         1);
  test::DdsStage stage;
  Bus &writer = stage.add("sim"), &reader = stage.add("spark");
  std::uint64_t received = 0;
  const SubscriptionStatus& status =
      reader.subscribe<RobotState>([&](const RobotState&, const Receipt&) { ++received; });
  const auto out = writer.advertise<RobotState>();
  RobotState state;
  state.robot = "jido";
  state.position = state.velocity = Vector::Zero(22);
  const auto arrives = [&] {
    const std::uint64_t before = received;
    return stage.until([&] { return out->publish(state), received > before; });
  };
  ASSERT_TRUE(stage.until([&] { return out->readers() > 0; }));
  ASSERT_TRUE(arrives());

  const int domain = 100 + static_cast<int>(getpid()) % 100;
  Sender sender;
  std::mt19937_64 random(11);
  const auto flood = [&](int n) {
    for (int i = 0; i < n; ++i) {
      // Ports of discovery and data of the first participants: 7400 + 250 d + 10 + 2 p and
      // 7400 + 250 d + 11 + 2 p.
      sender.send(datagram(random), 7400 + 250 * domain + 10 + i % 4);
      if (i % 100 == 99) stage.pass(0.002);
    }
  };
  flood(kDatagrams / 5);
  const double before = resident_mb();
  flood(kDatagrams - kDatagrams / 5);
  ASSERT_TRUE(arrives());
  EXPECT_EQ(sender.sent(), kDatagrams);
  EXPECT_LT(resident_mb() - before, 4) << "8000 datagrams of 600 bytes are 5 MB";
  EXPECT_EQ(status.rejected, 0u);
}

}  // namespace
}  // namespace handsel::garbage_test
