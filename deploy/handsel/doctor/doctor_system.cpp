// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <functional>

#include "common/base/errors.hpp"
#include "common/bus/node_context.hpp"
#include "common/config/resources.hpp"
#include "common/config/scenario.hpp"
#include "common/config/schema/bridge.pb.h"
#include "common/model/hand_model.hpp"
#include "components/spark/calibration.hpp"
#include "deploy/handsel/doctor/doctor.hpp"
#include "deploy/handsel/eval/lockstep_system.hpp"
#include "deploy/handsel/system/launcher.hpp"
#include "deploy/handsel/system/machine.hpp"
#include "deploy/handsel/system/processes.hpp"

namespace handsel {
namespace {

/// Runs `load`, which returns the text of a good finding.
Finding attempt(const std::string& subject, const std::function<std::string()>& load) {
  try {
    return {subject, Verdict::good, load(), ""};
  } catch (const MissingError& error) {
    return {subject, Verdict::missing, error.what(),
            "put the file there, or correct what names it"};
  } catch (const std::exception& error) {
    return {subject, Verdict::bad, error.what(),
            "correct it; `handsel model check` says more about a robot"};
  }
}

int page_port(const DoctorOptions& options) {
  if (options.web_port >= 0) return options.web_port;
  if (const char* text = std::getenv("HANDSEL_WEB_PORT"); text && *text) return std::atoi(text);
  config::BridgeSettings settings;
  load_text_proto(resource("config/bridge.txtpb"), settings);
  return static_cast<int>(settings.port());
}

bool is_free(int port) {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int reuse = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof reuse);
  const bool bound =
      bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 && listen(fd, 1) == 0;
  close(fd);
  return bound;
}

bool plays_on(const RunningProcess& process, int domain) {
  if (process.name.rfind("handsel_", 0) != 0) return false;
  const auto at = std::find(process.arguments.begin(), process.arguments.end(), "--domain");
  return at != process.arguments.end() && at + 1 != process.arguments.end() &&
         *(at + 1) == std::to_string(domain);
}

Finding check_port(const DoctorOptions& options, const std::vector<RunningProcess>& here) {
  const int number = page_port(options);
  const std::string port = "port " + std::to_string(number) + " of the page";
  if (number == 0 || is_free(number)) return {"port", Verdict::good, port + " is free", ""};
  const std::string holder = port_holder("tcp", number);
  for (const RunningProcess& process : here) {
    if (holder.ends_with("(pid " + std::to_string(process.pid) + ")"))
      return {"port", Verdict::good,
              port + " serves the system on domain " + std::to_string(options.domain), ""};
  }
  return {"port", Verdict::bad,
          port + " is taken" + (holder.empty() ? "" : " by " + holder) +
              "; a system that starts now shows no page",
          "end what holds it, or choose another with --port"};
}

Finding check_calibration() {
  const std::string file = (resource_root() / "config/calibration.txtpb").string();
  if (!std::filesystem::exists(file))
    return {"calibration", Verdict::note,
            file + " is not there: every source is taken to speak in frame world",
            "write one; docs/calibration.md says how"};
  try {
    const spark::Calibration calibration(file);
    const std::time_t now = std::time(nullptr);
    char today[16];
    std::strftime(today, sizeof today, "%Y-%m-%d", std::gmtime(&now));
    std::string stale;
    const auto add_age = [&](const std::string& what, const std::string& measured) {
      const auto days = spark::days_between(measured, today);
      if (!days) return;
      if (*days < -1)
        stale += (stale.empty() ? "" : ", ") + what + " was measured on " + measured +
                 ", which is not yet";
      if (calibration.valid_days() > 0 && *days > calibration.valid_days())
        stale += (stale.empty() ? "" : ", ") + what + " was measured " +
                 std::to_string(static_cast<int>(*days)) + " days ago";
    };
    for (const auto& [name, source] : calibration.sources())
      add_age("source " + name, source.measured);
    for (const auto& [name, robot] : calibration.robots()) add_age("robot " + name, robot.measured);
    if (!stale.empty())
      return {"calibration", Verdict::note, stale, "measure again, and write the date to " + file};
    const std::size_t count = calibration.sources().size();
    return {"calibration", Verdict::good,
            count == 0 ? "no source is listed: each speaks in frame world"
                       : std::to_string(count) + " sources and " +
                             std::to_string(calibration.robots().size()) + " robots",
            ""};
  } catch (const std::exception& error) {
    return {"calibration", Verdict::bad, error.what(),
            "correct it; docs/calibration.md says what stands there"};
  }
}

std::string names(const std::vector<RunningProcess>& processes) {
  std::string text;
  for (const RunningProcess& process : processes)
    text +=
        (text.empty() ? "" : ", ") + process.name + " (pid " + std::to_string(process.pid) + ")";
  return text;
}

Finding check_leftovers(const DoctorOptions& options, const std::vector<RunningProcess>& here) {
  const std::string domain = "domain " + std::to_string(options.domain);
  if (here.empty())
    return {"processes", Verdict::good, "no process of Handsel is on " + domain + " here", ""};
  if (!domain_is_held(options.domain)) {
    return {"processes", Verdict::bad,
            "processes without a `handsel` that watches them are on " + domain + ": " + names(here),
            "end them with kill, or choose another domain with --domain"};
  }
  std::vector<RunningProcess> stopped, replaced;
  for (const RunningProcess& process : here) {
    if (process.state == 'T' || process.state == 't') stopped.push_back(process);
    if (process.replaced) replaced.push_back(process);
  }
  if (!stopped.empty())
    return {"processes", Verdict::bad, "processes on " + domain + " are stopped: " + names(stopped),
            "continue them with kill -CONT, or stop the system"};
  if (!replaced.empty()) {
    return {"processes", Verdict::bad,
            "processes on " + domain + " are older than their program files: " + names(replaced),
            "stop the system and start it again"};
  }
  return {"processes", Verdict::good,
          std::to_string(here.size()) + " processes of Handsel are on " + domain + " here", ""};
}

}  // namespace

std::vector<Finding> check_descriptions(const DoctorOptions& options) {
  std::vector<Finding> out;
  config::Scenario scenario;
  out.push_back(attempt("scenario", [&] {
    scenario = read_scenario(scenario_file(options.scenario), SystemOptions{}.seed);
    return options.scenario;
  }));
  std::string robot, hand;
  out.push_back(attempt("robot", [&] {
    robot = robot_of({.robot = options.robot, .scenario = options.scenario});
    const RobotModel model = RobotModel::load(robot_description(robot));
    hand = model.hand();
    return model.name() + ", " + std::to_string(model.dof()) + " axes";
  }));
  if (!hand.empty()) {
    out.push_back(attempt("hand", [&] {
      HandModel::load(hand_description(hand));
      return hand;
    }));
  }
  out.push_back(attempt("objects", [&] {
    load_object_library();
    std::string text;
    for (const config::ObjectPlacement& object : scenario.objects()) {
      ObjectModel::load(object_description(object.model()));
      text += (text.empty() ? "" : ", ") + object.model();
    }
    return text.empty() ? std::string("the scenario has none") : text;
  }));
  out.push_back(check_calibration());
  const bool loads = std::all_of(out.begin(), out.end(), [](const Finding& finding) {
    return finding.verdict == Verdict::good;
  });
  if (loads) {
    out.push_back(attempt("settings", [&] {
      const LockstepSystem whole(load_context(robot, options.scenario));
      return std::string("every component starts with its settings and the scenario");
    }));
  }
  return out;
}

std::vector<Finding> check_occupation(const DoctorOptions& options) {
  std::vector<RunningProcess> here = running_processes();
  std::erase_if(here,
                [&](const RunningProcess& process) { return !plays_on(process, options.domain); });
  return {check_port(options, here), check_leftovers(options, here)};
}

}  // namespace handsel
