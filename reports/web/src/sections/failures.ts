// The failure atlas: failures that look alike together, the worst of each ready to play.

import { kOutcomeNames, type Model, type Outcome } from '../data';
import { h, replace } from '../dom';
import { integer, percent, plural } from '../format';
import { metric, withUnit } from '../metrics';
import { select } from '../select';
import * as state from '../state';
import { onTheme, palette } from '../theme';
import { onView, view } from '../view';

interface Cluster {
  outcome: Outcome;
  controller: string;
  point: string;
  what: string;
  rows: number[];
}

/** "sphere3" and "sphere7" are one kind of thing; what follows "self:" is kept. */
function kind(object: string): string {
  if (object.startsWith('self:')) return `itself (${object.slice(5)})`;
  const stem = object.replace(/[\s_-]*\d+$/, '') || object;
  return stem === 'object' ? 'an object' : stem;
}

/** "@base" is the mobile base; "hand/2" the second shape of hand. */
function part(link: string): string {
  return link === '@base' ? 'base' : link.replace(/\/\d+$/, '');
}

/** Nearer than this, an object is taken for what holds the robot [m]. */
const kHolds = 0.1;

/**
 * What held a robot that did not arrive, from the situation that the store's reason describes: "0.4 m and 0.1 rad from
 * the goal; link4 is 0.02 m from sphere3; joint4 is 0.01 from its limit". Numbers differ from trial to trial and would
 * make every failure its own cluster.
 */
function cause(reason: string): string {
  const held: string[] = [];
  let told = false;
  for (const text of reason.split(';')) {
    const near = /^\s*(\S+) is ([-+.\deE]+) m from (.+)$/.exec(text);
    const limit = /^\s*(\S+) is ([-+.\deE]+) from its limit$/.exec(text);
    const outside = /^\s*(\S+) at \S+ is outside /.exec(text);
    if (/ from the goal$/.test(text)) told = true;
    else if (outside !== null) return `${outside[1]} beyond its limit`;
    else if (near !== null) {
      if (Number(near[2]) < kHolds) held.push(`${part(near[1] ?? '')} close to ${kind(near[3] ?? '')}`);
    } else if (limit !== null) held.push(`${limit[1]} at its limit`);
  }
  if (held.length > 0) return held.join(', ');
  if (told) return 'clear of objects and limits';
  // Digits that belong to a name stay.
  return reason.replace(/(?<![\w.])-?\d+(\.\d+)?([eE][-+]?\d+)?/g, '\u2026').slice(0, 90);
}

function clusters(model: Model): Cluster[] {
  const t = model.trials;
  const found = new Map<string, Cluster>();
  for (const s of view().series) {
    for (const row of s.rows) {
      const outcome = t.outcome(row);
      if (outcome === 'success') continue;
      const link = t.text('link', row);
      const what = outcome === 'collision' ? `${part(link) || 'robot'} against ${kind(t.text('object', row)) || 'something'}` : cause(t.text('reason', row));
      const key = [outcome, s.index, what].join('\n');
      const cluster = found.get(key) ?? { outcome, controller: s.controller, point: s.point, what, rows: [] };
      cluster.rows.push(row);
      found.set(key, cluster);
    }
  }
  return [...found.values()].sort((a, b) => b.rows.length - a.rows.length);
}

/** How bad: deepest contact, else farthest from the goal. */
function worst(model: Model, cluster: Cluster): number[] {
  const key = cluster.outcome === 'collision' ? 'collision_depth_m' : 'position_error_m';
  const value = (row: number): number => model.trials.number(key, row) || 0;
  return [...cluster.rows].sort((a, b) => value(b) - value(a));
}

export function failures(model: Model): HTMLElement {
  const box = h('div', { class: 'atlas' });
  const note = h('p', { class: 'note' });
  let open = false;
  const fill = (): void => {
    const all = clusters(model);
    const p = palette();
    const few = innerWidth < 640 ? 5 : 12;
    const shown = open ? all : all.slice(0, few);
    const failed = all.reduce((sum, c) => sum + c.rows.length, 0);
    const met = view().series.reduce((sum, s) => sum + s.rows.length, 0);
    replace(box, ...shown.map((c) => {
      const ranked = worst(model, c);
      const playable = ranked.find((row) => model.playable(model.trials.text('trial', row)));
      const row = playable ?? ranked[0] ?? 0;
      const trial = model.trials.text('trial', row);
      const of = metric(c.outcome === 'collision' ? 'collision_depth_m' : 'position_error_m');
      const value = model.trials.number(of.key, row);
      const of_ = view().series.find((s) => s.controller === c.controller && s.point === c.point)?.rows.length ?? 0;
      return h('article', { style: `--c:${p.outcomes[c.outcome]}` },
        h('h4', null, h('span', { class: 'chip' }, kOutcomeNames[c.outcome]), h('span', { class: 'who' }, c.point ? `${c.controller} \u00b7 ${c.point}` : c.controller)),
        h('p', { class: 'what' }, c.what || (c.outcome === 'timeout' ? 'the time ran out' : 'no reason given')),
        h('p', { class: 'count' }, h('b', null, integer(c.rows.length)), ` of ${plural(of_, 'trial')}, ${percent(c.rows.length / of_)}`),
        h('p', { class: 'worst' }, `${playable === undefined ? 'Worst' : 'Worst to play'}: world ${integer(model.trials.number('world', row))}`, Number.isFinite(value) ? `, ${of.name} ${withUnit(of, value)}` : ''),
        h('div', { class: 'actions' },
          h('button', { type: 'button', class: playable === undefined ? 'quiet' : 'play', click: () => select(trial, true) }, playable === undefined ? 'Command' : 'Play'),
          h('button', { type: 'button', class: 'quiet', click: () => {
            state.set({ outcome: c.outcome, q: c.outcome === 'collision' ? model.trials.text('link', row) : '', who: c.controller });
            document.getElementById('trials')?.scrollIntoView();
          } }, 'List')));
    }));
    if (all.length === 0) replace(box, h('p', { class: 'empty' }, met === 0 ? 'No trials here yet.' : 'No trial failed.'));
    replace(note, all.length === 0 ? '' : `${integer(failed)} of n = ${integer(met)} trials failed, in ${plural(all.length, 'kind')} (outcome, controller, and what touched what or the reason given). `,
      all.length > few ? h('button', { type: 'button', class: 'quiet', click: () => { open = !open; fill(); } }, open ? 'Show fewer' : `Show all ${integer(all.length)}`) : null);
  };
  fill();
  onView(fill);
  onTheme(fill);
  return h('div', null, box, h('footer', null, note));
}
