// SPDX-License-Identifier: Apache-2.0
// Do two processes understand each other's messages?
#pragma once

#include <string>

namespace handsel {

/// Returns eight hexadecimal digits over every topic's name, type and QoS profile: processes that
/// differ in it do not understand each other.
std::string interface_id();
/// Returns e.g. "handsel 0.1.0, interface 01234567".
std::string version_text();

}  // namespace handsel
