// The report page. Everything it shows is in the data block of the same file; nothing is fetched.

import './style.css';

import { drawWhenIdle } from './chart';
import { Model, readPageData } from './data';
import { append, h, replace } from './dom';
import { arrival } from './figures/arrival';
import { difficulty } from './figures/difficulty';
import { distribution } from './figures/distribution';
import { outcomes } from './figures/outcomes';
import { paired } from './figures/paired';
import { tuning } from './figures/tuning';
import { isSwept, sweep } from './figures/sweep';
import { timing } from './figures/timing';
import { player } from './replay/player';
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

function start(app: HTMLElement): void {
  startTheme();
  state.start();
  const model = new Model(readPageData());
  startView(model);
  if (model.trials.n === 0) {
    replace(app, masthead(model), h('main', null, section('provenance', 'Provenance', provenance(model))));
    return;
  }
  const sections: [id: string, title: string, content: () => Node[], link?: string][] = [
    ['results', 'Results', () => [summary(model), outcomes()]],
    ['time', 'Time to goal', () => [arrival()], 'Time'],
    ['difficulty', 'Difficulty', () => [difficulty()]],
    ...(isSwept(model) ? [['sweep', 'Sweep', () => sweep(model)] as [string, string, () => Node[]]] : []),
    ...(model.page.tuning.length > 0 ? [['tuning', 'Tuning', () => tuning(model)] as [string, string, () => Node[]]] : []),
    ['quality', 'Quality of motion', () => [
      distribution('manipulability', 'Manipulability', 'How the trials of each controller are spread, failures included. Choose any metric.', 'manip_mean'),
      distribution('metric', 'Any other metric', 'The same for a second metric, to read side by side.', 'command_change_mean'),
    ], 'Quality'],
    ['pairs', 'World by world', () => [paired()], 'Pairs'],
    ['failures', 'Failures', () => [failures(model)]],
    ['replay', 'Replay', () => [player(model)]],
    ['timing', 'Timing', () => [timing()]],
    ['trials', 'Trials', () => [trials(model)]],
    ['provenance', 'Provenance', () => [provenance(model)]],
  ];
  const bar = toolbar(model, sections.map(([id, title, , link]) => [id, link ?? title] as const));
  const skip = h('a', { class: 'skip', href: '#results', click: (event) => {
    event.preventDefault();
    document.getElementById('results')?.scrollIntoView();
  } }, 'Skip to the results');
  replace(app, skip, masthead(model), bar.element);
  // The verdict is painted before the rest is built.
  requestAnimationFrame(() => setTimeout(() => {
    append(app,
      h('main', null, ...sections.map(([id, title, content]) => section(id, title, ...content()))),
      h('footer', { class: 'colophon' }, h('p', null, 'Rates carry 95 % Wilson intervals. Keys: Tab moves between controls; in the table, arrows choose and Enter plays; in the replay, space plays and arrows step. The address keeps the view.'),
        h('p', null, 'Drawn with Apache ECharts (Apache-2.0) and three.js (MIT); set in Inter and Source Serif 4 (OFL-1.1).')));
    bar.watch();
    drawWhenIdle();
  }));
}

const app = document.getElementById('app');
if (app !== null) {
  try {
    start(app);
  } catch (error) {
    replace(app, h('p', { class: 'broken' }, `This page cannot be shown: ${error instanceof Error ? error.message : String(error)}`));
    throw error;
  }
}
