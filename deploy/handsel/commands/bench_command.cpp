// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/errors.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/commands.hpp"

namespace handsel {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// Values of the peer on 2 vCPU (Zen 4, AVX-512), used if the peer is not built; method:
/// docs/trajectory.md.
struct Recorded {
  const char *benchmark, *peer;
  double ns;
};
constexpr const char* kRuckig = "Ruckig 0.17.3";
constexpr std::array kRecorded{Recorded{"synchronised/rest_to_rest", kRuckig, 3230},
                               Recorded{"synchronised/moving_to_rest", kRuckig, 6810},
                               Recorded{"synchronised/any_to_any", kRuckig, 10490},
                               Recorded{"eight_at_once/rest_to_rest", kRuckig, 3230},
                               Recorded{"eight_at_once/moving_to_rest", kRuckig, 6810},
                               Recorded{"eight_at_once/any_to_any", kRuckig, 10490},
                               Recorded{"evaluate", kRuckig, 36},
                               Recorded{"control_tick", kRuckig, 124},
                               Recorded{"smooth_ten_nodes", "MoveIt TOTG (no jerk)", 2.8e6}};

/// Returns whether a benchmark takes a filter and answers in JSON; the others print their results.
bool has_table(const fs::path& program) { return program.filename() == "bench_trajectory"; }

std::vector<fs::path> programs() {
  const fs::path folder = fs::canonical("/proc/self/exe").parent_path();
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string().starts_with("bench_") && entry.is_regular_file())
      found.push_back(entry.path());
  }
  if (found.empty()) {
    throw MissingError(
        "no benchmark is beside " + folder.string() +
        "/handsel; build the targets bench_* (ninja -C build/release bench_trajectory)");
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::string quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string output_of(const std::string& command) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string out;
  std::array<char, 4096> bytes;
  for (std::size_t n; pipe && (n = std::fread(bytes.data(), 1, bytes.size(), pipe.get())) > 0;)
    out.append(bytes.data(), n);
  return out;
}

json rows_of(const fs::path& program, const std::string& filter) {
  std::string command = quoted(program.string()) + " --benchmark_format=json";
  if (!filter.empty()) command += " --benchmark_filter=" + quoted(filter);
  const json answer = json::parse(output_of(command + " 2>/dev/null"), nullptr, false);
  json rows = json::array();
  if (answer.is_discarded() || !answer.contains("benchmarks")) return rows;
  for (const json& b : answer["benchmarks"]) {
    const std::string name = b.at("name");
    json row{{"benchmark", name}, {"ns", b.value("ours_ns", b.value("cpu_time", 0.0))}};
    const auto known = std::find_if(kRecorded.begin(), kRecorded.end(),
                                    [&](const Recorded& r) { return name == r.benchmark; });
    if (known != kRecorded.end()) {
      const bool measured = b.contains("peer_ns");
      row["peer"] = known->peer;
      row["peer_ns"] = measured ? b["peer_ns"].get<double>() : known->ns;
      row["peer_measured"] = measured;
      row["ratio"] = row["peer_ns"].get<double>() / row["ns"].get<double>();
    }
    for (const char* more : {"failures", "longer"}) {
      if (b.contains(more)) row[more] = b[more];
    }
    if (b.contains("label")) row["inputs"] = b["label"];
    rows.push_back(row);
  }
  return rows;
}

void print(const json& row) {
  std::printf("%-36s %10.1f ns", row["benchmark"].get<std::string>().c_str(),
              row["ns"].get<double>());
  if (row.contains("ratio")) {
    std::printf("   %-22s %10.0f ns %s %6.1f x", row["peer"].get<std::string>().c_str(),
                row["peer_ns"].get<double>(),
                row["peer_measured"].get<bool>() ? "now     " : "recorded",
                row["ratio"].get<double>());
  }
  std::printf("\n");
}

void run_benchmarks(const std::string& filter, bool as_json, int& exit_code) {
  bool any = false;
  for (const fs::path& program : programs()) {
    const std::string name = program.filename().string();
    if (has_table(program)) {
      for (const json& row :
           rows_of(program, name.find(filter) == std::string::npos ? filter : "")) {
        any = true;
        as_json ? void(std::printf("%s\n", row.dump().c_str())) : print(row);
      }
    } else if (name.find(filter) != std::string::npos) {
      any = true;
      const std::string text = output_of(quoted(program.string()));
      as_json ? void(std::printf("%s\n", json{{"benchmark", name}, {"text", text}}
                                             .dump(-1, ' ', false, json::error_handler_t::replace)
                                             .c_str()))
              : void(std::printf("%s:\n%s", name.c_str(), text.c_str()));
    }
    std::fflush(stdout);
  }
  if (!any) {
    std::fprintf(stderr, "handsel: no benchmark is called \"%s\"\n", filter.c_str());
    exit_code = 1;
  }
}

}  // namespace

void add_bench_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "bench",
      "runs the benchmarks; prints each figure beside the figure of a peer, and their ratio");
  auto filter = std::make_shared<std::string>();
  auto as_json = std::make_shared<bool>(false);
  command->add_option(
      "FILTER", *filter,
      "run only benchmarks whose name, or whose program's name, contains this text (tests/bench)");
  command->add_flag("--json", *as_json, "print JSON Lines also on a terminal");
  command->callback(
      [filter, as_json, &exit_code] { run_benchmarks(*filter, json_wanted(*as_json), exit_code); });
}

}  // namespace handsel
