// Bundles src/ with three.js into one page without data. Usage: node build.mjs OUT.html (from the folder that has
// node_modules). argil puts a result in the place of "argil:data".

import { build } from "esbuild";
import { readFile, writeFile } from "node:fs/promises";

const [output] = process.argv.slice(2);

const bundled = await build({
  entryPoints: ["src/main.js"], bundle: true, minify: true, format: "iife", target: "es2022", charset: "utf8",
  legalComments: "inline", write: false, logLevel: "warning",
});
const style = await build({ entryPoints: ["src/style.css"], minify: true, write: false, charset: "utf8" });

const put = (page, place, text) => {
  if (page.split(place).length !== 2) throw new Error(`page.html: ${place} must stand there once`);
  return page.replace(place, () => text);
};
let page = await readFile("page.html", "utf8");
page = put(page, "/* argil:style */", style.outputFiles[0].text.trim());
page = put(page, "/* argil:script */", bundled.outputFiles[0].text.trim());
await writeFile(output, page);
