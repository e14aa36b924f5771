// A picture of a report page: node screenshot.mjs PAGE.html OUT.png [WIDTH] [light|dark] [HEIGHT] [SELECTOR] [SECONDS]
// Without HEIGHT the whole page; with SELECTOR that part of it, for instance .replay, at SECONDS of its motion. Needs chromium and this folder's npm packages.
import { existsSync } from 'node:fs';
import { resolve } from 'node:path';
import { chromium } from 'playwright-core';

const [, , html, out, width = '1280', scheme = 'light', height, selector, seconds] = process.argv;
if (html === undefined || out === undefined) {
  console.error('usage: node screenshot.mjs PAGE.html OUT.png [WIDTH] [light|dark] [HEIGHT] [SELECTOR] [SECONDS]');
  process.exit(2);
}
const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--enable-unsafe-swiftshader', '--use-angle=swiftshader-webgl'] });
const page = await browser.newPage({ viewport: { width: Number(width), height: Number(height ?? 900) }, colorScheme: scheme, reducedMotion: 'reduce' });
await page.goto(`file://${resolve(html)}`);
await page.waitForSelector('main');
await page.evaluate(() => document.documentElement.style.setProperty('scroll-behavior', 'auto'));
// Every figure is drawn when nothing else is to do; nothing moves any more then.
await page.waitForFunction(() => [...document.querySelectorAll('.figure .plot')].every((plot) => plot.children.length > 0));
const frames = () => page.evaluate(() => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(() => done())); }));
await page.evaluate(() => scrollTo(0, 0));
await frames();
if (selector === undefined) await page.screenshot({ path: out, fullPage: height === undefined });
else {
  await page.addStyleTag({ content: '.toolbar { display: none }' });   // it would lie over the picture
  const part = page.locator(selector).first();
  await part.scrollIntoViewIfNeeded();
  if (seconds !== undefined) {
    await page.waitForSelector('.stage-box[data-trial]');
    await page.locator('.transport input[type=range]').evaluate((input, value) => { input.value = value; input.dispatchEvent(new Event('input', { bubbles: true })); }, seconds);
  }
  await frames();
  await part.screenshot({ path: out });
}
await browser.close();
