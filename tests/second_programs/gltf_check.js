// Checks a .glb with the Khronos validator. Not a test: run by hand.
//
//     npm install gltf-validator && node tests/second_programs/gltf_check.js MOTION.glb
const { readFileSync } = require("fs");
const validator = require(require.resolve("gltf-validator", { paths: [process.cwd()] }));

validator.validateBytes(new Uint8Array(readFileSync(process.argv[2]))).then(({ issues }) => {
  console.log(JSON.stringify(issues, null, 1));
  process.exit(issues.numErrors + issues.numWarnings ? 1 : 0);
});
