// SPDX-License-Identifier: Apache-2.0
// What is wrong with what was observed on a domain.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "deploy/handsel/doctor/doctor.hpp"

namespace handsel {

/// Returns the domain as the text of a finding names it.
std::string domain_text(int domain);

/// Returns a text formatted as by printf, at most 399 bytes.
template <class... Values>
std::string finding_text(const char* pattern, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

/// Adds the findings on clocks, inputs, calibration, writers and other processes. `seen`: what the
/// observer of check_domain() reports; `held`: a system that was started here runs on the domain.
void add_domain_findings(const DoctorOptions& options, const nlohmann::json& seen, bool held,
                         std::vector<Finding>& out);

}  // namespace handsel
