// moma replay --video: video_test.mjs SOURCE_DIR WORK_DIR MOMA
// Exit 0: passed; 1: failed; 77: left out, since node's packages or chromium are missing.
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { check, end, needs, packagesOf, skip } from './kit.mjs';

const [, , source, work, moma] = process.argv;
needs('chromium');
let bunny;
try {
  bunny = packagesOf(source)('mediabunny');
} catch {
  skip('mediabunny is not in reports/web/node_modules');
}
rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
const run = (...args) => spawnSync(moma, args, { encoding: 'utf8', cwd: work });
const good = (...args) => {
  const done = run(...args);
  check(done.status === 0, `moma ${args.join(' ')}: ${done.stderr}`);
  return done;
};

// A robot whose meshes lie beside its URDF, one world, no samples: the motion is simulated again.
const robot = join(source, 'tests/data/looks/cart.yaml');
writeFileSync(join(work, 'cart.yaml'), `name: cart\nrobot: ${robot}\ncontrollers: {plain: {}}\nworlds: {seed: 1, families: {open: {}}}\n`
  + 'simulation: {mode: kinematic, time_limit: 1.5}\ntrials: 1\nsamples: none\n');
good('run', 'cart.yaml', '-o', 'cart.db', '--quiet');
const [{ trial, length }] = JSON.parse(good('query', 'cart.db', 'SELECT trial, time_end_s AS length FROM v_trials', '-f', 'json').stdout);

const left = () => readdirSync(tmpdir()).filter((name) => /^moma-(film|browser)-/.test(name)).length;
const before = left();
const told = good('replay', 'cart.db', trial.slice(0, 6), '--video', 'film.webm', '--size', '160', '96', '--fps', '8', '--speed', '0.5', '--look', robot);
check(left() === before, 'nothing is left in the folder for temporary files');
const frames = Math.ceil((length * 8) / 0.5 - 5e-4) + 1;
check(told.stderr.includes(`${frames} frames, 8 a second`), `what was written: ${told.stderr}`);
const file = readFileSync(join(work, 'film.webm'));
check(file.readUInt32BE(0) === 0x1a45dfa3 && file.subarray(0, 64).includes('webm'), 'it is WebM');
const input = new bunny.Input({ formats: bunny.ALL_FORMATS, source: new bunny.BlobSource(new Blob([file])) });
const track = await input.getPrimaryVideoTrack();
check(track.codedWidth === 160 && track.codedHeight === 96, `of the asked size: ${track.codedWidth} x ${track.codedHeight}`);
const times = [];
for await (const packet of new bunny.EncodedPacketSink(track).packets()) times.push(packet.timestamp);
check(times.length === frames, `${times.length} frames of ${frames}`);
check(times.every((t, k) => Math.abs(t - k / 8) < 2e-3), `eight a second: ${times}`);
const seconds = await input.computeDuration();
check(Math.abs(seconds - frames / 8) < 0.01, `${seconds} s, that is a motion of ${length} s at half its speed`);

// What cannot be done is said in one line, and leaves no file.
const bad = (words, env, ...args) => {
  const done = spawnSync(moma, ['replay', 'cart.db', trial, '--video', 'no.webm', ...args], { encoding: 'utf8', cwd: work, env: { ...process.env, ...env } });
  check(done.status !== 0 && words.test(done.stderr) && !existsSync(join(work, 'no.webm')), `${args} ends with ${done.status}: ${done.stderr}`);
};
bad(/Chromium, which is not found; wanted on the PATH: chromium/, { PATH: work });
bad(/161 x 96 pixels; wanted: even numbers from 64 to 4096/, {}, '--size', '161', '96');
writeFileSync(join(work, 'chromium'), '#!/bin/sh\necho "no display, no luck" >&2\nexit 3\n', { mode: 0o755 });
bad(/Chromium has ended by itself; its last words: no display, no luck/, { PATH: `${work}:/bin:/usr/bin` });

// The same robot in the report page: its meshes once, or not at all where it is told so or they are not found.
const pageOf = (...args) => {
  const done = good('report', 'cart.db', '-o', 'cart.html', ...args);
  return { words: done.stderr, data: JSON.parse(readFileSync(join(work, 'cart.html'), 'utf8').split('id="moma-data">')[1].split('</script')[0]) };
};
good('run', 'cart.yaml', '-o', 'kept.db', '--quiet', '--set', 'samples=all');
const kept = (...args) => {
  const done = good('report', 'kept.db', '-o', 'kept.html', ...args);
  return { words: done.stderr, data: JSON.parse(readFileSync(join(work, 'kept.html'), 'utf8').split('id="moma-data">')[1].split('</script')[0]) };
};
const [look] = Object.values(kept('--look', robot).data.looks);
check(look.length === 3 && look.filter((part) => part.n === 4).length === 2, `two wedges and a box: ${JSON.stringify(look).slice(0, 300)}`);
check(JSON.stringify(look[0].colour) === '[1,0.5,0]' && look[1].shape === 'box', 'in their colours and shapes');
check(Math.abs(look[0].low[0]) < 1e-6 && Math.abs(look[0].step * 65535 - 0.6) < 1e-6, 'scaled as the URDF says: 0.3 m, twice');
const without = kept();
check(Object.keys(without.data.looks).length === 0 && /cart is shown as its collision shapes: .*wedge.stl/.test(without.words), `where meshes are not found: ${without.words}`);
check(Object.keys(kept('--shapes').data.looks).length === 0, 'none where they are not wanted');
check(Object.keys(pageOf('--look', robot).data.looks).length === 0, 'none where nothing is played');
end('the video of a motion');
