// SPDX-License-Identifier: Apache-2.0
// Reads deploy/docker-compose.yml in its fixed style: services are indented by two, their entries
// by four.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace handsel::test {

inline std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// The text of each service, by its name.
inline std::map<std::string, std::string> compose_services(const std::string& compose) {
  std::map<std::string, std::string> out;
  const std::string head = "\nservices:\n";
  std::istringstream lines(compose.substr(compose.find(head) + head.size()));
  std::string name;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, std::regex("  (\\w+):( \\*\\w+)?"))) name = match[1];
    if (!line.empty() && line[0] != ' ') break;
    out[name] += line + "\n";
  }
  return out;
}

/// The words of a service's command, variables replaced by `values`, else by their defaults.
inline std::vector<std::string> compose_command(
    const std::string& service, const std::map<std::string, std::string>& values = {}) {
  std::smatch match;
  std::vector<std::string> words;
  if (!std::regex_search(service, match, std::regex("\n    command: \\[(.*)\\]"))) return words;
  std::istringstream list(match[1]);
  for (std::string word; std::getline(list, word, ',');) {
    std::erase_if(word, [](char c) { return c == ' ' || c == '"'; });
    std::smatch variable;
    if (std::regex_match(word, variable, std::regex("\\$\\{(\\w+):-(.+)\\}")))
      word = values.contains(variable[1]) ? values.at(variable[1]) : variable[2].str();
    words.push_back(word);
  }
  return words;
}

}  // namespace handsel::test
