// SPDX-License-Identifier: Apache-2.0
// Runs a command line in a shell and returns its output.
#pragma once

#include <sys/wait.h>

#include <unistd.h>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace handsel::test {

struct Outcome {
  int exit_code{-1};
  std::string out, err;
};

inline Outcome shell(const std::string& command) {
  const std::filesystem::path errors =
      std::filesystem::temp_directory_path() / ("handsel-err-" + std::to_string(getpid()));
  Outcome outcome;
  std::FILE* pipe = popen(("{ " + command + "; } 2>" + errors.string()).c_str(), "r");
  char bytes[4096];
  for (std::size_t n; (n = std::fread(bytes, 1, sizeof bytes, pipe)) > 0;)
    outcome.out.append(bytes, n);
  const int status = pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  std::ostringstream text;
  text << std::ifstream(errors).rdbuf();
  outcome.err = text.str();
  std::filesystem::remove(errors);
  return outcome;
}

}  // namespace handsel::test
