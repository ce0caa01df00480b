// SPDX-License-Identifier: Apache-2.0
// Classifies a distance against its limit; "near" is below 1.5 times the limit.
export type Nearness = "calm" | "near" | "too near";
export function nearness(distance: number, limit: number): Nearness {
  return distance <= limit ? "too near" : distance <= 1.5 * limit ? "near" : "calm";
}
