// What a reader does with the page: keys, the browser's Back, a phone, two motions in one world, a suite over time.
//   reader_test.mjs SOURCE_DIR MAKE_REPORT WORK_DIR
// Exit 0: passed; 1: failed; 77: left out, since node's packages, python3 or chromium are missing.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

import { accessible, check, dataOf, drawn, end, figuresFollow, figuresStand, launch, noOverflow, opener, packagesOf, saved, strip, workshop } from './kit.mjs';

const [, , source, makeReport, work] = process.argv;
const { makeStore, makePage, sql } = workshop(source, makeReport, work);
const browser = await launch(source);
const open = opener(browser);
const html = makePage(makeStore('pair', 'demo', 24, 4, 6));
const data = dataOf(html);
const cells = data.trials.columns;
const text = (name) => cells[name].codes.map((code) => cells[name].values[code] ?? null);
const [trials, worlds, outcomes, controllers] = ['trial', 'world_key', 'outcome', 'controller'].map(text);

const inPage = new Set(data.replays.map((replay) => replay.trial));
const rowOf = (trial) => trials.indexOf(trial);
const twinOf = (trial) => trials.find((other, row) => other !== trial && inPage.has(other) && worlds[row] === worlds[rowOf(trial)] && outcomes[row] === 'success');
const failed = data.replays.map((replay) => replay.trial).filter((trial) => outcomes[rowOf(trial)] !== 'success');
const both = failed.filter((trial) => twinOf(trial) !== undefined);

/**
 * The pixels from the bar to a section once it has stood below the bar for 20 frames, or where it is after 20 s.
 * One look is not enough: the page grows between two frames, and follows in the next.
 */
const restsAt = (id) => new Promise((done) => {
  const began = performance.now();
  let frames = 0;
  const look = () => {
    const off = document.getElementById(id).getBoundingClientRect().top - document.querySelector('.toolbar').getBoundingClientRect().bottom;
    frames = Math.abs(off) < 3 ? frames + 1 : 0;
    if (frames === 20 || performance.now() - began > 20000) done(off);
    else requestAnimationFrame(look);
  };
  look();
});

// ---- where links lead: the target stands below the bar, also after what is above it was drawn ----------------------------
for (const [width, height] of [[1280, 900], [390, 844]]) {
  const { context, page } = await open(html, { hash: '#in=failures', width, height, idle: true });
  const below = async (id, what) => {
    await figuresStand(page);   // drawn when nothing else is to do, above the target, too
    const off = await page.evaluate(restsAt, id);
    check(Math.abs(off) < 3, `${what} leads to ${off} px below the bar of a window of ${width}`);
  };
  await below('failures', 'the address');
  await page.reload();
  await page.waitForSelector('main');
  await page.locator('.toolbar nav').getByText('Timing').click();
  await below('timing', 'the bar');
  await page.mouse.move(width / 2, height / 2);
  await page.mouse.wheel(0, -300);
  await page.waitForFunction(() => Math.abs(document.getElementById('timing').getBoundingClientRect().top - document.querySelector('.toolbar').getBoundingClientRect().bottom) > 100);
  check((await page.locator('.replay').boundingBox()).height > 0 && (await page.locator('.stage-box').getAttribute('data-trial')) !== null, 'a picture of the whole page has the replay');
  await context.close();
}

// ---- two motions in one world ------------------------------------------------------------------------------------------
{
  check(both.length > 0, `failures with a success in the same world: ${both.length} of ${failed.length}`);
  // Every failure of the page whose world another controller mastered, with samples, has that motion beside it.
  for (const trial of failed.slice(0, 12)) {
    const row = rowOf(trial);
    const possible = trials.some((other, i) => worlds[i] === worlds[row] && outcomes[i] === 'success' && cells.world[i] < 6);
    check(!possible || twinOf(trial) !== undefined, `trial ${trial} has the success of its world beside it`);
  }
  const { context, page } = await open(html, { hash: `#trial=${both[0]}`, ratio: 2 });
  await page.locator('#replay').scrollIntoViewIfNeeded();
  await page.waitForFunction((trial) => document.querySelector('.stage-box')?.dataset.trial === trial, both[0]);
  check((await page.locator('.stage-box').getAttribute('data-beside')) === '', 'the replay opens on the robot alone');
  await page.getByLabel('Beside it').selectOption(twinOf(both[0]));
  await page.waitForFunction((trial) => document.querySelector('.stage-box').dataset.beside === trial, twinOf(both[0]));
  check(page.url().includes(`beside=${twinOf(both[0])}`), 'the address keeps what is beside');
  const said = (await page.locator('.replay aside').innerText()).replace(/\s/g, ' ');
  check(said.includes(`${data.replays.length} trials at 10 Hz: the worst of each kind first, of ${data.samples_stored} with stored samples, and successes to play beside failures.`), `what can be played is told: ${said.slice(0, 200)}`);
  const lengths = [both[0], twinOf(both[0])].map((trial) => cells.time_end_s[rowOf(trial)]);
  const clock = Number(/of ([\d.]+) s/.exec(await page.locator('.clock').innerText())[1]);
  check(Math.abs(clock - Math.max(...lengths)) < 0.11, `one clock for both: ${clock} of ${lengths}`);
  check((await page.locator('.replay-legend').innerText()).includes(`${controllers[rowOf(twinOf(both[0]))]} in the same world`), 'the legend names the other one');
  await page.getByLabel('Beside it').selectOption('');
  await page.waitForFunction(() => document.querySelector('.stage-box').dataset.beside === '');

  // Jumps, the wheel, and what can be taken along.
  const time = async () => Number(await page.locator('.transport input[type=range]').inputValue());
  await page.getByText('Why it stopped').click();
  check(Math.abs((await time()) - cells.time_end_s[rowOf(both[0])]) < 0.11, `the end of the motion: ${await time()}`);
  await page.getByText('Closest approach').click();
  check((await time()) <= cells.time_end_s[rowOf(both[0])], 'the closest approach');
  const scroll = async () => page.evaluate(() => scrollY);
  await page.locator('.stage').scrollIntoViewIfNeeded();
  const box = await page.locator('.stage').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  const before = await scroll();
  await page.mouse.wheel(0, 40);
  check(await page.waitForFunction((from) => scrollY > from, before).then(() => true, () => false), 'the wheel scrolls the page over a scene that was not clicked');
  const shown = await page.locator('.stage').boundingBox();
  await page.mouse.click(shown.x + shown.width / 2, shown.y + shown.height / 2);
  // A wheel that the browser counts to the turn before cannot be kept from scrolling (it says so: not cancelable): the next
  // one that begins a turn of its own is the one that the camera takes.
  await page.evaluate(() => { addEventListener('wheel', (event) => { window.turned = { cancelable: event.cancelable, kept: event.defaultPrevented }; }, { passive: false }); });
  let turned = { cancelable: false, kept: false };
  for (let turns = 0; turns < 60 && !turned.cancelable; turns += 1) {
    await page.evaluate(() => { window.turned = null; });
    await page.mouse.wheel(0, 40);
    turned = await page.waitForFunction(() => window.turned).then((handle) => handle.jsonValue());
    if (!turned.cancelable) await page.waitForTimeout(1000);
  }
  check(turned.kept, `after a click the wheel moves the camera and not the page: ${JSON.stringify(turned)}`);
  const [picture] = await Promise.all([page.waitForEvent('download'), page.getByText('Save PNG').click()]);
  const png = readFileSync(await picture.path());
  check(png.subarray(1, 4).toString() === 'PNG' && png.readUInt32BE(16) === (Math.floor(2 * box.width) & ~1) && png.readUInt32BE(20) === (Math.floor(2 * box.height) & ~1),
    `a frame as PNG, twice as fine as the page: ${png.readUInt32BE(16)} x ${png.readUInt32BE(20)} of ${box.width} x ${box.height}`);
  await context.close();
}

// ---- the motion as video: every frame at its time, however long it takes to draw; stopped, there is none ------------------
{
  const { ALL_FORMATS, BlobSource, EncodedPacketSink, Input } = packagesOf(source)('mediabunny');
  const shortest = data.replays.map((replay) => replay.trial).reduce((a, b) => (cells.time_end_s[trials.indexOf(a)] < cells.time_end_s[trials.indexOf(b)] ? a : b));
  const { context, page } = await open(html, { hash: `#trial=${shortest}`, width: 240, height: 500, webgl: true });
  await page.locator('#replay').scrollIntoViewIfNeeded();
  await page.waitForFunction((trial) => document.querySelector('.stage-box')?.dataset.trial === trial, shortest);
  await page.getByLabel('Speed').selectOption('4');
  const [film] = await Promise.all([page.waitForEvent('download', { timeout: 600000 }), page.getByText('Save WebM').click()]);
  const input = new Input({ formats: ALL_FORMATS, source: new BlobSource(new Blob([readFileSync(await film.path())])) });
  const track = await input.getPrimaryVideoTrack();
  const times = [];
  for await (const packet of new EncodedPacketSink(track).packets()) times.push(packet.timestamp);
  const end = Number(/of ([\d.]+) s/.exec(await page.locator('.clock').innerText())[1]);
  const frames = Math.ceil((end / 4) * 30) + 1;
  check(Math.abs(times.length - frames) <= 1, `${times.length} frames of ${frames}`);
  check(times.every((t, k) => Math.abs(t - k / 30) < 2e-3), `thirty a second: ${times.slice(0, 4)}`);
  check(track.codec === 'vp9', `VP9 in WebM: ${track.codec}`);
  await page.getByText('Save WebM').click();
  await page.getByText(/^Stop at/).click();
  await page.getByText('Save WebM').waitFor();
  await context.close();
}

// ---- Back leads back, lists are one stop of the Tab key, and figures are saved --------------------------------------------------------------
{
  const { context, page } = await open(html, { near: true });
  await page.getByRole('navigation').getByText('Failures').click();
  await page.waitForFunction(() => scrollY > 1000);
  await page.locator('.atlas article').first().getByRole('button', { name: 'List' }).click();
  await page.waitForFunction(() => location.hash.includes('in=trials'));
  const deep = await page.evaluate(() => scrollY);
  await page.goBack();
  await page.waitForFunction(() => location.hash.includes('in=failures') && !location.hash.includes('outcome='));
  await page.waitForFunction((from) => scrollY < from - 300, deep);
  await page.goBack();
  await page.waitForFunction(() => !location.hash.includes('in='));
  check(page.url().startsWith('file:'), 'Back stays within the page');
  await figuresFollow(page);
  const stops = await page.evaluate(() => [...document.querySelectorAll('a[href], button, input, select, summary, [tabindex]')].filter((e) => e.tabIndex >= 0 && !e.disabled && e.getClientRects().length > 0).length);
  check(stops < 75, `${stops} stops of the Tab key`);
  await page.locator('.shelf button').first().focus();
  await page.keyboard.press('ArrowDown');
  check(await page.evaluate(() => document.activeElement === document.querySelectorAll('.shelf button')[1]), 'an arrow moves within the list');
  check((await page.locator('.shelf button[tabindex="0"]').count()) === 1, 'a list is one stop');
  // A saved figure says what it shows, and has room around it.
  const figure = page.locator('#figure-arrival');
  await figure.scrollIntoViewIfNeeded();
  await page.waitForSelector('#figure-arrival canvas');
  const svg = await saved(page, figure.getByText('Save SVG'));
  check(svg.includes('<title>Arrived by a given time</title>') && />Arrived by a given time<\/text>/.test(svg), `the title of a saved figure: ${svg.slice(0, 400)}`);
  // In the widest of the fonts that may stand in for the page's own.
  const cut = await page.evaluate((text) => {
    const box = document.body.appendChild(document.createElement('div'));
    box.innerHTML = text.replaceAll("'Inter Variable', Inter", "'DejaVu Sans', Verdana");
    const frame = box.firstChild.getBoundingClientRect();
    const out = [...box.querySelectorAll('text')].filter((t) => t.textContent.trim() !== '').map((t) => [t.textContent, t.getBoundingClientRect()])
      .filter(([, r]) => r.left < frame.left || r.right > frame.right || r.top < frame.top || r.bottom > frame.bottom).map(([t]) => t);
    box.remove();
    return out;
  }, svg);
  check(cut.length === 0, `a saved figure cuts off ${cut}`);
  await context.close();
}

// ---- a phone, light and dark: both controllers, nothing cut off, accessible, as on paper --------------------------------------------------------------
{
  const { context, page } = await open(html, { width: 390, height: 844, ratio: 2, touch: true, scene: true, webgl: false, near: true });
  for (const verdict of await page.locator('.verdict').all()) {
    const box = await verdict.boundingBox();
    check(box.y + box.height < 844, `both controllers are on the first screen of a phone: one ends at ${box.y + box.height}`);
  }
  await figuresFollow(page);
  await noOverflow(page, 'phone');
  await strip(page);
  for (const scheme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme: scheme });
    await page.waitForFunction((wanted) => document.documentElement.dataset.theme === wanted, scheme);
    await drawn(page);
    await accessible(page, source, `phone, ${scheme}`, { view: true });   // page_test.mjs looks at the same elements on a wide screen
  }
  // On paper: as accessible as on the screen.
  await page.setViewportSize({ width: 800, height: 900 });
  await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
  await page.emulateMedia({ media: 'print' });
  await accessible(page, source, 'print');
  await context.close();
}

// ---- what changed from store to store, and notes -------------------------------------------------------------------
{
  const notes = '# Why\n\nA *quick* look at **gains**, see [the paper](https://example.org/a?b=1&c=2).\n\n- one\n- two `x < y`\n\n<script>document.title = "taken"</script>\n\n[bad](javascript:alert(1)) ![pic](https://example.org/x.png)\n';
  const [late, early] = [makeStore('late', 'demo', 20, 1), makeStore('early', 'demo', 20, 1)];
  const quoted = notes.replaceAll("'", "''");
  sql(late, "UPDATE controller SET resolved = json_set(resolved, '$.lambda_q', 0.02) WHERE id IN (SELECT controller_id FROM point WHERE controller = 'moma'); UPDATE invocation SET started = '2025-06-01T08:00:00Z'; "
    + `UPDATE resolved_suite SET resolved = json_set(resolved, '$.notes', '${quoted}');`);
  const page_ = join(work, 'versions.html');
  execFileSync(makeReport, [early, late, page_], { stdio: 'inherit' });
  const { context, page } = await open(page_);
  const changed = await page.locator('.changes').innerText();
  check(changed.includes('moma (late) differs from moma (early) in lambda_q: 0.01 \u2192 0.02.'), `what changed: ${changed}`);
  check(changed.includes('holistic (late) has the settings of holistic (early).'), `and what did not: ${changed}`);
  const told = page.locator('.notes');
  check((await told.locator('strong').innerText()) === 'gains' && (await told.locator('li').count()) === 2 && (await told.locator('code').innerText()) === 'x < y', 'notes are read as Markdown');
  check((await told.locator('a').evaluateAll((links) => links.map((a) => a.href).join())) === 'https://example.org/a?b=1&c=2', 'links lead to web pages only');
  check((await told.locator('img, script').count()) === 0 && (await told.innerText()).includes('<script>') && (await page.title()) !== 'taken', 'of HTML the text is shown');
  await accessible(page, source, 'versions', { parts: '#top, #provenance' });
  await context.close();
}
await browser.close();
end('the page in its reader\u2019s hands');
