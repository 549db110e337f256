/* SPDX-License-Identifier: GPL-3.0-or-later */
/* At build time: squeeze.mjs FROM TO writes a file deflated (raw, RFC 1951), as DecompressionStream reads it. */
import { readFileSync, writeFileSync } from "node:fs";
import { deflateRawSync } from "node:zlib";

const [from, to] = process.argv.slice(2);
writeFileSync(to, deflateRawSync(readFileSync(from), { level: 9 }));
