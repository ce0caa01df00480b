// SPDX-License-Identifier: Apache-2.0
// Values that the page cannot read from DDS: /config.json of the bridge.
export interface AxisLimits { lower: number; upper: number; velocity: number; acceleration: number; jerk: number }

export interface Config {
  robot: string;
  scenario: string;
  urdf: string;        // its address; empty: the text is in urdf_text
  urdf_text?: string;
  axes: string[];
  tool_link: string;
  groups: Record<string, string[]>;
  limits: AxisLimits[];     // of each axis
  zones: number[];          // outer limits of attention's zones around the robot [m]
  attentive_angle: number;  // max angle between gaze and robot of an attentive person [rad]
  objects: Record<string, { mesh: string }>;
}

export async function loadConfig(): Promise<Config> {
  const answer = await fetch("config.json", { cache: "no-store" });
  if (!answer.ok) throw new Error(`config.json: HTTP ${answer.status}`);
  return (await answer.json()) as Config;
}
