// The report page. A written report holds all its data in one file and fetches nothing; the page of `moma view` requests
// its data from its own server.

import './style.css';

import { drawSoon } from './draw_order';
import { Model, readPageData, type PageData } from './data';
import { append, h, replace } from './dom';
import { said } from './format';
import { goToSection } from './go_to';
import { isSwept } from './figures/swept';
import { liveLine } from './live';
import { masthead } from './sections/masthead';
import { provenance } from './sections/provenance';
import { toolbar } from './sections/toolbar';
import * as state from './state';
import { startTheme } from './theme';
import { startView } from './view';

const kSections = [
  ['risk', 'Rare events'], ['tuning', 'Tuning'], ['results', 'Results'], ['time', 'Time'], ['difficulty', 'Difficulty'], ['sweep', 'Sweep'], ['quality', 'Quality'],
  ['pairs', 'Pairs'], ['failures', 'Failures'], ['replay', 'Replay'], ['timing', 'Timing'], ['trials', 'Trials'], ['provenance', 'Provenance'],
] as const;

function section(id: string, title: string, ...content: Node[]): HTMLElement {
  return h('section', { id, 'aria-labelledby': `${id}-title` }, h('h2', { id: `${id}-title` }, title), ...content);
}

function start(app: HTMLElement, page: PageData): void {
  const model = new Model(page);
  startView(model);
  const live = liveLine(model);
  const rare = page.invocations.some((i) => i.risk !== null);
  if (model.trials.n === 0 && !rare) {
    replace(app, masthead(model, live), h('main', null, section('provenance', 'Provenance', provenance(model))));
    return;
  }
  const filled = model.trials.n > 0;
  const present: Record<string, boolean> = { risk: rare, tuning: filled && page.tuning.length > 0, sweep: filled && isSwept(model), provenance: true };
  const sections = kSections.filter(([id]) => present[id] ?? filled);
  const bar = toolbar(model, sections);
  const skip = h('a', { class: 'skip', href: '#results', click: (event) => {
    event.preventDefault();
    goToSection('results');
  } }, 'Skip to the results');
  replace(app, skip, masthead(model, live), bar.element);
  // The verdict is painted before the rest is built.
  requestAnimationFrame(() => setTimeout(() => void import('./contents').then(({ contents, startPaper }) => {
    const made = contents(model);
    append(app,
      h('main', null, ...sections.map(([id, title]) => section(id, title, ...(made[id]?.() ?? [])))),
      h('footer', { class: 'colophon' }, h('p', null, 'Rates carry 95 % Wilson intervals. Keys: Tab moves between controls; in the table, arrows choose and Enter plays; in the replay, space plays and arrows step. The address keeps the view.'),
        h('p', null, 'Drawn with Apache ECharts (Apache-2.0) and three.js (MIT), filmed with Mediabunny (MPL-2.0); set in Inter and Source Serif 4 (OFL-1.1).')));
    bar.watch();
    drawSoon(100);
    // A link that names a part of the page; reading on or going back is the browser's.
    if (scrollY === 0) goToSection(state.get('in'));
    // An address that the reader typed or pasted; entries of the page's own history have a state, and the browser scrolls to where they were.
    addEventListener('hashchange', () => { if (history.state === null) goToSection(state.get('in')); });
    startPaper();
  })));
}

const app = document.getElementById('app');
if (app !== null) {
  startTheme();
  state.start();
  replace(app, h('p', { class: 'reading' }, 'Reading the store\u2026'));
  readPageData().then((page) => start(app, page)).catch((error: unknown) => {
    replace(app, h('p', { class: 'broken' }, `This page cannot be shown: ${said(error)}`));
    throw error;
  });
}
