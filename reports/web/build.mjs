// Bundles the page into dist/page.js and dist/page.css, one script and one style sheet, nothing fetched at run time.
import { build } from 'esbuild';
import { fileURLToPath } from 'node:url';
import { dirname } from 'node:path';

process.chdir(dirname(fileURLToPath(import.meta.url)));
await build({
  outdir: 'dist', bundle: true, minify: true, charset: 'utf8', legalComments: 'eof', logLevel: 'warning',
  entryPoints: { page: 'src/main.ts' }, format: 'iife', target: ['es2022'], loader: { '.woff2': 'dataurl' },
});
