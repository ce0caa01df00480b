// SPDX-License-Identifier: Apache-2.0
// Every file that a user can name is checked: no bad file crashes or hangs a command or is read
// only in part. Each row runs the command as shipped. HANDSEL_BIN selects another folder of
// binaries, such as build/asan/bin; HANDSEL_BAD_FILES selects rows by a part of their names.
#include "tests/system/bad_files/bad_files.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include "tests/support/processes/temporary_folder.hpp"

namespace handsel::test {

namespace fs = std::filesystem;

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) {
    std::cerr << "bad_files: the good file has no " << from << "\n";
    std::abort();
  }
  return text.replace(at, from.size(), to);
}

std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

std::string source_file(const std::string& path) {
  std::ifstream in(fs::path(HANDSEL_SOURCE_DIR) / path, std::ios::binary);
  if (!in) {
    std::cerr << "bad_files: no " << path << "\n";
    std::abort();
  }
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

namespace {

constexpr double kMaxTime = 2.0;                // max processor time of a command [s]
constexpr std::chrono::seconds kKillAfter{40};  // after which a waiting command is killed
constexpr int kAtOnce = 4;  // parallel commands; most of them wait for the transport
constexpr const char* kDomain = "227";

struct Ended {
  int exit_code{-1}, signal{0};
  bool killed{false};
  double processor_time{0};  // [s]
  std::string out, err;
};

std::string content_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// Waits until the child has ended; kills it when its time is up.
Ended wait_for(pid_t child) {
  Ended ended;
  const int handle = static_cast<int>(syscall(SYS_pidfd_open, child, 0));
  EXPECT_GE(handle, 0) << std::strerror(errno);
  pollfd end{handle, POLLIN, 0};
  const auto patience = std::chrono::duration_cast<std::chrono::milliseconds>(kKillAfter);
  ended.killed = poll(&end, 1, static_cast<int>(patience.count())) != 1;
  if (ended.killed) kill(-child, SIGKILL);
  close(handle);
  rusage used{};
  int status = 0;
  wait4(child, &status, 0, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  ended.processor_time = seconds(used.ru_utime) + seconds(used.ru_stime);
  if (WIFEXITED(status)) ended.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) ended.signal = WTERMSIG(status);
  return ended;
}

std::string binaries() {
  const char* given = std::getenv("HANDSEL_BIN");
  return given != nullptr ? given : fs::path(HANDSEL_COMMAND).parent_path().string();
}

/// Runs one row in a folder of its own.
Ended run(const BadFile& row, const fs::path& folder) {
  const fs::path file = folder / fs::path(row.name).filename();
  if (row.kind == BadFile::Kind::folder) fs::create_directories(file);
  if (row.kind == BadFile::Kind::file || row.kind == BadFile::Kind::unreadable)
    std::ofstream(file, std::ios::binary) << row.content;
  if (row.kind == BadFile::Kind::unreadable) fs::permissions(file, fs::perms::none);
  std::ofstream(folder / "stdin", std::ios::binary) << row.input;
  std::string command = row.command;
  const auto put = [&](const std::string& key, const std::string& value) {
    for (std::size_t at = 0; (at = command.find(key, at)) != std::string::npos; at += value.size())
      command.replace(at, key.size(), value);
  };
  put("{folder}", folder.string());
  put("{source}", HANDSEL_SOURCE_DIR);
  put("{}", file.string());
  put("{domain}", kDomain);
  const std::string program =
      command.rfind("handsel_", 0) == 0 || command.rfind("env ", 0) == 0 ? "" : "handsel ";
  const std::string line = "PATH=" + binaries() + ":$PATH; exec " + program + command + " <" +
                           (folder / "stdin").string() + " >" + (folder / "stdout").string() +
                           " 2>" + (folder / "stderr").string();
  const pid_t child = fork();
  if (child == 0) {
    setpgid(0, 0);
    setenv("XDG_CACHE_HOME", folder.c_str(), 1);
    execl("/bin/sh", "sh", "-c", line.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  Ended ended = wait_for(child);
  ended.out = content_of(folder / "stdout");
  ended.err = content_of(folder / "stderr");
  return ended;
}

/// Returns the fault in the end of a command; empty: none.
std::string complaint(const BadFile& row, const Ended& ended) {
  std::ostringstream what;
  const std::string& said = row.input.empty() ? ended.err : ended.out + ended.err;
  if (ended.killed) what << "hung; ";
  if (ended.signal != 0) what << "signal " << ended.signal << "; ";
  if (ended.exit_code != row.exit_code)
    what << "exit code " << ended.exit_code << " instead of " << row.exit_code << "; ";
  if (said.find(row.says) == std::string::npos) what << "does not say \"" << row.says << "\"; ";
  if (row.input.empty() && std::count(ended.err.begin(), ended.err.end(), '\n') != 1)
    what << "does not say one sentence; ";
  if (ended.err.size() > 1000) what << "says " << ended.err.size() << " bytes; ";
  if (said.find("runtime error:") != std::string::npos ||
      said.find("Sanitizer") != std::string::npos)
    what << "sanitizer; ";
  if (ended.processor_time > kMaxTime) what << "took " << ended.processor_time << " s; ";
  std::string text = what.str();
  if (!text.empty())
    text += "stdout: " + ended.out.substr(0, 300) + " stderr: " + ended.err.substr(0, 3000);
  return text;
}

BadFiles table() {
  BadFiles all;
  add_meshes(all);
  add_descriptions(all);
  add_settings(all);
  add_scenarios(all);
  add_recordings(all);
  add_lines(all);
  if (geteuid() == 0)
    std::erase_if(all, [](const BadFile& row) {
      return row.kind == BadFile::Kind::unreadable;
    });  // root can read the file
  return all;
}

TEST(BadFiles, the_table_has_two_hundred_rows_with_different_names) {
  std::set<std::string> names;
  for (const BadFile& row : table()) EXPECT_TRUE(names.insert(row.name).second) << row.name;
  EXPECT_GE(names.size(), 200u);
}

TEST(BadFiles, each_is_refused_in_one_sentence_with_exit_code_2_or_3) {
  const BadFiles rows = table();
  const char* only = std::getenv("HANDSEL_BAD_FILES");
  const TemporaryFolder folder;
  std::atomic<std::size_t> next{0}, done{0};
  std::mutex one_at_a_time;
  double longest = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < rows.size(); i = next++) {
      const BadFile& row = rows[i];
      if (only != nullptr && row.name.find(only) == std::string::npos) continue;
      const fs::path own = folder.path() / std::to_string(i);
      fs::create_directories(own);
      const Ended ended = run(row, own);
      const std::string wrong = complaint(row, ended);
      ++done;
      const std::scoped_lock lock(one_at_a_time);
      longest = std::max(longest, ended.processor_time);
      EXPECT_TRUE(wrong.empty()) << row.name << ": " << wrong;
    }
  };
  std::vector<std::thread> workers;
  for (int i = 0; i < kAtOnce; ++i) workers.emplace_back(work);
  for (std::thread& worker : workers) worker.join();
  std::cout << done << " bad files; the slowest took " << longest << " s of processor\n";
  EXPECT_GT(done, 0u);
}

}  // namespace
}  // namespace handsel::test
