// SPDX-License-Identifier: Apache-2.0
// node build.mjs <folder>: bundles the page into it: index.html, page.css, page.js (licences of what it contains: page.js.LEGAL.txt).
import { build } from "esbuild";
import { cp, mkdir, readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const source = join(dirname(fileURLToPath(import.meta.url)), "src"), folder = process.argv[2];
await mkdir(folder, { recursive: true });
await build({
  entryPoints: [join(source, "main.ts")], outfile: join(folder, "page.js"),
  bundle: true, minify: true, format: "iife", target: "es2022", legalComments: "linked", logLevel: "warning",
});
await cp(join(source, "index.html"), join(folder, "index.html"));
const styles = [createRequire(import.meta.url).resolve("uplot/dist/uPlot.min.css"), join(source, "page.css")];
await writeFile(join(folder, "page.css"), (await Promise.all(styles.map((file) => readFile(file, "utf8")))).join("\n"));
