// Trials side by side, each as its replay shows its last moment, as PNG or JPEG:
//   node sheet.mjs ADDRESS OUT COLUMNS TRIAL=CAPTION [TRIAL=CAPTION ...]
// ADDRESS is that of `moma view`, or a page file that holds the trials. Needs chromium and this folder's npm packages.
import { existsSync } from 'node:fs';
import { resolve } from 'node:path';
import { chromium } from 'playwright-core';

const [, , address, out, columns, ...trials] = process.argv;
if (trials.length === 0) {
  console.error('usage: node sheet.mjs ADDRESS OUT COLUMNS TRIAL=CAPTION [TRIAL=CAPTION ...]');
  process.exit(2);
}
const url = /^https?:/.test(address) ? address : `file://${resolve(address)}`;
const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--enable-unsafe-swiftshader', '--use-angle=swiftshader'] });

// A stage that is not drawn yet is one colour, and its PNG small.
const kEmptyBytes = 10000;

async function picture(page, trial) {
  await page.evaluate((key) => { location.hash = `trial=${key}`; }, trial);
  const stage = page.locator('.stage-box');
  const loaded = () => stage.evaluate((element, key) => element.dataset.trial === key, trial);
  for (let i = 0; i < 300 && !(await loaded()); ++i) {
    // A served page reads a motion when it is asked to play it.
    if (i === 5) await page.locator('#trials .detail button.play').first().click();
    await page.waitForTimeout(100);
  }
  if (!(await loaded())) throw new Error(`trial ${trial} is not shown`);
  const scrub = page.locator('.transport input[type=range]');
  for (let i = 0; i < 10; ++i) {
    await stage.scrollIntoViewIfNeeded();
    await scrub.evaluate((input) => { input.value = input.max; input.dispatchEvent(new Event('input', { bubbles: true })); });
    await page.waitForTimeout(700);
    const image = await page.locator('canvas.stage').screenshot();
    if (image.length > kEmptyBytes) return image.toString('base64');
  }
  throw new Error(`trial ${trial} is not drawn`);
}

const page = await browser.newPage({ viewport: { width: 900, height: 900 }, colorScheme: 'light' });
await page.goto(url);
await page.waitForSelector('main');
// The bar on top would lie over the pictures.
await page.addStyleTag({ content: '.toolbar { display: none }' });
await page.locator('.replay').scrollIntoViewIfNeeded();
const cells = [];
for (const text of trials) {
  const [trial, ...caption] = text.split('=');
  cells.push({ image: await picture(page, trial), caption: caption.join('=') });
}
const sheet = await browser.newPage({ viewport: { width: 1280, height: 400 } });
await sheet.setContent(`<style>body { margin: 0; display: grid; grid-template-columns: repeat(${Number(columns)}, 1fr); gap: 10px; padding: 10px; font: 15px/1.35 sans-serif; background: #fff }
figure { margin: 0 } img { width: 100%; display: block } figcaption { padding: 4px 2px 8px; white-space: pre-line }</style>`);
await sheet.evaluate((all) => {
  for (const { image, caption } of all) {
    const figure = document.createElement('figure');
    const picture = document.createElement('img');
    picture.src = `data:image/png;base64,${image}`;
    const text = document.createElement('figcaption');
    text.textContent = caption;
    figure.append(picture, text);
    document.body.append(figure);
  }
}, cells);
await sheet.waitForTimeout(500);
await sheet.screenshot({ path: out, fullPage: true, ...(out.endsWith('.jpg') ? { type: 'jpeg', quality: 82 } : {}) });
await browser.close();
