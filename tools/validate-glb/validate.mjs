// Runs the Khronos glTF validator: node validate.mjs FILE.glb ...
// Exit status: 0 all clean, 1 an error or a warning in some file, 2 nothing to validate or a file cannot be read.

import { readFile } from "node:fs/promises";
import validator from "gltf-validator";

const SEVERITIES = ["error", "warning", "information", "hint"];
const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("validate-glb: no files given");
  process.exit(2);
}

let status = 0;
for (const file of files) {
  let bytes;
  try {
    bytes = new Uint8Array(await readFile(file));
  } catch (error) {
    console.error(`${file}: ${error.message}`);
    status = 2;
    continue;
  }
  let report;
  try {
    report = await validator.validateBytes(bytes, { uri: file, format: "glb", maxIssues: 100, writeTimestamp: false });
  } catch (error) {
    console.error(`${file}: not a GLB: ${error}`);
    status = Math.max(status, 1);
    continue;
  }
  const { numErrors, numWarnings, numInfos, messages, truncated } = report.issues;
  const info = report.info ?? {};
  const figures = `${info.drawCallCount ?? 0} primitives, ${info.totalTriangleCount ?? 0} triangles, ${info.totalVertexCount ?? 0} vertices`;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos (${figures})`);
  for (const m of messages) {
    console.log(`  ${SEVERITIES[m.severity] ?? m.severity} ${m.code} ${m.pointer ?? `byte ${m.offset}`}: ${m.message}`);
  }
  if (truncated) console.log("  (more issues are not listed)");
  if (numErrors > 0 || numWarnings > 0) status = Math.max(status, 1);
}
process.exit(status);
