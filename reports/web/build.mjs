// Bundles the page into dist/page.js and dist/page.css, one script and one style sheet, nothing fetched at run time; and
// its figures into dist/figures.js, for node, which has no window.
import { build } from 'esbuild';
import { fileURLToPath } from 'node:url';
import { dirname } from 'node:path';

process.chdir(dirname(fileURLToPath(import.meta.url)));
const common = { outdir: 'dist', bundle: true, minify: true, charset: 'utf8', legalComments: 'eof', logLevel: 'warning' };
await build({ ...common, entryPoints: { page: 'src/main.ts' }, format: 'iife', target: ['es2022'], loader: { '.woff2': 'dataurl' } });
await build({
  ...common, entryPoints: { figures: 'src/figures.ts' }, format: 'esm', platform: 'node', target: ['node18'], loader: { '.woff': 'binary' },
  // Packages that are not modules ask for node's own by require().
  banner: { js: "import { createRequire } from 'node:module'; const require = createRequire(import.meta.url);" },
});
