// Prints the Khronos glTF validator's verdict on each file as a line of JSON: node gltf_validate.mjs FILE...
// The npm package gltf-validator is looked for from NODE_PATH, then node_modules of the tree.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { basename, delimiter, resolve } from 'node:path';

const folders = [...(process.env.NODE_PATH ?? '').split(delimiter), 'node_modules', 'build/node_modules']
  .filter(Boolean).map((folder) => resolve(folder));
const find = createRequire(import.meta.url);
let validator;
try {
  validator = find(find.resolve('gltf-validator', { paths: folders.flatMap((f) => [f, resolve(f, '..')]) }));
} catch {
  console.error('gltf-validator is not installed');
  process.exit(77);
}
for (const file of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), { uri: basename(file), maxIssues: 100 });
  console.log(JSON.stringify({ file, issues: report.issues, info: report.info }));
}
