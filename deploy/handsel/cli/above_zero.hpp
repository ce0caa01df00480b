// SPDX-License-Identifier: Apache-2.0
// What an option that counts or measures something must be; the library's own check names the
// largest number there is when it is not.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace handsel {

inline const CLI::Validator kAboveZero(
    [](const std::string& text) {
      double value = 0;
      const bool good = CLI::detail::lexical_cast(text, value) && value > 0;
      return good ? std::string() : "must be a number above 0, not '" + text + "'";
    },
    "POSITIVE");

}  // namespace handsel
