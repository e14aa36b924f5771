// The page on paper, and its figures' pixels: paper_test.mjs SOURCE_DIR MAKE_REPORT WORK_DIR
// Exit 0: passed; 1: failed; 77: left out, since node's packages, python3, chromium, librsvg2-bin or poppler-utils are missing.
import { join } from 'node:path';

import { check, dataOf, drawn, end, figuresFollow, launch, near, needs, opener, showTip, workshop } from './kit.mjs';
import { figuresAreSaved, pixelsOf, run, textsOf } from './paper_kit.mjs';

const [, , source, makeReport, work] = process.argv;
needs('python3', 'rsvg-convert', 'pdftoppm', 'pdftotext', 'pdftocairo', 'pdfimages');
const { makeStore, makePage, sql } = workshop(source, makeReport, work);

const hexAt = ({ rgb }, i) => `#${rgb.subarray(3 * i, 3 * i + 3).toString('hex')}`;

const browser = await launch(source);
const open = opener(browser);

// ---- hostile names are text, on the screen and in saved figures --------------------------------------------------------------
{
  const html = makePage(makeStore('hostile', 'hostile', 24, 2));
  const { context, page } = await open(html, { near: true });
  await figuresFollow(page);
  check((await page.title()).startsWith('</script><script>document.title="taken"</script>'), `hostile names are the title's text: ${await page.title()}`);
  check((await page.locator('h1').innerText()).includes('</script><script>'), 'hostile suite shows as text');
  check((await page.locator('.verdict h2').nth(1).innerText()) === 'quo"te\'s & <b>bold</b>', 'hostile controller shows as text');
  check((await page.locator('.facts').innerText()).includes('机器人'), 'names that are not ASCII show');
  check((await page.locator('#app b').allInnerTexts()).every((text) => text !== 'bold'), 'no markup from names');
  check((await showTip(page, 'figure-outcomes')) !== null, 'hostile: a figure has a tooltip');
  check((await page.evaluate(() => [...document.querySelectorAll('b')].some((b) => b.textContent === 'bold'))) === false, 'no markup in tooltips');
  await figuresAreSaved(page, join(work, 'figures'), 'hostile');
  await context.close();
}

// ---- the curve of arrivals is level where nobody arrives, at every pixel ratio ------------------------------------------
{
  const db = makeStore('level', 'demo', 500, 0);
  // Half of holistic's trials arrive from 3 s to 4 s, one of the rest at 16 s: level in between.
  sql(db, "UPDATE trial SET outcome = 'success', time_to_goal_s = NULL; UPDATE trial SET outcome = 'timeout'; "
    + "CREATE TEMP TABLE mine AS SELECT key, world_index FROM point_trial WHERE point_id = (SELECT id FROM point WHERE controller = 'holistic'); "
    + "UPDATE trial SET outcome = 'success', time_to_goal_s = 3 + (SELECT world_index FROM mine WHERE mine.key = trial.key) / 250.0 WHERE key IN (SELECT key FROM mine WHERE world_index < 250); "
    + "UPDATE trial SET outcome = 'success', time_to_goal_s = 16 WHERE key = (SELECT key FROM mine WHERE world_index = 300); "
    + 'UPDATE point_trial SET outcome = (SELECT outcome FROM trial WHERE trial.key = point_trial.key), time_to_goal_s = (SELECT time_to_goal_s FROM trial WHERE trial.key = point_trial.key);');
  const html = makePage(db);
  for (const ratio of [1, 2]) {
    const { context, page } = await open(html, { ratio });
    await page.locator('#figure-arrival').scrollIntoViewIfNeeded();
    await page.waitForSelector('#figure-arrival canvas');
    await drawn(page);
    const heights = await page.evaluate(() => {
      const canvas = document.querySelector('#figure-arrival canvas');
      const { width, height } = canvas;
      const pixels = canvas.getContext('2d').getImageData(0, 0, width, height).data;
      const scale = width / canvas.clientWidth;
      const out = [];
      // The plot spans 0 to 19 s from about 70 px to the names; 5 s to 14 s lies well inside of the level stretch.
      for (let x = Math.round(0.36 * width); x < 0.7 * width; x += Math.round(4 * scale)) {
        for (let y = 0; y < height; ++y) {
          const i = 4 * (y * width + x);
          if (pixels[i + 3] > 200 && Math.abs(pixels[i] - 0x27) < 24 && Math.abs(pixels[i + 1] - 0x59) < 24 && Math.abs(pixels[i + 2] - 0x8f) < 24) {
            out.push(y / scale);
            break;
          }
        }
      }
      return out;
    });
    check(heights.length > 40, `ratio ${ratio}: the curve is found in ${heights.length} columns`);
    check(Math.max(...heights) - Math.min(...heights) < 0.6, `ratio ${ratio}: the level stretch goes from ${Math.max(...heights)} to ${Math.min(...heights)} px`);
    await context.close();
  }
}

// ---- print, from a dark screen, of a page that nobody has scrolled ------------------------------------------------------
{
  const html = makePage(makeStore('demo', 'demo', 60, 2));
  const data = dataOf(html);
  const { context, page } = await open(html, { scheme: 'dark', width: 1440, webgl: true });
  const pdf = join(work, 'print.pdf');
  await page.pdf({ path: pdf, format: 'A4' });   // without backgrounds, as readers print
  const texts = textsOf(pdf);
  const all = texts.join('\n');
  check(texts.length < 25 && texts.every((text) => text.trim() !== ''), `a print of ${texts.length} sheets, none of them empty`);
  for (const words of ['Results', 'Arrived by a given time', 'Success against goal distance', 'on the same worlds', 'Replay', 'Provenance', 'Failures']) check(all.includes(words), `the print has ${words}`);
  check(/holistic fails (mainly|most often) in \w+: /.test(texts[0]), 'the first page says where the one behind fails, though nothing waited for it');
  check(!/^\s*Trials\s*$/m.test(all), 'no heading of a part that is not printed');
  texts.forEach((text, i) => {
    const last = text.trimEnd().split('\n').pop() ?? '';
    check(!/^(Results|Time to goal|Difficulty|Quality of motion|World by world|Failures|Replay|Timing|Provenance)$/.test(last.trim()), `page ${i + 1} ends with the heading ${last.trim()}`);
  });
  // Marks: the dots of the scatter plot, as paths of the series' colours.
  const metrics = ['goal_distance_m', 'manip_mean'].map((key) => data.trials.columns[key]);
  const successes = data.trials.columns.outcome.codes.map((code) => data.trials.columns.outcome.values[code] === 'success');
  const dots = successes.filter((ok, row) => ok && metrics.every((column) => column[row] !== null)).length;
  const scatter = texts.findIndex((text) => text.includes('against goal distance') && text.includes('rank correlation')) + 1;
  check(scatter > 0, 'the scatter plot is printed');
  const marks = run('pdftocairo', '-svg', '-f', String(scatter), '-l', String(scatter), pdf, '-').toString();
  const filled = (hex) => {
    const wanted = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 2.55);
    return [...marks.matchAll(/fill[:=]"?rgb\(([\d.]+)%,\s?([\d.]+)%,\s?([\d.]+)%\)"?;?\s?fill-opacity[:=]"?([\d.]+)/g)].filter((m) => wanted.every((v, i) => near(v, Number(m[i + 1]), 0.3)) && near(Number(m[4]), 0.55, 0.01)).length;
  };
  const counted = filled('#27598f') + filled('#d96294');
  check(counted === dots, `the print has ${counted} dots of ${dots} successes`);
  check(run('pdfimages', '-list', pdf).toString().trim().split('\n').length >= 4, 'the replay is printed as pictures');
  // Dark ink on white, though the screen is dark, and bars with their colours.
  const [first] = pixelsOf(pdf, 60, 1);
  const counts = new Map();
  for (let i = 0; i < first.width * first.height; ++i) counts.set(hexAt(first, i), (counts.get(hexAt(first, i)) ?? 0) + 1);
  check((counts.get('#ffffff') ?? 0) > 0.7 * first.width * first.height, 'the paper is white');
  let darkest = 255;
  for (const colour of counts.keys()) darkest = Math.min(darkest, parseInt(colour.slice(3, 5), 16));
  check(darkest < 60, `the darkest ink is ${darkest}`);
  // The whiskers of the verdicts, which are backgrounds on the screen: the longest of a controller is as long as its widest interval.
  const [sharp] = pixelsOf(pdf, 150, 1);
  const longest = (hex) => {
    const wanted = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
    let [most, run] = [0, 0];
    for (let i = 0; i < sharp.width * sharp.height; ++i) {
      run = i % sharp.width !== 0 && wanted.every((v, k) => near(v, sharp.rgb[3 * i + k], 30)) ? run + 1 : 0;
      most = Math.max(most, run);
    }
    return most;
  };
  const widest = data.overall.map(({ controller }) => Math.max(...[...data.overall, ...data.summary].filter((row) => row.controller === controller).map((row) => row.success_high - row.success_low)));
  const lengths = ['#27598f', '#d96294'].map(longest);
  check(lengths.every((length) => length > 60) && near(lengths[0] / lengths[1], widest[0] / widest[1], 0.06), `printed whiskers are ${lengths} long, of intervals of ${widest}`);
  check((await page.evaluate(() => document.documentElement.dataset.theme)) === 'dark', 'after the print the screen is dark again');
  check((await page.locator('.on-paper').evaluateAll((places) => places.every((place) => place.childElementCount === 0))), 'and holds nothing of the print');
  await context.close();
}
await browser.close();
end('the page on paper');
