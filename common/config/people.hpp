// SPDX-License-Identifier: Apache-2.0
// Profiles of people.
#pragma once

#include <filesystem>

#include "common/config/settings/people.hpp"

namespace handsel {

/// Returns people.txtpb of the folder with the settings; none if there is no such file. Throws
/// ConfigError for a profile that cannot be.
settings::PeopleProfiles load_people(const std::filesystem::path& folder);

}  // namespace handsel
