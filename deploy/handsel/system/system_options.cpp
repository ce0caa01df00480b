// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/system_options.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "common/bus/dds/dds_defaults.hpp"
#include "common/config/overlay.hpp"

extern char** environ;

namespace handsel {

void add_domain_option(CLI::App& command, int& domain) {
  domain = default_domain();
  command.add_option("--domain", domain, "DDS domain (default: HANDSEL_DOMAIN, else 0)")
      ->check(CLI::Range(0, 230));
  command.add_option_function<std::string>(
      "--name",
      [](const std::string& name) {
        setenv("HANDSEL_NAME", name.c_str(), 1);
        system_name();
      },
      "name of this system, if several work in one domain (default: HANDSEL_NAME, else none)");
}

void add_system_options(CLI::App& command, SystemOptions& options) {
  add_domain_option(command, options.domain);
  command.add_option("--robot", options.robot,
                     "robot description: name or file (default: the scenario's)");
  command.add_option("scenario,--scenario", options.scenario, "scenario: name or file")
      ->capture_default_str();
  command.add_option("--seed", options.seed, "seed of all random choices")->capture_default_str();
  command
      .add_option("--port", options.web_port,
                  "port of the page; 0: any free one (default: as in the bridge's settings)")
      ->check(CLI::Range(0, 65535));
  command.add_option("--record", options.record, "record all messages into this MCAP file");
  command.add_flag("--ros2", options.ros2, "start the connection to ROS 2 too (docs/ros2.md)");
  add_help_hold_option(command);
  add_overlay_options(command);
}

void add_overlay_options(CLI::App& command) {
  auto overlays = std::make_shared<Overlays>();
  command
      .add_option("--config", overlays->files,
                  "file with settings of one or more components that replace the shipped ones; may "
                  "be repeated (docs/settings.md)")
      ->expected(1)
      ->take_all();
  command
      .add_option("--set", overlays->assignments,
                  "a setting, component.key=value, e.g. spark.grip_force=2; may be repeated")
      ->expected(1)
      ->take_all();
  command.parse_complete_callback([overlays] { use_overlays(*overlays); });
}

void add_help_hold_option(CLI::App& command) {
  command.add_flag_callback(
      "--help-hold", [] { setenv("HANDSEL_HELP_HOLD", "1", 1); },
      "a grasp constraint helps to hold what the robot grasps (default: contact alone)");
}

namespace {

/// Writes a file, readable by this user only, that sends a browser on to the address; returns its
/// path. On the command line of a browser every user of this machine could read the token.
std::string forwarding_file(const std::string& address, const std::filesystem::path& folder) {
  const std::string path = (folder / "page.html").string();
  const std::string text =
      "<!DOCTYPE html><meta http-equiv=\"refresh\" content=\"0;url=" + address + "\"><a href=\"" +
      address + "\">Handsel</a>\n";
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  const bool written =
      fd >= 0 && write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (fd >= 0) close(fd);
  return written ? path : address.substr(0, address.find('#'));
}

}  // namespace

void announce_page(System& system, bool headless) {
  const std::string address = system.web_address();
  if (address.empty()) {
    const Snapshot& now = system.session().snapshot();
    const auto bridge = now.health.find("bridge");
    const bool said = bridge != now.health.end() && !bridge->second.sample.reason.empty();
    std::fprintf(stderr, "no page: %s\n",
                 said ? bridge->second.sample.reason.c_str() : "the bridge has not opened it");
    return;
  }
  std::fprintf(stderr, "watch it at %s\n", address.c_str());
  const bool display = std::getenv("DISPLAY") || std::getenv("WAYLAND_DISPLAY");
  if (headless || !display) return;
  std::string opener = "xdg-open", argument = forwarding_file(address, system.log_directory());
  char* arguments[] = {opener.data(), argument.data(), nullptr};
  pid_t pid = -1;
  if (posix_spawnp(&pid, opener.c_str(), nullptr, nullptr, arguments, environ) == 0)
    waitpid(pid, nullptr, 0);
}

}  // namespace handsel
