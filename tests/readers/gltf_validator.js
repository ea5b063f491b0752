// SPDX-License-Identifier: MIT
// Khronos' glTF validator over files: node gltf_validator.js FILE...; npm's package gltf-validator, found by NODE_PATH.
const validator = require("gltf-validator");
const fs = require("fs");

async function main() {
	let bad = 0;
	for (const file of process.argv.slice(2)) {
		const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 20 });
		const issues = report.issues;
		console.log(`${file}: validator ${validator.version()}: ${issues.numErrors} errors, ${issues.numWarnings} warnings, ` +
			`${issues.numInfos} infos`);
		for (const message of issues.messages)
			console.log(`  ${message.severity} ${message.code} ${message.pointer}: ${message.message}`);
		bad += issues.numErrors + issues.numWarnings;
	}
	process.exit(bad ? 1 : 0);
}
main();
