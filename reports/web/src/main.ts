// The report page. Everything that a written report shows is in the data block of the same file, and nothing is fetched;
// the page of `moma view` asks the server that it came from.

import './style.css';

import { figure } from './figure';
import { drawWhenIdle } from './later';
import { startPaper } from './paper';
import { Model, readPageData, type PageData } from './data';
import { append, h, replace } from './dom';
import { kFigures } from './figures/all';
import { tuning } from './figures/tuning';
import { isSwept } from './figures/sweep';
import { liveLine } from './live';
import { startFilm } from './replay/film_page';
import { player } from './replay/player';
import { comparison } from './sections/comparison';
import { failures } from './sections/failures';
import { masthead } from './sections/masthead';
import { provenance } from './sections/provenance';
import { summary } from './sections/summary';
import { toolbar } from './sections/toolbar';
import { trials } from './sections/trials';
import * as state from './state';
import { startTheme } from './theme';
import { startView } from './view';

function section(id: string, title: string, ...content: Node[]): HTMLElement {
  return h('section', { id, 'aria-labelledby': `${id}-title` }, h('h2', { id: `${id}-title` }, title), ...content);
}

function start(app: HTMLElement, page: PageData): void {
  const model = new Model(page);
  startView(model);
  if (page.film !== undefined) {
    startFilm(app, model, page.film);
    return;
  }
  const live = liveLine(model);
  if (model.trials.n === 0) {
    replace(app, masthead(model, live), h('main', null, section('provenance', 'Provenance', provenance(model))));
    return;
  }
  const drawn = (part: keyof typeof kFigures): Node[] => kFigures[part](model).map(figure);
  const several = new Set(page.points.map((p) => [p.suite, p.controller, p.point].join('\n'))).size > 1;
  type Section = [id: string, title: string, content: () => Node[]];
  const sections: Section[] = [
    ...(page.tuning.length > 0 ? [['tuning', 'Tuning', () => tuning(model)] as Section] : []),   // what the search was made for
    ['results', 'Results', () => [summary(model), ...drawn('results')]],
    ['time', 'Time', () => drawn('time')],
    ['difficulty', 'Difficulty', () => drawn('difficulty')],
    ...(isSwept(model) ? [['sweep', 'Sweep', () => drawn('sweep')] as Section] : []),
    ['quality', 'Quality', () => drawn('quality')],
    ['pairs', 'Pairs', () => [...(several ? [comparison(model)] : []), ...drawn('pairs')]],
    ['failures', 'Failures', () => [failures(model)]],
    ['replay', 'Replay', () => [player(model).element]],
    ['timing', 'Timing', () => drawn('timing')],
    ['trials', 'Trials', () => [trials(model)]],
    ['provenance', 'Provenance', () => [provenance(model)]],
  ];
  const bar = toolbar(model, sections.map(([id, title]) => [id, title] as const));
  const skip = h('a', { class: 'skip', href: '#results', click: (event) => {
    event.preventDefault();
    document.getElementById('results')?.scrollIntoView();
  } }, 'Skip to the results');
  replace(app, skip, masthead(model, live), bar.element);
  // The verdict is painted before the rest is built.
  requestAnimationFrame(() => setTimeout(() => {
    append(app,
      h('main', null, ...sections.map(([id, title, content]) => section(id, title, ...content()))),
      h('footer', { class: 'colophon' }, h('p', null, 'Rates carry 95 % Wilson intervals. Keys: Tab moves between controls; in the table, arrows choose and Enter plays; in the replay, space plays and arrows step. The address keeps the view.'),
        h('p', null, 'Drawn with Apache ECharts (Apache-2.0) and three.js (MIT), filmed with Mediabunny (MPL-2.0); set in Inter and Source Serif 4 (OFL-1.1).')));
    bar.watch();
    drawWhenIdle();
    // A link that names a part of the page; reading on or going back is the browser's.
    if (state.get('in') !== '' && scrollY === 0) document.getElementById(state.get('in'))?.scrollIntoView();
    startPaper();
  }));
}

const app = document.getElementById('app');
if (app !== null) {
  startTheme();
  state.start();
  replace(app, h('p', { class: 'reading' }, 'Reading the store\u2026'));
  readPageData().then((page) => start(app, page)).catch((error: unknown) => {
    replace(app, h('p', { class: 'broken' }, `This page cannot be shown: ${error instanceof Error ? error.message : String(error)}`));
    throw error;
  });
}
