// SPDX-License-Identifier: Apache-2.0
// Who may command: the holder of the token that `handsel up` creates, from this page, not too
// often. Pure.
#pragma once

#include <string>
#include <string_view>

#include "common/base/time.hpp"
#include "components/bridge/rate_limit.hpp"

namespace handsel::bridge {

/// Throws ConfigError with one sentence unless the token is empty or has 16 to 128 letters, digits,
/// "-" or "_". The sentence does not contain the token.
void check_token(const std::string& token);

/// Headers of a request for a command, each empty where the request has none.
struct CommandHeaders {
  std::string_view authorization;  ///< "Bearer TOKEN"
  std::string_view origin;         ///< page that asks, as "http://127.0.0.1:8765"; empty: no page
  std::string_view host;           ///< name under which this server was asked
};

class CommandGate {
 public:
  static constexpr unsigned kMaxPerSecond = 60;  ///< commands of all holders of the token

  enum class Verdict { admitted, closed, foreign, no_token, wrong_token, too_many };
  struct Answer {
    Verdict verdict{};    ///< whether the command may be given
    std::string refusal;  ///< one sentence for people; empty when admitted
  };

  /// `token`: empty: nobody may command.
  explicit CommandGate(std::string token) : token_(std::move(token)) {}

  /// Decides about one request. The time that a comparison of tokens takes depends on the length of
  /// the right token only.
  Answer admit(const CommandHeaders& headers, TimePoint now);

 private:
  bool is_right(std::string_view token) const;

  std::string token_;
  RateLimit limit_{kMaxPerSecond};
};

}  // namespace handsel::bridge
