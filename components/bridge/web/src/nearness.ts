// What a distance is against its limit; "near" is less than half as much again.
export type Nearness = "calm" | "near" | "too near";
export function nearness(distance: number, limit: number): Nearness {
  return distance <= limit ? "too near" : distance <= 1.5 * limit ? "near" : "calm";
}
