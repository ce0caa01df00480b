// SPDX-License-Identifier: Apache-2.0
// Plots of the curves over the last minute before the instant shown, against their limits.
import uPlot from "uplot";
import { Curve, Curves } from "./curves";

const kWindow = 60;    // stretch of time shown [s]
const kHeight = 120;   // of one plot [px]
// Colours that people without colour vision tell apart, after Okabe and Ito.
const kColours = ["#0072b2", "#b35900", "#007f5c", "#a0527e", "#3a8bb8", "#8a7a00", "#4d4d4d", "#5b3fd6"];
const kLimit = "#b3261e";

export class Plots {
  private readonly plots = new Map<string, uPlot>();
  private next = 0;

  constructor(private readonly place: HTMLElement, private readonly details: HTMLDetailsElement, private readonly source: () => Curves) {
    new ResizeObserver(() => this.resize()).observe(place);
  }

  // Draws one plot more each time, so that no picture of the page waits for all of them; `now`: the
  // instant shown [s, system clock].
  show(now: number): void {
    if (!this.details.open || this.place.clientWidth === 0) return;
    const curves = this.source(), curve = curves.curves[this.next++ % curves.curves.length];
    const [times, ...lines] = curves.between(curve, now - kWindow, now);
    const limits = curve.limits.map((limit) => times.map(() => limit));
    let plot = this.plots.get(curve.id);
    if (!plot) {
      plot = new uPlot(this.options(curve), [[], ...lines.map(() => []), ...limits.map(() => [])] as uPlot.AlignedData, this.place);
      this.plots.set(curve.id, plot);
    }
    plot.setData([times, ...lines, ...limits] as uPlot.AlignedData, false);
    const extent = [...curve.limits, ...lines.flat().filter(Number.isFinite), 0];
    plot.batch(() => {
      plot.setScale("x", { min: now - kWindow, max: now });
      plot.setScale("y", { min: 1.1 * Math.min(...extent), max: Math.max(1.1 * Math.max(...extent), 0.1) });
    });
  }

  private options(curve: Curve): uPlot.Options {
    const quiet = (): string => getComputedStyle(document.documentElement).getPropertyValue("--quiet").trim();
    const grid = (): string => getComputedStyle(document.documentElement).getPropertyValue("--line").trim();
    const lines = curve.lines.map((label, i): uPlot.Series => ({
      label, stroke: label === "limit" ? kLimit : kColours[i % kColours.length], width: 1.25, points: { show: false }, dash: label === "limit" ? [5, 3] : undefined,
    }));
    const limits = curve.limits.map((limit): uPlot.Series => ({ label: `limit ${limit}`, stroke: kLimit, width: 1, dash: [5, 3], points: { show: false } }));
    const axis = { stroke: quiet, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid, width: 1 }, font: "10px system-ui" };
    return {
      title: `${curve.label} [${curve.unit}]`, width: this.width(), height: kHeight, legend: { show: false }, cursor: { show: false },
      series: [{}, ...lines, ...limits], axes: [{ ...axis, size: 22 }, { ...axis, size: 38 }], scales: { x: { time: true, auto: false }, y: { auto: false } },
    };
  }

  private width(): number {
    const columns = Math.max(1, Math.floor(this.place.clientWidth / 300));
    return Math.floor(this.place.clientWidth / columns) - 8;
  }
  private resize(): void {
    if (this.place.clientWidth > 0) for (const plot of this.plots.values()) plot.setSize({ width: this.width(), height: kHeight });
  }
}
