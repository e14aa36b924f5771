// What the tests of the page share: programs that must be there, stores, pages, checks.
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';

export const skip = (why) => {
  console.log(`skipped: ${why}; scripts/setup.sh installs what is missing`);
  process.exit(77);
};

/** Node's packages of the page. */
export const packagesOf = (source) => createRequire(join(source, 'reports/web/package.json'));

export const needs = (...programs) => {
  for (const program of programs) if (spawnSync('which', [program]).status !== 0) skip(`there is no ${program}`);
};

let failures = 0;
export const check = (ok, what) => {
  if (!ok) {
    failures += 1;
    console.log(`FAILED: ${what}`);
  }
};
export const near = (a, b, tolerance) => Math.abs(a - b) <= tolerance;

/** Exit 0: passed; 1: failed. */
export const end = (what) => {
  console.log(failures === 0 ? `${what} passed` : `${failures} checks failed`);
  process.exit(failures === 0 ? 0 : 1);
};

/**
 * Chromium on a busy machine now and then draws no further frame of a page: its compositor holds new content back until tiles are
 * drawn, and nobody draws them. Scripts, timers and other pages go on; a new size, a screenshot or the front place do not help. What
 * waits for a frame then waits for ever: the test begins anew, three times at most, in a process and a browser of its own.
 */
const beginAnew = () => {
  const begun = Number(process.env.MOMA_PAGE_TEST_BEGUN ?? 0);
  console.log(`the browser draws no further frame: ${begun < 3 ? 'begins anew' : 'it did so four times'}`);
  if (begun === 3) process.exit(1);
  const { status } = spawnSync(process.execPath, process.argv.slice(1), { stdio: 'inherit', env: { ...process.env, MOMA_PAGE_TEST_BEGUN: String(begun + 1) } });
  process.exit(status ?? 1);
};

/** Runs in the page, before its own script: asks for a frame each second, and says so when the next 20 seconds bring none though the page's timers run. */
const watchFrames = () => {
  let seconds = 0;
  setInterval(() => {
    seconds += 1;
    if (seconds === 1) requestAnimationFrame(() => { seconds = 0; });
    if (seconds === 20) window.drawsNoFrame();
  }, 1000);
};

// The first four draw the browser's own address bar as a page, in a process that costs half a second for each page of a test. The
// others are those that playwright disables: the last list given counts alone.
const kDisabled = 'WebUIOmniboxPopup,WebUIOmniboxFullPopup,WebUIOmniboxAimPopup,OmniboxAimPopup,AvoidUnnecessaryBeforeUnloadCheckSync,'
  + 'BoundaryEventDispatchTracksNodeRemoval,DestroyProfileOnBrowserClose,DialMediaRouteProvider,GlobalMediaControls,HttpsUpgrades,LensOverlay,'
  + 'MediaRouter,PaintHolding,ThirdPartyStoragePartitioning,Translate,AutoDeElevate,RenderDocument,OptimizationHints';

export const launch = (source) => {
  const executablePath = ['/usr/bin/chromium-headless-shell', '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
  if (executablePath === undefined) skip('there is no chromium');
  let chromium;
  try {
    ({ chromium } = packagesOf(source)('playwright-core'));
  } catch {
    skip('playwright-core is not in reports/web/node_modules');
  }
  return chromium.launch({
    executablePath, headless: true,
    // WebGL in software, and nothing else through it: pages and figures are drawn without a graphics card's detour, in half the time.
    // Scripts of short-lived pages are compiled and cleared away within one thread: others cost more than they spare.
    args: ['--no-sandbox', '--js-flags=--single-threaded', '--enable-unsafe-swiftshader', '--use-angle=swiftshader-webgl', '--disable-smooth-scrolling',
      '--disable-background-networking', '--disable-component-update', '--disable-sync', '--no-first-run', `--disable-features=${kDisabled}`],
  });
};

/** The interpreter itself: what a PATH has may be a script that looks for it at every call. */
export const kPython = process.env.MOMA_PYTHON || 'python3';

/** Stores and pages of one test, in a folder of its own. */
export const workshop = (source, makeReport, work) => {
  rmSync(work, { recursive: true, force: true });
  mkdirSync(work, { recursive: true });
  const made = new Map();   // equal stores are made once
  const makeStore = (name, kind, worlds, samples = 8, whole = 0, ...more) => {
    const db = join(work, `${name}.db`);
    const what = ['--kind', kind, '--worlds', String(worlds), '--samples', String(samples), '--whole', String(whole), ...more];
    if (made.has(what.join())) writeFileSync(db, made.get(what.join()));
    else {
      execFileSync(kPython, [join(source, 'tests/tools/make_store.py'), process.env.MOMA_STORE_DEFINITION, db, ...what], { stdio: 'inherit' });
      made.set(what.join(), readFileSync(db));
    }
    return db;
  };
  const sql = (db, text) => execFileSync(kPython, ['-c', `import sqlite3; db = sqlite3.connect(${JSON.stringify(db)}); db.executescript(${JSON.stringify(text)}); db.close()`]);
  const makePage = (db) => {
    const html = db.replace(/\.db$/, '.html');
    execFileSync(makeReport, [db, html], { stdio: 'inherit' });
    return html;
  };
  /** A store whose every third world ended in a program error. */
  const makeErrors = (name, worlds) => {
    const db = makeStore(name, 'demo', worlds, 2);
    for (const table of ['trial', 'point_trial']) sql(db, `UPDATE ${table} SET outcome = 'error', time_to_goal_s = NULL WHERE key IN (SELECT key FROM point_trial WHERE world_index % 3 = 0)`);
    return db;
  };
  return { makeErrors, makeStore, makePage, sql };
};

export const dataOf = (html) => JSON.parse(readFileSync(html, 'utf8').split('id="moma-data">')[1].split('</script')[0]);

/** Runs in the page, before its own script: edges of a scene are not smoothed, for which software draws each pixel four times. */
const withoutSmoothing = () => {
  const { getContext } = HTMLCanvasElement.prototype;
  HTMLCanvasElement.prototype.getContext = function context(kind, options) { return getContext.call(this, kind, kind.startsWith('webgl') ? { ...options, antialias: false } : options); };
};

/**
 * Runs in the page, before its own script: a WebGL that takes every call and draws nothing. The scene is built as ever; its shaders,
 * which software compiles in half a second, are left to the tests that look at its pixels.
 */
const withoutWebGL = () => {
  const { getContext } = HTMLCanvasElement.prototype;
  const kinds = WebGL2RenderingContext;
  const answers = {
    getParameter: (which) => ({ [kinds.VERSION]: 'WebGL 2.0', [kinds.SHADING_LANGUAGE_VERSION]: 'WebGL GLSL ES 3.00' })[which]
      ?? ([kinds.VIEWPORT, kinds.SCISSOR_BOX].includes(which) ? [0, 0, 1, 1] : 4096),
    getProgramParameter: (_, which) => (which === kinds.LINK_STATUS ? true : 0), getShaderParameter: () => true,
    getShaderPrecisionFormat: () => ({ precision: 23, rangeMin: 127, rangeMax: 127 }), getContextAttributes: () => ({ antialias: false }),
    checkFramebufferStatus: () => kinds.FRAMEBUFFER_COMPLETE, getSupportedExtensions: () => [], getExtension: () => null,
  };
  const nothing = (name) => (name.startsWith('create') ? () => ({}) : name.endsWith('InfoLog') ? () => '' : () => 0);
  const pretended = (canvas) => new Proxy({ canvas, ...answers }, {
    get: (target, name) => { if (!(name in target)) target[name] = typeof kinds[name] === 'number' ? kinds[name] : nothing(name); return target[name]; },
  });
  HTMLCanvasElement.prototype.getContext = function context(kind, options) { return kind.startsWith('webgl') ? this.pretended ??= pretended(this) : getContext.call(this, kind, options); };
};

/** Makes the replay's scene a strip: in software every pixel of it is dear. */
const asStrip = () => document.head.appendChild(Object.assign(document.createElement('style'), { textContent: '.stage { height: 64px !important; width: 96px !important; }' }));
export const strip = (page) => page.evaluate(asStrip);

/** Runs in the page, before its own script: all of the page counts as near to the window, so that its figures are drawn where nobody scrolls. */
const asNear = () => {
  const Observer = window.IntersectionObserver;
  window.IntersectionObserver = class extends Observer { constructor(call, options) { super(call, { ...options, rootMargin: '100000px' }); } };
};

/**
 * Opens a page and notes everything it must not do. The replay's scene is a strip unless `scene` asks for what readers see, and drawn with `webgl` alone. `idle`: figures that nobody has looked at are drawn, too, when nothing else is to do. `near`: at once. `init` runs in the page before its own script.
 */
export const opener = (browser) => async (html, { width = 1280, height = 900, hash = '', scheme = 'light', ratio = 1, touch = false, served = false, scene = false, webgl = scene, idle = false, near: close = false, init, allowed = () => false } = {}) => {
  const context = await browser.newContext({ viewport: { width, height }, deviceScaleFactor: ratio, hasTouch: touch, offline: !served, colorScheme: scheme, reducedMotion: 'reduce', acceptDownloads: true });
  await context.exposeFunction('drawsNoFrame', beginAnew);
  await context.addInitScript(watchFrames);
  await context.addInitScript(webgl ? withoutSmoothing : withoutWebGL);
  if (!scene) await context.addInitScript(`addEventListener('DOMContentLoaded', ${asStrip})`);
  if (!idle) await context.addInitScript(() => { window.requestIdleCallback = () => 0; });
  if (close) await context.addInitScript(asNear);
  if (init !== undefined) await context.addInitScript(init);
  const page = await context.newPage();
  page.setDefaultTimeout(180000);
  page.on('console', (message) => { if (message.type() === 'error' && !allowed(message.text())) check(false, `console error: ${message.text()}`); });
  page.on('pageerror', (error) => check(false, `page error: ${error.stack}`));
  page.on('dialog', (dialog) => { check(false, 'a dialog opened'); void dialog.dismiss(); });
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url()) && !(served && request.url().startsWith(html))) check(false, `request to ${request.url()}`); });
  await page.goto(served ? `${html}${hash}` : `file://${html}${hash}`);
  await page.waitForSelector('main');   // built after the first paint
  return { context, page };
};

/** Rules whose answer is another one in other colours, widths and media. */
const kOfView = ['color-contrast', 'scrollable-region-focusable', 'image-alt', 'svg-img-alt', 'role-img-alt'];

/** What axe-core finds that is serious or worse, in the page or in parts of it; of elements that were looked at in another `view` before, by the rules that depend on it. */
export const accessible = async (page, source, what, { parts, view = false } = {}) => {
  if (!await page.evaluate(() => 'axe' in window)) await page.evaluate(readFileSync(packagesOf(source).resolve('axe-core/axe.min.js'), 'utf8'));
  const serious = await page.evaluate(async ([of, rules]) => (await window.axe.run(of === undefined ? document : { include: of.split(', ') }, { resultTypes: ['violations'], ...(rules === undefined ? {} : { runOnly: rules }) })).violations
    .filter((v) => v.impact === 'serious' || v.impact === 'critical')
    .map((v) => `${v.id}: ${v.help}: ${v.nodes.slice(0, 3).map((n) => `${n.target} ${n.failureSummary}`).join(' | ')}`), [parts, view ? kOfView : undefined]);
  for (const violation of serious) check(false, `${what}: accessibility: ${violation}`);
};

export const noOverflow = async (page, what) => {
  const [wide, inner] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  check(wide <= inner, `${what}: the page is ${wide} wide in a window of ${inner}`);
};

/** Notes what is written on each canvas and where, in its own pixels, since it was last wiped; runs in the page before its own script. */
export const noteLetters = () => {
  const { fillText, clearRect } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.fillText = function write(text, x, y, ...rest) {
    const m = this.getTransform();
    const scale = Math.hypot(m.a, m.b);
    const at = m.transformPoint({ x, y });
    const wide = this.measureText(text).width * scale;
    const left = at.x - wide * ({ center: 0.5, right: 1, end: 1 }[this.textAlign] ?? 0);
    (this.canvas.letters ??= []).push({ text: text.replace(/\s/g, ' '), left, right: left + wide, y: at.y, size: parseFloat(/([\d.]+)px/.exec(this.font)[1]) * scale, level: m.b === 0, colour: this.fillStyle });
    return fillText.call(this, text, x, y, ...rest);
  };
  CanvasRenderingContext2D.prototype.clearRect = function wipe(x, y, w, h) {
    if (w * this.getTransform().a >= this.canvas.width) this.canvas.letters = [];
    return clearRect.call(this, x, y, w, h);
  };
};

/** No letter is cut off, none lies over another. */
export const legible = ({ width, height, letters }, what) => {
  check(letters.length > 3, `${what}: ${letters.length} texts`);
  for (const a of letters.filter((letter) => letter.level)) {
    check(a.left > -1 && a.right < width + 1 && a.y - a.size / 2 > -1 && a.y + a.size / 2 < height + 1, `${what}: "${a.text}" from ${a.left} to ${a.right} at ${a.y} is cut off in ${width} x ${height}`);
    for (const b of letters) {
      if (b === a || !b.level || a.text.trim() === '' || b.text.trim() === '') continue;
      check(a.right <= b.left + 1 || b.right <= a.left + 1 || Math.abs(a.y - b.y) > 0.4 * (a.size + b.size), `${what}: "${a.text}" lies over "${b.text}"`);
    }
  }
};

/** Waits until the page has drawn what it was asked for: until the frame after the next one. */
export const drawn = (page) => page.evaluate(() => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(() => done())); }));

/** Until every figure is drawn or says why it is not. */
export const figuresStand = (page) => page.waitForFunction(() => [...document.querySelectorAll('.figure .plot')].every((plot) => plot.children.length > 0));

/** The same in a page that was opened as `near`, also after a new size or scheme: until each figure is as wide as its place. */
export const figuresFollow = async (page) => {
  await drawn(page);
  await page.waitForFunction(() => [...document.querySelectorAll('.figure .plot')].every((plot) => {
    const canvas = plot.querySelector('canvas');
    return plot.children.length > 0 && (canvas === null || Math.abs(canvas.clientWidth - plot.clientWidth) < 1);
  }));
  await drawn(page);   // letters follow in the next frame
};

/** What a button gives to the reader as a file. */
export const saved = async (page, button) => {
  await page.evaluate(() => {
    window.kept = null;
    window.makeUrl ??= URL.createObjectURL;
    URL.createObjectURL = (blob) => { window.kept = blob; return window.makeUrl.call(URL, blob); };
    // Chromium drops a page's downloads past ten in a second, silently: these go nowhere.
    window.follow ??= HTMLAnchorElement.prototype.click;
    HTMLAnchorElement.prototype.click = function click() { if (this.download === '') window.follow.call(this); };
  });
  await button.click();
  return page.evaluate(() => window.kept.text());
};

/** Moves over a figure, as a reader could, until a tooltip shows: the colour of its text; null where none does. */
export const showTip = async (page, id) => {
  await page.locator(`#${id}`).scrollIntoViewIfNeeded();
  const box = await page.locator(`#${id} canvas`).boundingBox();
  for (let k = 1; k < 200; ++k) {
    await page.mouse.move(box.x + 80 + ((0.618 * k) % 1) * (box.width - 100), box.y + 40 + ((0.382 * k) % 1) * (box.height - 80));
    const colour = await page.evaluate((figure) => [...document.querySelectorAll(`#${figure} .tip`)].map((tip) => getComputedStyle(tip)).find((style) => style.visibility === 'visible')?.color, id);
    if (colour !== undefined) return colour;
  }
  return null;
};

/** The picture of the scene as it is seen: pixels as [r, g, b]. */
export const picture = async (page) => {
  await drawn(page);
  const text = await page.locator('.stage').evaluate((canvas) => new Promise((done) => requestAnimationFrame(() => {
    document.querySelector('.transport input[type=range]').dispatchEvent(new Event('input', { bubbles: true }));   // draws with the next frame
    requestAnimationFrame(() => {   // in which this comes after it
      const copy = Object.assign(document.createElement('canvas'), { width: canvas.width, height: canvas.height }).getContext('2d');
      copy.drawImage(canvas, 0, 0);
      const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
      let out = '';
      for (let i = 0; i < data.length; i += 32768) out += String.fromCharCode(...data.subarray(i, i + 32768));
      done(btoa(out));
    });
  })));
  const bytes = Buffer.from(text, 'base64');
  return Array.from({ length: bytes.length / 4 }, (_, i) => bytes.subarray(4 * i, 4 * i + 3));
};

/** How many colours a picture has, nearly alike ones as one, by every hundredth pixel. */
export const coloursOf = (pixels) => new Set(pixels.filter((_, i) => i % 101 === 0).map(([r, g, b]) => `${r >> 3},${g >> 3},${b >> 3}`)).size;
