// SPDX-License-Identifier: Apache-2.0
// node late_cycles.mjs [runs=5] [domain=37]: does a page that is open make control cycles late? Handovers in turn without and with a headless
// browser (niced) on the page; prints the share of late cycles and the longest gap between set-points of each. Exit 1 if the page made it worse:
// more late cycles in sum than without it, beyond what chance explains (two standard deviations of the difference of two counts).
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { launchBrowser, startSystem } from "./stage.mjs";

const runs = Number(process.argv[2] ?? 5), domain = process.argv[3] ?? "37";
const folder = await mkdtemp(join(tmpdir(), "handsel-late-"));
const sums = { without: [0, 0], with: [0, 0] };

async function perform(browser) {
  const file = join(folder, "report.json");
  const { system, address } = await startSystem("run", domain, "--report", file);
  const page = await browser?.newPage({ viewport: { width: 1280, height: 800 } });
  await page?.goto(address);
  await system.ended;
  const frames = await page?.evaluate(() => window.handsel?.frames ?? 0);
  await page?.close();
  const report = JSON.parse(await readFile(file, "utf8"));
  if (!report.success) throw new Error(`the handover failed: ${report.failure}`);
  return { ...report, frames };
}

for (let run = 1; run <= runs; ++run) {
  for (const kind of run % 2 ? ["without", "with"] : ["with", "without"]) {
    const browser = kind === "with" ? await launchBrowser() : undefined;
    const { cycles, late_cycles: late, set_point_gap_max_s: gap, frames } = await perform(browser);
    await browser?.close();
    sums[kind][0] += late;
    sums[kind][1] += cycles;
    const drawn = frames === undefined ? "" : `, ${frames} pictures drawn`;
    console.log(`${run} ${kind.padEnd(7)} page: ${late} of ${cycles} cycles late (${((100 * late) / cycles).toFixed(3)} %), longest gap ${(1e3 * gap).toFixed(1)} ms${drawn}`);
  }
}
await rm(folder, { recursive: true });
const share = ([late, cycles]) => late / cycles;
const [a, b] = [sums.without, sums.with], scatter = 2 * Math.sqrt(a[0] + b[0] + 1) / ((a[1] + b[1]) / 2);
console.log(`without page ${(100 * share(a)).toFixed(3)} % late, with page ${(100 * share(b)).toFixed(3)} % late; chance explains ${(100 * scatter).toFixed(3)} %`);
process.exit(share(b) - share(a) > scatter ? 1 : 0);
