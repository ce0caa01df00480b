#include "common/config/text_check.hpp"

namespace handsel {
namespace {

// Sorted by field. The bounds exclude values that no hardware or person can have: a wrong unit,
// sign or power of ten is refused. Units are those of the schema.
constexpr NumberRange kRanges[] = {
    {"Disturbance.at", 0, 86400},
    {"FingerDescription.tip_radius", 0, 1},
    {"HandDescription.contact_margin", 0, 3.1416},
    {"HandDescription.grip_force", 0, 1000},
    {"HandDescription.max_effort", 0, 1000},
    {"ObjectDescription.friction", 0, 10},
    {"ObjectDescription.height_above_support", -10, 10},
    {"ObjectDescription.mass", 0, 1000},
    {"ObjectPart.sphere", 0, 100},
    {"ObjectPlacement.jitter", 0, 5},
    {"PadDescription.height", 0, 1},
    {"PadDescription.width", 0, 1},
    {"PayloadEntry.value", 0, 1000},
    {"PersonDescription.approach_from", 0, 50},
    {"PersonDescription.fetches_at", 0, 86400},
    {"PersonDescription.jitter", 0, 5},
    {"PersonDescription.pull", 0, 1000},
    {"PersonDescription.reaction", 0, 60},
    {"PersonDescription.x", -100, 100},
    {"PersonDescription.y", -100, 100},
    {"PlatformDescription.speed", 0, 10, true},
    {"PlatformDescription.turn_speed", 0, 10, true},
    {"Round.length", 0, 100},
    {"Round.radius", 0, 100},
    {"Scenario.timeout", 0, 86400},
};

}  // namespace

std::span<const NumberRange> number_ranges() { return kRanges; }

}  // namespace handsel
