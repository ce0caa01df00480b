// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "common/base/errors.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/doctor/doctor.hpp"
#include "deploy/handsel/system/session.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel {
namespace {

const char* mark(Verdict verdict) {
  switch (verdict) {
    case Verdict::good:
      return "ok";
    case Verdict::note:
      return "note";
    case Verdict::bad:
      return "bad";
    case Verdict::missing:
      return "missing";
  }
  return "unknown";
}

void print(const Finding& finding, bool json) {
  if (json) {
    nlohmann::json line{
        {"subject", finding.subject}, {"result", mark(finding.verdict)}, {"text", finding.text}};
    if (!finding.remedy.empty()) line["remedy"] = finding.remedy;
    std::printf("%s\n",
                line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else {
    std::printf("%-7s  %-12s  %s\n", mark(finding.verdict), finding.subject.c_str(),
                finding.text.c_str());
    if (!finding.remedy.empty())
      std::printf("%-7s  %-12s  -> %s\n", "", "", finding.remedy.c_str());
  }
  std::fflush(stdout);
}

int examine(const DoctorOptions& options, bool json) {
  catch_interrupts();
  Verdict worst = Verdict::good;
  using Check = std::vector<Finding> (*)(const DoctorOptions&);
  std::vector<Check> checks;
  if (!options.inputs_only)
    checks = {[](const DoctorOptions&) { return check_machine(); }, &check_descriptions,
              &check_occupation, &check_domain};
  if (options.perception) checks.push_back(&check_perception);
  for (const Check check : checks) {
    for (const Finding& finding : check(options)) {
      print(finding, json);
      worst = std::max(worst, finding.verdict);
    }
    if (interrupted()) return 1;
  }
  return worst == Verdict::missing ? 3 : worst == Verdict::bad ? 1 : 0;
}

}  // namespace

void add_doctor_command(CLI::App& app, int& exit_code) {
  struct Options {
    DoctorOptions doctor;
    bool json{false};
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("doctor",
                                         "checks whether the system can work on this machine; exit "
                                         "code 1: a check failed, 3: something is missing");
  add_domain_option(*command, options->doctor.domain);
  command->add_option("--robot", options->doctor.robot,
                      "robot description (default: the scenario's)");
  command
      ->add_option("--scenario", options->doctor.scenario, "scenario whose descriptions are read")
      ->capture_default_str();
  command
      ->add_option("--port", options->doctor.web_port,
                   "port of the page (default: as in the bridge's settings)")
      ->check(CLI::Range(0, 65535));
  command->add_flag("--perception", options->doctor.perception,
                    "check that people and objects are observed on the domain, and that the "
                    "observations are valid");
  command->add_flag("--inputs-only", options->doctor.inputs_only,
                    "with --perception: check nothing else (3 s)");
  command->add_flag("--driver", options->doctor.driver,
                    "check that a robot is connected on the domain");
  command->add_flag("--json", options->json, "print JSON Lines");
  command->callback([options, &exit_code] {
    if (options->doctor.inputs_only && !options->doctor.perception)
      throw ConfigError("--inputs-only needs --perception");
    exit_code = examine(options->doctor, json_wanted(options->json));
  });
}

}  // namespace handsel
