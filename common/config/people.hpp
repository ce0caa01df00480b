// Profiles of people.
#pragma once

#include <filesystem>

#include "common/config/schema/people.pb.h"

namespace handsel {

/// people.txtpb of the folder with the settings; nobody where there is no such file. Throws
/// ConfigError for a profile that cannot be.
config::PeopleProfiles load_people(const std::filesystem::path& settings);

}  // namespace handsel
