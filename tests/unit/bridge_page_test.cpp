#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>

#include "components/bridge/http_server.hpp"
#include "tests/support/http_client.hpp"

namespace handsel::bridge {
namespace {

using test::HttpClient;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

struct BridgePage : testing::Test {
  HttpServer server{{.port = 0, .max_clients = 4, .request_timeout = 0.5}, page_files()};

  std::string ask(const std::string& method, const std::string& target) {
    HttpClient client(server.port());
    client.request(method, target);
    return client.read();
  }
};

TEST_F(BridgePage, serves_the_page_with_a_strict_policy_and_nothing_from_elsewhere) {
  const std::string page = ask("GET", "/");
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(page, HasSubstr("Content-Security-Policy: default-src 'none'"));
  EXPECT_THAT(page, HasSubstr("<title>Handsel</title>"));
  for (const auto& [path, bytes] : page_files()) {
    EXPECT_THAT(ask("GET", path), StartsWith("HTTP/1.1 200")) << path;
    EXPECT_THAT(std::string(bytes), Not(HasSubstr("https://"))) << path;
    EXPECT_THAT(std::string(bytes), Not(HasSubstr("http://"))) << path;
  }
}

TEST_F(BridgePage, gives_the_newest_state) {
  EXPECT_THAT(ask("GET", "/state"), HasSubstr("{}"));
  server.update(R"({"n":1})");
  server.update(R"({"n":2})");
  EXPECT_THAT(ask("GET", "/state"), HasSubstr(R"({"n":2})"));
}

TEST_F(BridgePage, streams_each_state_to_a_reader_that_keeps_up) {
  HttpClient client(server.port());
  client.request("GET", "/events");
  EXPECT_THAT(client.read("data: {}\n\n"), HasSubstr("text/event-stream"));
  for (int n = 1; n <= 3; ++n) {
    const std::string state = "{\"n\":" + std::to_string(n) + "}";
    server.update(state);
    EXPECT_THAT(client.read("data: " + state + "\n\n"), HasSubstr(state));
  }
}

TEST_F(BridgePage, only_reads) {
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "NONSENSE"})
    EXPECT_THAT(ask(method, "/state"), Not(StartsWith("HTTP/1.1 200"))) << method;
  EXPECT_THAT(ask("HEAD", "/"), Not(HasSubstr("<title>")));
}

TEST_F(BridgePage, gives_no_file_but_its_own) {
  for (const char* target : {"/../node.cpp", "/..%2f..%2fetc/passwd", "//etc/passwd", "/./index.html", "/web/index.html", "/index.html/",
                             "/events/x", "*", "http://127.0.0.1/etc/passwd"}) {
    EXPECT_THAT(ask("GET", target), StartsWith("HTTP/1.1 404")) << target;
  }
}

TEST_F(BridgePage, answers_only_under_its_own_name) {
  HttpClient client(server.port());
  client.request("GET", "/state", "example.org");
  EXPECT_THAT(client.read(), StartsWith("HTTP/1.1 403"));
}

TEST_F(BridgePage, garbage_and_oversized_requests_close_the_connection_and_nothing_else) {
  for (const std::string& bytes :
       {std::string("\x16\x03\x01\x02"), std::string(200000, 'a'), "GET / HTTP/1.1\r\n" + std::string(20000, 'h') + ": x\r\n\r\n",
        std::string("GET /\r\n\r\n"), std::string("POST /state HTTP/1.1\r\nHost: x\r\nContent-Length: 10000000\r\n\r\n")}) {
    HttpClient client(server.port());
    client.send(bytes);
    EXPECT_THAT(client.read(), Not(StartsWith("HTTP/1.1 200")));
  }
  EXPECT_THAT(ask("GET", "/"), StartsWith("HTTP/1.1 200"));
}

TEST_F(BridgePage, a_client_that_says_nothing_is_let_go) {
  HttpClient client(server.port());
  ASSERT_TRUE(client.connected());
  EXPECT_EQ(client.read(), "");  // the server closes after request_timeout
  EXPECT_THAT(ask("GET", "/"), StartsWith("HTTP/1.1 200"));
}

TEST_F(BridgePage, more_clients_than_allowed_are_refused_with_a_reason) {
  std::deque<HttpClient> readers;
  for (int i = 0; i < 4; ++i) {
    readers.emplace_back(server.port());
    readers.back().request("GET", "/events");
    readers.back().read("data:");
  }
  HttpClient one_more(server.port());
  one_more.request("GET", "/");
  EXPECT_THAT(one_more.read(), StartsWith("HTTP/1.1 503"));
}

TEST_F(BridgePage, a_stalled_reader_is_cut_and_costs_the_others_nothing) {
  HttpClient stalled(server.port()), reader(server.port());
  stalled.request("GET", "/events");
  stalled.read("data:");
  reader.request("GET", "/events");
  reader.read("data:");
  const std::string large(4000000, 'x');
  for (int n = 0; n < 40 && server.clients() > 1; ++n) {
    const std::string last = "last" + std::to_string(n);
    server.update(large + last);
    EXPECT_THAT(reader.read(last + "\n\n").size(), testing::Gt(large.size()));
    reader.forget();
    usleep(20000);
  }
  EXPECT_EQ(server.clients(), 1u);
}

TEST_F(BridgePage, a_taken_port_is_named) {
  try {
    const HttpServer second({.port = server.port()}, page_files());
    FAIL() << "two servers on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("port " + std::to_string(server.port())));
  }
}

}  // namespace
}  // namespace handsel::bridge
