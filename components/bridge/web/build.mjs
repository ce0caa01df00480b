// SPDX-License-Identifier: Apache-2.0
// node build.mjs <folder>: bundles the page into it: index.html, page.css, page.js (licences of what it contains: page.js.LEGAL.txt).
import { build } from "esbuild";
import { cp, mkdir } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const source = join(dirname(fileURLToPath(import.meta.url)), "src"), folder = process.argv[2];
await mkdir(folder, { recursive: true });
await build({
  entryPoints: [join(source, "main.ts")], outfile: join(folder, "page.js"),
  bundle: true, minify: true, format: "iife", target: "es2022", legalComments: "linked", logLevel: "warning",
});
for (const file of ["index.html", "page.css"]) await cp(join(source, file), join(folder, file));
