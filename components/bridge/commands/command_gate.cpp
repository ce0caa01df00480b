// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/commands/command_gate.hpp"

#include <algorithm>

#include "common/base/errors.hpp"

namespace handsel::bridge {

namespace {

constexpr std::size_t kMinToken = 16, kMaxToken = 128;  // [characters]
constexpr std::string_view kScheme = "Bearer ";

}  // namespace

void check_token(const std::string& token) {
  const bool plain = std::all_of(token.begin(), token.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
           c == '_';
  });
  if (token.empty() || (plain && token.size() >= kMinToken && token.size() <= kMaxToken)) return;
  throw ConfigError("HANDSEL_WEB_TOKEN must have " + std::to_string(kMinToken) + " to " +
                    std::to_string(kMaxToken) + " letters, digits, \"-\" or \"_\"");
}

bool CommandGate::is_right(std::string_view token) const {
  unsigned difference = token.size() == token_.size() ? 0 : 1;
  for (std::size_t i = 0; i < token_.size(); ++i) {
    const char given = token.empty() ? '\0' : token[i % token.size()];
    difference |= static_cast<unsigned char>(given ^ token_[i]);
  }
  return difference == 0;
}

CommandGate::Answer CommandGate::admit(const CommandHeaders& headers, TimePoint now) {
  if (token_.empty())
    return {Verdict::closed, "this bridge was started without a token and only shows"};
  if (!headers.origin.empty() && headers.origin != "http://" + std::string(headers.host))
    return {Verdict::foreign, "only the page of this bridge may command"};
  if (!headers.authorization.starts_with(kScheme))
    return {Verdict::no_token,
            "a command needs the token at the end of the address that handsel up has printed"};
  if (!is_right(headers.authorization.substr(kScheme.size())))
    return {Verdict::wrong_token,
            "the token is not the one of this system; open the address that handsel up has "
            "printed"};
  if (!limit_.admit(now))
    return {Verdict::too_many,
            "more than " + std::to_string(kMaxPerSecond) + " commands in a second"};
  return {Verdict::admitted, {}};
}

}  // namespace handsel::bridge
