#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <thread>

#include <nlohmann/json.hpp>

#include "common/base/errors.hpp"
#include "common/bus/node_context.hpp"
#include "common/config/bridge.pb.h"
#include "common/config/resources.hpp"
#include "common/model/hand_model.hpp"
#include "deploy/handsel/commands.hpp"
#include "deploy/handsel/session.hpp"
#include "deploy/handsel/status.hpp"
#include "deploy/handsel/system_options.hpp"
#include "deploy/handsel/terminal.hpp"

namespace handsel {
namespace {

enum class Result { good, note, bad };

struct Finding {
  std::string subject;
  Result result{};
  std::string text;  ///< one sentence; for bad ones what to do
};

Finding check_processes() {
  try {
    system_processes({.robot = "jido"});
    return {"processes", Result::good, "all " + std::to_string(kProcesses.size()) + " are built"};
  } catch (const std::exception& error) {
    return {"processes", Result::bad, error.what()};
  }
}

Finding check_models(const std::string& robot, const std::string& scenario) {
  try {
    check_system({.robot = robot, .scenario = scenario});
    const NodeContext context = load_context(robot_of({.robot = robot, .scenario = scenario}), scenario);
    if (!context.robot->hand().empty()) HandModel::load(hand_description(context.robot->hand()));
    return {"models", Result::good,
            context.robot->name() + " with " + std::to_string(context.robot->dof()) + " axes, its hand and the objects of " + scenario};
  } catch (const std::exception& error) {
    return {"models", Result::bad, error.what()};
  }
}

Finding check_port() {
  config::BridgeSettings settings;
  load_text_proto(resource("config/bridge.txtpb"), settings);
  const int socket_fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(settings.port()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int reuse = 1;
  setsockopt(socket_fd, SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof reuse);
  const bool is_free = bind(socket_fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  close(socket_fd);
  const std::string port = std::to_string(settings.port());
  if (is_free) return {"port", Result::good, "port " + port + " of the page is free"};
  return {"port", Result::note,
          "port " + port + " of the page is taken; a system that starts now shows no page: choose another with --port"};
}

Finding check_limits() {
  rlimit priority{}, memory{};
  getrlimit(RLIMIT_RTPRIO, &priority);
  getrlimit(RLIMIT_MEMLOCK, &memory);
  const bool realtime = geteuid() == 0 || priority.rlim_cur > 0;
  if (realtime) return {"real time", Result::good, "processes may ask for real-time priority"};
  return {"real time", Result::note, "real-time priority is not permitted (rtprio in /etc/security/limits.conf); expect more late cycles"};
}

Finding check_machine() {
  const unsigned cores = std::thread::hardware_concurrency();
  const long mb = sysconf(_SC_PHYS_PAGES) / 1024 * (sysconf(_SC_PAGESIZE) / 1024);
  const std::string text = std::to_string(cores) + " cores, " + std::to_string(mb) + " MB of memory";
  if (cores < 2 || mb < 2000) return {"machine", Result::note, text + "; two cores and 2 GB are the least that was tried"};
  return {"machine", Result::good, text};
}

/// Speaks on the domain from a process of its own until it is killed.
pid_t start_speaker(int domain) {
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid != 0) return pid;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);
  DdsBus bus({.component = "doctor", .domain = static_cast<std::uint32_t>(domain), .health = false});
  auto publisher = bus.advertise<StateVerdict>();
  bus.every(from_seconds(0.05),
            [&](TimePoint) { publisher->publish({.id = {.client = static_cast<std::uint64_t>(parent), .number = 1}}); });
  bus.run();
  _exit(0);
}

/// Two processes of this machine find each other over DDS. Before any other participant of this process: it forks.
Finding check_reachability(int domain) {
  const pid_t speaker = start_speaker(domain);
  const TimePoint begin = monotonic_now();
  bool heard = false;
  {
    DdsBus bus({.component = "doctor", .domain = static_cast<std::uint32_t>(domain), .health = false});
    bus.subscribe<StateVerdict>(
        [&](const StateVerdict& verdict, const Receipt&) { heard = heard || verdict.id.client == static_cast<std::uint64_t>(getpid()); });
    bus.every(from_seconds(0.02), [](TimePoint) {});
    bus.run_until([&] { return heard; }, from_seconds(3.0));
  }
  const double took = to_seconds(monotonic_now() - begin);
  kill(speaker, SIGKILL);
  waitpid(speaker, nullptr, 0);
  char text[96];
  std::snprintf(text, sizeof text, "two processes on domain %d heard each other after %.0f ms", domain, 1e3 * took);
  if (heard) return {"DDS", Result::good, text};
  return {
      "DDS", Result::bad,
      "two processes on domain " + std::to_string(domain) + " do not hear each other: look at CYCLONEDDS_URI and the loopback interface"};
}

void check_system_on(int domain, std::vector<Finding>& findings) {
  Session session(domain);
  session.listen(from_seconds(1.2));
  if (session.snapshot().health.empty()) {
    findings.push_back({"system", Result::note, "none runs on domain " + std::to_string(domain) + " now"});
    return;
  }
  const SystemStatus status = make_status(session.snapshot(), session.bus().now());
  for (const std::string& trouble : status.troubles) findings.push_back({"system", Result::note, trouble});
  if (status.troubles.empty())
    findings.push_back({"system", Result::good, "runs on domain " + std::to_string(domain) + ", all processes ok"});
  double offset = 0.0;
  for (const auto& [component, seen] : session.snapshot().health) {
    const double here = to_seconds(Duration(session.bus().stamp_now())) - to_seconds(session.bus().now() - seen.arrival);
    offset = std::max(offset, std::abs(here - to_seconds(Duration(seen.sample.stamp))));
  }
  char text[96];
  std::snprintf(text, sizeof text, "clocks differ by at most %.1f ms", 1e3 * offset);
  findings.push_back({"clocks", offset < 0.05 ? Result::good : Result::bad,
                      offset < 0.05 ? text : std::string(text) + "; run chrony or PTP on the hosts"});
}

struct DoctorOptions {
  int domain{0};
  bool json{false};
  std::string robot, scenario{"give_mug"};
};

int examine(const DoctorOptions& options) {
  catch_interrupts();
  std::vector<Finding> findings{check_machine(), check_processes(), check_models(options.robot, options.scenario), check_port(),
                                check_limits()};
  findings.push_back(check_reachability(options.domain));
  check_system_on(options.domain, findings);
  bool good = true;
  for (const Finding& finding : findings) {
    const char* mark = finding.result == Result::good ? "ok" : finding.result == Result::note ? "note" : "bad";
    good = good && finding.result != Result::bad;
    if (json_wanted(options.json)) {
      std::printf("%s\n", nlohmann::json{{"subject", finding.subject}, {"result", mark}, {"text", finding.text}}.dump().c_str());
    } else {
      std::printf("%-5s %-10s %s\n", mark, finding.subject.c_str(), finding.text.c_str());
    }
  }
  return good ? 0 : 1;
}

}  // namespace

void add_doctor_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand("doctor", "what would stop it from working here");
  add_domain_option(*command, options->domain);
  command->add_option("--robot", options->robot, "robot description (default: jido)");
  command->add_option("--scenario", options->scenario, "scenario whose models are read")->capture_default_str();
  command->add_flag("--json", options->json, "print JSON Lines");
  command->callback([options, &exit_code] { exit_code = examine(*options); });
}

}  // namespace handsel
