// Motions in the page, in a real browser: of made-up trials, of a store that grows while it is looked at, of trials that
// moma simulates: replay_test.mjs SOURCE_DIR MAKE_REPORT WORK_DIR [MOMA]
// Exit 0: passed; 1: failed; 77: left out, since node's packages, python3 or chromium are missing.
import { execFileSync, spawn } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { inflateSync } from 'node:zlib';

import { check, dataOf, drawn, end, launch, near, opener, strip, workshop } from './kit.mjs';

const [, , source, makeReport, work, moma] = process.argv;
const screenshots = process.env.MOMA_SCREENSHOTS;
const { makeStore, makePage, sql } = workshop(source, makeReport, work);
const browser = await launch(source);
const open = opener(browser);

// ---- the page's own motions -------------------------------------------------------------------------------------------------------
/** Column of a replay's samples, decoded independently of the page. */
const column = (replay, name) => {
  const planes = inflateSync(Buffer.from(replay.data, 'base64'));
  const count = replay.n * replay.columns.length;
  const bytes = Buffer.alloc(4 * count);
  for (let k = 0; k < 4; ++k) for (let i = 0; i < count; ++i) bytes[4 * i + k] = planes[k * count + i];
  const at = replay.columns.indexOf(name);
  return Array.from({ length: replay.n }, (_, i) => bytes.readFloatLE(4 * (at * replay.n + i)));
};
/** Chooses a motion of the list and moves its time line to each of `times`; what the scene tells then. */
const tellAt = (page, i, trial, times) => page.evaluate(async ([place, name, moments]) => {
  document.querySelectorAll('.shelf button')[place].click();
  const box = document.querySelector('.stage-box');
  while (box.dataset.trial !== name) await new Promise((done) => { setTimeout(done); });
  const input = document.querySelector('.transport input[type=range]');
  return moments.map((t) => {
    input.value = t;   // no further than its end
    input.dispatchEvent(new Event('input', { bubbles: true }));
    return { ...box.dataset };
  });
}, [i, trial, times]);
/** Distances at arrows never lie over each other, or outside of the scene. */
const checkLabels = async (page, pageData) => {
  let labels = 0;
  for (const [i, replay] of pageData.replays.entries()) {
    await tellAt(page, i, replay.trial, [1e6]);
    await drawn(page);
    const shown = await page.locator('.stage-box').evaluate((box) => {
      const of = (element) => { const { left, top, right, bottom } = element.getBoundingClientRect(); return { left, top, right, bottom }; };
      return { scene: of(box), labels: [...box.querySelectorAll('.row-labels span')].map(of) };
    });
    labels += shown.labels.length;
    shown.labels.forEach((a, k) => {
      const middle = [(a.left + a.right) / 2, (a.top + a.bottom) / 2];
      check(middle[0] > shown.scene.left && middle[0] < shown.scene.right && middle[1] > shown.scene.top && middle[1] < shown.scene.bottom, `trial ${replay.trial}: a label at ${middle}`);
      for (const b of shown.labels.slice(k + 1)) check(a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top, `trial ${replay.trial}: labels lie over each other: ${JSON.stringify([a, b])}`);
    });
  }
  check(labels > 0, `${labels} labels looked at`);
};
/** The page's forward kinematics against the stored errors, which the simulation computed. */
const checkKinematics = async (page, pageData) => {
  for (const [i, replay] of pageData.replays.entries()) {
    const [begin, end] = await tellAt(page, i, replay.trial, [0, 1e6]);
    const stored = column(replay, 'error_position')[0];
    check(near(Number(begin.positionError), stored, 1e-5), `trial ${replay.trial}: end effector ${begin.positionError} m from the goal, stored ${stored} m`);
    const last = column(replay, 'error_position').pop();
    check(near(Number(end.positionErrorNow), last, 1e-5), `trial ${replay.trial}: at the end ${end.positionErrorNow} m from the goal, stored ${last} m`);
  }
};
{
  const demo = makePage(makeStore('demo', 'demo', 60));
  const data = dataOf(demo);
  const { context, page } = await open(demo, { scene: true });
  await page.locator('#failures').scrollIntoViewIfNeeded();
  await page.locator('.atlas .play').first().click();
  await page.waitForSelector('.stage-box[data-trial]');
  const time = async () => Number(await page.locator('.transport input[type=range]').inputValue());
  await page.waitForFunction(() => Number(document.querySelector('.transport input[type=range]').value) > 0.05);
  check((await time()) > 0, 'a failure plays');
  await page.locator('.transport .play').click();
  await page.locator('.transport input[type=range]').evaluate((input) => {
    input.value = '1';
    input.dispatchEvent(new Event('input', { bubbles: true }));
  });
  check((await page.locator('.clock').innerText()).startsWith('1.00 of'), 'the time line scrubs');
  await page.locator('.stage').focus();
  await page.keyboard.press('ArrowRight');
  check((await page.locator('.clock').innerText()).startsWith('1.10 of'), 'an arrow steps');
  const colours = await page.locator('.stage').evaluate((canvas) => {
    const copy = document.createElement('canvas');
    copy.width = canvas.width;
    copy.height = canvas.height;
    return new Promise((done) => requestAnimationFrame(() => {
      document.querySelector('.transport input[type=range]').dispatchEvent(new Event('input', { bubbles: true }));   // draws with the next frame
      requestAnimationFrame(() => {   // in which this comes after it
        copy.getContext('2d').drawImage(canvas, 0, 0);
        const pixels = copy.getContext('2d').getImageData(0, 0, copy.width, copy.height).data;
        const found = new Set();
        for (let i = 0; i < pixels.length; i += 404) found.add(`${pixels[i] >> 3},${pixels[i + 1] >> 3},${pixels[i + 2] >> 3}`);
        done(found.size);
      });
    }));
  });
  check(colours > 20, `the scene shows ${colours} colours`);

  await strip(page);
  await page.locator('.shelf button').nth(3).click();
  await page.waitForFunction((trial) => document.querySelector('.stage-box').dataset.trial === trial, data.replays[3].trial);
  check((await page.locator('.transport .play').innerText()) === 'Pause', 'a motion chosen from the list plays');
  await checkKinematics(page, data);
  await context.close();
}

// ---- served by moma view, while a run goes on -----------------------------------------------------------------------
{
  const db = makeStore('served', 'demo', 20, 3);
  sql(db, "UPDATE invocation SET status = 'running'; CREATE TABLE kept AS SELECT * FROM point_trial WHERE world_index >= 15; DELETE FROM point_trial WHERE world_index >= 15;");
  const server = spawn(makeReport, ['--view', db], { stdio: ['ignore', 'pipe', 'inherit'] });
  const address = await new Promise((done) => server.stdout.once('data', (text) => done(String(text).trim())));
  const ended = new Promise((done) => server.once('exit', done));
  process.once('exit', () => server.kill('SIGKILL'));   // whatever fails below
  let stopped = false;
  const allowed = (error) => stopped && error.includes('ERR_CONNECTION_REFUSED');   // the page goes on asking
  const { context, page } = await open(address, { served: true, allowed });
  check((await page.locator('.live').innerText()).includes('30'), 'the page says that it is live');
  // Whether a run that never said how it ended goes on: its program holds the store's lock, or does not.
  const lock = `${db}-lock`;
  writeFileSync(lock, '');
  await page.waitForFunction(() => /was killed/.test(document.querySelector('.live').textContent));
  check(!(await page.locator('.live').getAttribute('class')).includes('running'), 'a killed run is not called live');
  check(/The last run was killed/.test(await page.locator('.notices').innerText()), `the notices say so: ${await page.locator('.notices').innerText()}`);
  const holder = spawn('python3', ['-c', `import fcntl, sys; f = open(${JSON.stringify(lock)}); fcntl.flock(f, fcntl.LOCK_EX); print("held", flush=True); sys.stdin.read()`], { stdio: ['pipe', 'pipe', 'inherit'] });
  await new Promise((done) => holder.stdout.once('data', done));
  await page.waitForFunction(() => /30 of 40\strials \(75\s%\).*a run goes on/.test(document.querySelector('.live').textContent));
  check(/interim/.test(await page.locator('.notices').innerText()), 'what is shown before the end is called interim');
  check((await page.locator('#trials footer .note').innerText()).startsWith('30'), 'the trials so far');
  await page.locator('#failures').scrollIntoViewIfNeeded();
  await page.locator('.atlas .play').first().click();
  await page.waitForSelector('.stage-box[data-trial]');
  await page.waitForFunction(() => Number(document.querySelector('.transport input[type=range]').value) > 0.05);
  await page.locator('.transport .play').click();
  sql(db, "INSERT INTO point_trial SELECT * FROM kept; DROP TABLE kept; UPDATE invocation SET status = 'finished';");
  holder.stdin.end();
  await page.waitForFunction(() => document.querySelector('#trials footer .note').textContent.startsWith('40'));
  check((await page.locator('.summary tbody tr').last().locator('td').first().innerText()) === '20', 'the summary has followed');
  check((await page.locator('.live').innerText()).includes('no run is going on'), 'the end of the run is told');
  stopped = true;
  server.kill('SIGTERM');
  check((await ended) === 0, 'the server ends cleanly');
  await page.waitForFunction(() => document.querySelector('.live').textContent.startsWith('moma view has ended'));
  await context.close();
}

// ---- trials that moma simulated: robots, worlds and samples as the program writes them -----------------------------
const suites = [['frankie', 'robots/frankie.yaml', 'clutter', '{}'], ['tiago', 'robots/examples/tiago.yaml', 'moving', '{}'],
  ['rows', 'robots/frankie.yaml', 'moving', join(source, 'configs/controllers/moma-reactive.yaml')]];
for (const [name, robot, family, controller] of moma === undefined ? [] : suites) {
  const suite = join(work, `${name}.yaml`);
  writeFileSync(suite, `name: ${name}\nrobot: ${join(source, 'configs', robot)}\ncontrollers: {moma: ${controller}}\nworlds: {seed: 5, families: `
    + `{${family}: {weight: 1}}}\nsimulation: {mode: kinematic, time_limit: 8}\ntrials: 3\nsamples: all\n`);
  execFileSync(moma, ['run', suite, '-o', join(work, `${name}.db`), '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'] });
  execFileSync(moma, ['report', join(work, `${name}.db`), '-o', join(work, `${name}.html`)], { stdio: 'ignore' });
  const html = join(work, `${name}.html`);
  const { context, page } = await open(html, { ratio: name === 'rows' ? 2 : 1, scene: name === 'frankie' });
  await page.locator('#replay').scrollIntoViewIfNeeded();
  // A robot whose URDF has visual meshes is shown as these, or as its shapes.
  const looks = Object.values(dataOf(html).looks);
  check(looks.length === (name === 'tiago' ? 1 : 0), `${name}: ${looks.length} looks`);
  await page.waitForSelector('.stage-box[data-triangles]');
  const triangles = async () => Number(await page.locator('.stage-box').getAttribute('data-triangles'));
  const switched = page.locator('.transport label', { hasText: 'shapes' });
  check((await switched.isVisible()) === (looks.length > 0), `${name}: shapes are a switch where there is something else`);
  if (looks.length > 0) {
    const seen = await triangles();
    check(seen > 5000 && seen < 26000, `${name}: ${seen} triangles of its meshes`);
    await switched.click();
    const plain = await triangles();
    check(plain !== seen, `${name}: as shapes ${plain} triangles, else ${seen}`);
    await switched.click();
    check((await triangles()) === seen, `${name}: and back`);
    if (screenshots !== undefined) await page.locator('.replay').screenshot({ path: join(screenshots, 'replay-meshes.png') });
  }
  check(dataOf(html).replays.length === 3, `${name}: all trials can be played`);
  if (name === 'frankie') await checkLabels(page, dataOf(html));
  if (screenshots === undefined) await strip(page);
  await checkKinematics(page, dataOf(html));
  // Collision rows follow from poses and commands in the page; the controller stored the least distance and how many
  // constraints were active.
  let [seen, active, ends, passing] = [0, 0, 0, 0];
  for (const [i, replay] of dataOf(html).replays.entries()) {
    const [times, least, rows, fallback, status] = ['t', 'least_distance', 'active_rows', 'fallback', 'status'].map((column_) => column(replay, column_));
    const looks = Array.from({ length: Math.ceil(replay.n / 7) }, (_, i_) => 7 * i_);
    const all = (await tellAt(page, i, replay.trial, looks.map((k) => times[k])))
      .map((box) => ({ least: box.leastDistance, active: Number(box.activeRows), room: Number(box.leastRoom), ends: Number(box.ends), passing: Number(box.passing) }));
    for (const [at, k] of looks.entries()) {
      const shown = { ...all[at], least: all[at].least === '' ? Infinity : Number(all[at].least) };
      if (least[k] < 0.29) {
        seen += 1;
        check(near(shown.least, least[k], 1e-5), `${name}: at ${times[k]} s the nearest object is ${shown.least} m away, stored ${least[k]} m`);
      }
      if (fallback[k] === 0) check(shown.active <= rows[k], `${name}: at ${times[k]} s ${shown.active} active collision rows of ${rows[k]} active constraints`);
      active += shown.active;
      ends += shown.ends;
      passing += shown.passing;
      // The solver kept its rows of ends and of passing objects: were those of the page others, the command would break some.
      if (fallback[k] === 0 && status[k] === 0 && k + 1 < replay.n) check(shown.room > -3e-3, `${name}: at ${times[k]} s a row is broken by ${-shown.room} m/s`);
    }
  }
  if (name === 'rows') check(ends > 0 && passing > 0, `${name}: ${ends} rows of ends, ${passing} of passing objects`);
  else check(seen > 5 && active > 0, `${name}: ${seen} distances compared, ${active} active rows`);
  if (screenshots !== undefined) await page.locator('.replay').screenshot({ path: join(screenshots, `replay-${name}.png`) });
  await context.close();
}

// ---- a controller that looks ahead: its path and its detours on the floor, its reasons in words ---------------------
if (moma !== undefined) {
  const suite = join(work, 'ahead.yaml');
  writeFileSync(suite, `name: ahead\nrobot: ${join(source, 'configs/robots/frankie.yaml')}\ncontrollers: {ahead: ${join(source, 'configs/controllers/moma-ahead.yaml')}}\n`
    + 'worlds: {seed: 4242, families: {clutter: {weight: 1}}}\nsimulation: {mode: kinematic, time_limit: 8}\ntrials: 10\nsamples: all\n');
  execFileSync(moma, ['run', suite, '-o', join(work, 'ahead.db'), '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'] });
  execFileSync(moma, ['report', join(work, 'ahead.db'), '-o', join(work, 'ahead.html')], { stdio: 'ignore' });
  const html = join(work, 'ahead.html');
  const { context, page } = await open(html);
  await page.locator('#replay').scrollIntoViewIfNeeded();
  await page.waitForSelector('.stage-box[data-triangles]');
  const words = page.locator('.plan-now');
  let [paths, detours] = [0, 0];
  for (const [i, replay] of dataOf(html).replays.entries()) {
    if (!replay.columns.includes('plan_mode')) continue;
    const [times, mode, attempts, detour] = ['t', 'plan_mode', 'plan_attempts', 'detour'].map((name) => column(replay, name));
    const first = mode.indexOf(1);
    if (first >= 0) {
      let end = first;
      while (end < replay.n && mode[end] === 1 && attempts[end] === attempts[first]) end += 1;
      const [shown] = await tellAt(page, i, replay.trial, [times[first]]);
      check(Number(shown.planned) === end - first + 1, `trial ${replay.trial}: ${shown.planned} places of a path of ${end - first} samples and its end`);
      check(/follows a path, .* of .* s, .* m behind/.test(await words.innerText()), `trial ${replay.trial}: ${await words.innerText()}`);
      paths += 1;
    }
    const away = detour.findIndex((value, k) => value !== 0 && mode[k] !== 1);
    if (away >= 0) {
      const [shown] = await tellAt(page, i, replay.trial, [times[away]]);
      check(shown.planned === '2', `trial ${replay.trial}: ${shown.planned} places of a detour`);
      check(/makes a detour/.test(await words.innerText()), `trial ${replay.trial}: ${await words.innerText()}`);
      detours += 1;
    }
  }
  check(paths > 0 && detours > 0, `${paths} paths and ${detours} detours`);
  await context.close();
}

await browser.close();
end('the replay');
