// SPDX-License-Identifier: Apache-2.0
// Options that hold finite numbers; the library's own checks take infinities and print the largest
// number there is.
#pragma once

#include <cmath>
#include <string>

#include <CLI/CLI.hpp>

namespace handsel {

inline const CLI::Validator kNotNegative(
    [](const std::string& text) {
      double value = 0;
      const bool good =
          CLI::detail::lexical_cast(text, value) && value >= 0 && std::isfinite(value);
      return good ? std::string()
                  : "must be a number of at least 0, not '" + text.substr(0, 60) + "'";
    },
    "NONNEGATIVE");

}  // namespace handsel
