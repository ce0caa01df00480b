// SPDX-License-Identifier: Apache-2.0
// The server with hostile or faulty clients, over real sockets.
#include "components/bridge/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/config/resources.hpp"
#include "components/bridge/catalogue.hpp"
#include "components/bridge/commands/command_gate.hpp"
#include "tests/support/processes/temporary_folder.hpp"
#include "tests/support/processes/websocket_client.hpp"

namespace handsel::bridge::bridge_server_test {
namespace {

using test::HttpClient;
using test::WebSocketClient;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using Json = nlohmann::json;

double resident_mb() {
  double total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * 4096e-6;
}

struct BridgeServer : testing::Test {
  static constexpr const char* kToken = "0123456789abcdef0123456789abcdef";
  test::TemporaryFolder folder;
  std::unique_ptr<Server> server;

  BridgeServer() {
    setenv("HANDSEL_HOME", HANDSEL_SOURCE_DIR "/deploy", 1);
    std::filesystem::create_directories(folder.path() / "web");
    folder.write("web/index.html", "<title>Handsel</title>");
    folder.write("web/page.js", "run();");
    folder.write("web/.hidden", "hidden");
    folder.write("secret.txt", "secret");
    std::filesystem::create_symlink(folder.path() / "secret.txt", folder.path() / "web/link.txt");
    server = std::make_unique<Server>(settings(), Site(folder.path() / "web", resource_root()),
                                      catalogue(), R"({"robot":"jido"})");
  }
  static ServerSettings settings() {
    return {.port = 0,
            .max_clients = 4,
            .request_timeout = 0.5,
            .stall_timeout = 0.5,
            .allowed_origins = {"https://example.org"},
            .token = kToken};
  }
  static Catalogue catalogue() {
    Catalogue c;
    c.name = "handsel test";
    c.channels = {{.topic = "fast",
                   .encoding = "cdr",
                   .schema_name = "A",
                   .schema = "a",
                   .schema_encoding = "omgidl"},
                  {.topic = "kept",
                   .encoding = "cdr",
                   .schema_name = "B",
                   .schema = "b",
                   .schema_encoding = "omgidl",
                   .kept = true}};
    return c;
  }

  std::string ask(const std::string& method, const std::string& target) {
    HttpClient client(server->port());
    client.request(method, target);
    return client.read();
  }
  /// Sends a command; `more`: further headers.
  std::string command(const std::string& json, const std::string& token = kToken,
                      const std::string& more = {}, const std::string& path = "/command") {
    HttpClient client(server->port());
    client.send("POST " + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server->port()) +
                "\r\nConnection: close\r\n" +
                (token.empty() ? "" : "Authorization: Bearer " + token + "\r\n") + more +
                "Content-Length: " + std::to_string(json.size()) + "\r\n\r\n" + json);
    return client.read();
  }
  Json counters() {
    const std::string answer = ask("GET", "/counters.json");
    return Json::parse(answer.substr(answer.find("\r\n\r\n") + 4));
  }
  /// Repeats `holds`, which sends a request to the server, until it is true; at most 5 s.
  template <class Holds>
  bool comes_true(const Holds& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (!holds())
      if (std::chrono::steady_clock::now() > end) return false;
    return true;
  }
  /// Waits until a counter has reached a value; gives the counter.
  std::uint64_t counted(const char* name, std::uint64_t least) {
    std::uint64_t value = 0;
    comes_true([&] { return (value = counters()[name].get<std::uint64_t>()) >= least; });
    return value;
  }
  std::unique_ptr<WebSocketClient> viewer() {
    auto client = std::make_unique<WebSocketClient>(server->port());
    EXPECT_THAT(client->read("\"advertise\""), HasSubstr("101 Switching Protocols"));
    return client;
  }
  void subscribe(WebSocketClient& client, int channel) {
    client.frame(WebSocketClient::kText, R"({"op":"subscribe","subscriptions":[{"id":)" +
                                             std::to_string(channel) + R"(,"channelId":)" +
                                             std::to_string(channel) + "}]}");
    const std::string id =
        "after " +
        std::to_string(
            channel);  // messages are processed in order: the answer follows the subscription
    client.frame(WebSocketClient::kText,
                 R"({"op":"getParameters","parameterNames":[],"id":")" + id + R"("})");
    EXPECT_THAT(client.read(id), HasSubstr(id));
    EXPECT_TRUE(server->wanted(static_cast<std::size_t>(channel - 1)));
  }
  void publish(std::size_t channel, const std::string& text, std::size_t size = 0) {
    std::vector<std::uint8_t> bytes(text.begin(), text.end());
    bytes.resize(std::max(size, text.size()), 'x');
    server->publish({{.channel = channel,
                      .instance = 1,
                      .gone = false,
                      .stamp = 7,
                      .bytes = std::make_shared<decltype(bytes)>(bytes)}});
  }
};

TEST_F(BridgeServer, serves_page_assets_and_settings_with_a_strict_policy) {
  const std::string page = ask("GET", "/");
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(page, HasSubstr("Content-Security-Policy: default-src 'none'"));
  EXPECT_THAT(page, Not(HasSubstr("unsafe")));
  EXPECT_THAT(page, HasSubstr("<title>Handsel</title>"));
  EXPECT_THAT(ask("GET", "/page.js?v=1"), HasSubstr("Content-Type: text/javascript"));
  EXPECT_THAT(ask("GET", "/assets/robots/jido/jido.urdf"), HasSubstr("<robot"));
  EXPECT_THAT(ask("GET", "/assets/objects/mug/mug.obj"), HasSubstr("Content-Type: model/obj"));
  EXPECT_THAT(ask("GET", "/config.json"), HasSubstr(R"({"robot":"jido"})"));
  const std::string head = ask("HEAD", "/");
  EXPECT_THAT(head, HasSubstr("Content-Length: 22"));
  EXPECT_THAT(head, Not(HasSubstr("<title>")));
}

TEST_F(BridgeServer, gives_no_file_but_its_own) {
  for (const char* target : {"/../secret.txt",
                             "/..%2fsecret.txt",
                             "/%2e%2e/secret.txt",
                             "//etc/passwd",
                             "/./index.html",
                             "/index.html/",
                             "/link.txt",
                             "/.hidden",
                             "/page.js%00",
                             "*",
                             "http://127.0.0.1/etc/passwd",
                             "/assets/",
                             "/assets/robots",
                             "/assets/robots/",
                             "/assets/robots/jido",
                             "/assets/robots/../../secret.txt",
                             "/assets/config/bridge.txtpb",
                             "/assets/robots/jido/jido.txtpb",
                             "/assets/objects/mug/mug.txtpb",
                             "/assets/robots/..",
                             "\\..\\secret.txt",
                             "/page.js/../../secret.txt"}) {
    const std::string answer = ask("GET", target);
    EXPECT_THAT(answer, testing::AnyOf(StartsWith("HTTP/1.1 404"), StartsWith("HTTP/1.1 400")))
        << target;
    EXPECT_THAT(answer, Not(testing::ContainsRegex("secret\n|root:|hidden\n"))) << target;
  }
  EXPECT_THAT(ask("GET", "/" + std::string(3000, 'a')), StartsWith("HTTP/1.1 404"));
  EXPECT_GE(counted("refused_requests", 20), 20u);
}

TEST_F(BridgeServer, only_reads_and_only_under_its_own_name) {
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "NONSENSE"})
    EXPECT_THAT(ask(method, "/config.json"), Not(StartsWith("HTTP/1.1 200"))) << method;
  HttpClient client(server->port());
  client.request("GET", "/config.json", "example.org");
  EXPECT_THAT(client.read(), StartsWith("HTTP/1.1 403"));
}

TEST_F(BridgeServer, a_handshake_without_its_subprotocol_path_or_place_is_refused) {
  for (const char* good : {"foxglove.sdk.v1", "foxglove.websocket.v1", "other, foxglove.sdk.v1"})
    EXPECT_THAT(WebSocketClient(server->port(), good).read("serverInfo"), HasSubstr("101")) << good;
  for (const char* bad : {"", "foxglove.websocket.v2", "foxglove"})
    EXPECT_THAT(WebSocketClient(server->port(), bad).read("\n\n"), StartsWith("HTTP/1.1 400"))
        << bad;
  EXPECT_THAT(WebSocketClient(server->port(), "foxglove.sdk.v1", {}, "/page.js").read(),
              StartsWith("HTTP/1.1 400"));
  const std::string own = "Origin: http://127.0.0.1:" + std::to_string(server->port()) + "\r\n";
  EXPECT_THAT(WebSocketClient(server->port(), "foxglove.sdk.v1", own).read("serverInfo"),
              HasSubstr("101"));
  EXPECT_THAT(
      WebSocketClient(server->port(), "foxglove.sdk.v1", "Origin: https://example.com\r\n").read(),
      StartsWith("HTTP/1.1 403"));
}

TEST_F(BridgeServer, takes_commands_with_the_token_only_and_counts_the_refusals) {
  server->commands().set_takers({.supervisor = true, .simulator = true});
  const std::string give = R"({"task":"give","object":"mug"})";
  EXPECT_THAT(command(give), testing::AllOf(StartsWith("HTTP/1.1 202"), HasSubstr("\"task\":")));
  const std::string own = "Origin: http://127.0.0.1:" + std::to_string(server->port()) + "\r\n";
  EXPECT_THAT(command(R"({"person":"anna","action":"leave"})", kToken, own),
              StartsWith("HTTP/1.1 202"));
  EXPECT_THAT(command(give, ""), StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(command(give, "0123456789abcdef0123456789abcdee"), StartsWith("HTTP/1.1 401"));
  // Programs from elsewhere that may only read may not command.
  EXPECT_THAT(command(give, kToken, "Origin: https://example.org\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(command("{}"), testing::AllOf(StartsWith("HTTP/1.1 400"), HasSubstr("either")));
  EXPECT_THAT(command(std::string(5000, ' ') + give), StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(command(give, kToken, {}, "/commands"), StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(ask("GET", "/command"), StartsWith("HTTP/1.1 404"));
  EXPECT_EQ(server->commands().take().size(), 2u);
  EXPECT_EQ(counters()["commands"], 2);
  EXPECT_GE(counters()["refused_requests"], 7);
}

TEST_F(BridgeServer, refuses_commands_that_nobody_takes_and_too_many) {
  EXPECT_THAT(command(R"({"task":"pause"})"),
              testing::AllOf(StartsWith("HTTP/1.1 503"), HasSubstr("the supervisor is not there")));
  unsigned admitted = 0;
  std::string last;
  for (unsigned i = 0; i < 3 * CommandGate::kMaxPerSecond; ++i) {
    last = command("{}");
    if (!last.starts_with("HTTP/1.1 400")) break;
    ++admitted;
  }
  EXPECT_THAT(last, testing::AllOf(StartsWith("HTTP/1.1 429"), HasSubstr("in a second")));
  EXPECT_GE(admitted, CommandGate::kMaxPerSecond - 1);
}

TEST_F(BridgeServer, without_a_token_only_shows) {
  ServerSettings shows = settings();
  shows.token.clear();
  server = std::make_unique<Server>(shows, Site({}, resource_root()), catalogue(), "{}");
  EXPECT_THAT(command(R"({"task":"pause"})", ""),
              testing::AllOf(StartsWith("HTTP/1.1 404"), HasSubstr("without a token")));
  EXPECT_THAT(command(R"({"task":"pause"})"), StartsWith("HTTP/1.1 404"));
}

TEST_F(BridgeServer, passes_samples_on_and_gives_what_is_kept_to_who_comes_late) {
  const auto first = viewer();
  subscribe(*first, 2);
  publish(1, "one");
  EXPECT_THAT(first->read("one"),
              HasSubstr(std::string("\x01\x02\0\0\0\x07\0\0\0\0\0\0\0one", 16)));
  const auto late = viewer();
  late->forget();
  subscribe(*late, 2);
  EXPECT_THAT(late->read("one"), HasSubstr("one"));
  publish(0, "nobody asked");
  publish(1, "two");
  EXPECT_THAT(late->read("two"), Not(HasSubstr("nobody")));
}

TEST_F(BridgeServer, garbage_and_oversized_requests_close_the_connection_and_nothing_else) {
  for (const std::string& bytes :
       {std::string("\x16\x03\x01\x02"), std::string(200000, 'a'),
        "GET / HTTP/1.1\r\n" + std::string(20000, 'h') + ": x\r\n\r\n",
        std::string("GET /\r\n\r\n"),
        std::string("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 10000000\r\n\r\n")}) {
    HttpClient client(server->port());
    client.send(bytes);
    EXPECT_THAT(client.read(), Not(StartsWith("HTTP/1.1 200")));
  }
  EXPECT_THAT(ask("GET", "/"), StartsWith("HTTP/1.1 200"));
}

TEST_F(BridgeServer, a_client_that_says_nothing_is_let_go) {
  HttpClient client(server->port());
  ASSERT_TRUE(client.connected());
  EXPECT_EQ(client.read(), "");  // the server closes after request_timeout
}

TEST_F(BridgeServer, garbage_frames_are_answered_or_cut_counted_and_cost_others_nothing) {
  const auto other = viewer();
  subscribe(*other, 1);
  const auto talker = viewer();
  talker->frame(WebSocketClient::kText, "{broken");
  EXPECT_THAT(talker->read("status"), HasSubstr("must be a JSON object"));
  talker->frame(WebSocketClient::kBinary, std::string("\x01\0\0\0\0", 5));
  EXPECT_THAT(talker->read("publishing"), HasSubstr("only shows"));
  const auto liar = viewer();
  liar->send(std::string(20, '\xff'));  // not a frame
  liar->read();
  const auto large = viewer();
  large->frame(WebSocketClient::kText, std::string(10'000'000, '{'));
  large->read();
  const auto announced = viewer();
  announced->frame(WebSocketClient::kBinary, {}, 1ull << 60);
  announced->read();
  EXPECT_GE(counted("refused_messages", 3), 3u);
  publish(0, "still here");
  EXPECT_THAT(other->read("still here"), HasSubstr("still here"));
}

TEST_F(BridgeServer, more_clients_than_allowed_are_refused_with_a_reason) {
  std::deque<std::unique_ptr<WebSocketClient>> viewers;
  for (int i = 0; i < 4; ++i) viewers.push_back(viewer());
  EXPECT_THAT(WebSocketClient(server->port()).read(),
              testing::AllOf(StartsWith("HTTP/1.1 503"), HasSubstr("4 viewers already")));
  viewers.pop_back();
  ASSERT_TRUE(comes_true([&] { return counters()["clients"].get<std::uint64_t>() <= 3; }));
  EXPECT_THAT(WebSocketClient(server->port()).read("serverInfo"), HasSubstr("101"));
}

TEST_F(BridgeServer, many_connections_and_floods_leave_memory_flat) {
  const auto storm = [&] {
    std::deque<HttpClient> idle;
    for (int i = 0; i < 100; ++i) idle.emplace_back(server->port());
    for (HttpClient& client : idle) client.request("GET", "/../../etc/passwd");
    idle.clear();
    // The server detects one by one that they have disconnected.
    ASSERT_TRUE(comes_true([&] { return !ask("GET", "/").starts_with("HTTP/1.1 503"); }));
    const auto flooder = viewer();
    for (int i = 0; i < 3000; ++i)
      flooder->frame(WebSocketClient::kText,
                     R"({"op":"getParameters","parameterNames":[],"id":"x"})");
    flooder->read();
  };
  storm();
  const double before = resident_mb();
  for (int i = 0; i < 3; ++i) storm();
  EXPECT_LT(resident_mb() - before, 20.0);
  EXPECT_GE(counted("refused_connections", 1), 1u);
  EXPECT_GE(counted("cut_clients", 4), 4u);
  EXPECT_THAT(ask("GET", "/"), StartsWith("HTTP/1.1 200"));
}

TEST_F(BridgeServer, a_stalled_viewer_is_cut_and_costs_the_others_nothing) {
  const auto stalled = viewer(), reader = viewer();
  subscribe(*stalled, 1);
  subscribe(*reader, 1);
  constexpr std::size_t kSize = 4'000'000;
  const double before = resident_mb();
  int count = 0;
  comes_true([&] {
    const std::string mark = "sample" + std::to_string(count++) + ".";
    publish(0, mark, kSize);
    reader->forget();
    EXPECT_THAT(reader->read(mark).size(), testing::Gt(0u));
    return counters()["cut_clients"].get<std::uint64_t>() > 0;
  });
  EXPECT_EQ(counted("cut_clients", 1), 1u);
  EXPECT_GT(counted("dropped_samples", 1), 0u);
  EXPECT_LT(resident_mb() - before, 100.0);
}

TEST_F(BridgeServer, a_taken_port_is_named) {
  ServerSettings second = settings();
  second.port = server->port();
  try {
    const Server other(second, Site({}, resource_root()), catalogue(), "{}");
    FAIL() << "two servers on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("port " + std::to_string(server->port()) +
                                        " on 127.0.0.1 cannot be used"));
  }
}

TEST_F(BridgeServer, without_a_page_says_how_to_get_one) {
  const Server bare(settings(), Site({}, resource_root()), catalogue(), "{}");
  HttpClient client(bare.port());
  client.request("GET", "/");
  EXPECT_THAT(client.read(), HasSubstr("the page is not built"));
}

}  // namespace
}  // namespace handsel::bridge::bridge_server_test
