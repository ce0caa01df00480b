// SPDX-License-Identifier: Apache-2.0
// Hashes that are equal on every machine.
#pragma once

#include <cstddef>
#include <cstdint>

namespace handsel {

/// Initial value of hashed() (FNV-1a).
constexpr std::uint64_t kHashBasis = 0xcbf29ce484222325;

/// Returns the hash of what `hash` stands for, followed by the bytes (FNV-1a).
inline std::uint64_t hashed(std::uint64_t hash, const void* bytes, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i)
    hash = (hash ^ static_cast<const unsigned char*>(bytes)[i]) * 0x100000001b3;
  return hash;
}

/// Returns `x` with its bits mixed: a step of a random sequence (SplitMix64).
inline std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

}  // namespace handsel
