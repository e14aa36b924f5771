// The table of trials: filtered, sorted, drawn only where it is seen.

import { disturbed } from '../conditions';
import { outcomeName, kOutcomes, type Model } from '../data';
import { button, choice, copyButton, h, replace, roving, terms } from '../dom';
import { contact, filtered, isText } from '../filter';
import { integer, plural } from '../format';
import { kMetrics, metric, withUnit } from '../metrics';
import { saveCsv } from '../panel';
import { onSelect, select } from '../select';
import * as state from '../state';
import { outcomeColour, palette } from '../theme';
import { kView, view } from '../view';

const kRowHeight = 34;
const kBeyond = 6;   // rows drawn above and below those in sight
/** Columns other than metrics; their least width [px]. */
const kColumns: Record<string, { head: string; width: number }> = {
  trial: { head: 'Trial', width: 158 }, controller: { head: 'Controller', width: 118 }, point: { head: 'Point', width: 190 }, family: { head: 'Family', width: 88 },
  world: { head: 'World', width: 68 }, outcome: { head: 'Outcome', width: 112 }, contact: { head: 'Contact or reason', width: 230 },
};

function columnOf(key: string): { head: string; width: number } {
  const { head = '', unit } = metric(key);
  return kColumns[key] ?? { head: unit === '' ? head : `${head} [${unit}]`, width: 96 };
}

export function command(model: Model, trial: string): string {
  const file = model.file(model.row(trial) ?? -1);
  return `moma replay ${/^[\w./-]+$/.test(file) ? file : `'${file.replaceAll("'", `'\\''`)}'`} ${trial}`;
}

function columns(model: Model): string[] {
  const { series } = view();
  return ['trial', 'controller', ...(series.some((s) => s.point !== '') ? ['point'] : []), 'family', 'world', 'outcome',
    ...kMetrics.filter((m) => m.head !== undefined && series.some((s) => model.trials.any(m.key, s.rows))).map((m) => m.key), 'contact'];
}

export function trials(model: Model): HTMLElement {
  state.setDefault('sort', 'world:up');
  const t = model.trials;
  const count = h('p', { class: 'note', 'aria-live': 'polite' });
  const head = roving(h('div', { class: 'row head', role: 'row' }), 'button');
  const rowsBox = h('div', { class: 'rows' });
  const scroller = h('div', { class: 'grid-scroll', tabindex: 0, role: 'table', 'aria-label': 'Trials' }, head, rowsBox);
  const detail = h('div', { class: 'detail', hidden: true });
  const controls = h('div', { class: 'controls wide' });
  let rows: number[] = [];
  let shownColumns: string[] = [];
  let all = 0;
  /** Rows that are drawn: those that stay in sight from one key stroke to the next stay as they are. */
  const drawn = new Map<number, HTMLElement>();

  const cell = (key: string, row: number): HTMLElement => {
    if (key === 'outcome') {
      const outcome = t.outcome(row);
      return h('span', { role: 'cell', class: 'dotted', style: `--c:${outcomeColour(palette(), outcome)}` }, outcomeName(outcome));
    }
    if (key === 'contact') return h('span', { role: 'cell', class: 'faint', title: contact(model, row) }, contact(model, row));
    if (key === 'trial') {
      const name = t.text('trial', row);
      return h('span', { role: 'cell', class: 'mono' }, name, !model.playable(name) || model.page.live !== undefined ? null : h('i', { title: 'Can be played in this page' }, ' \u25b8'));
    }
    if (isText(key)) return h('span', { role: 'cell' }, t.text(key, row));
    const value = t.number(key, row);
    return h('span', { role: 'cell', class: 'num' }, Number.isNaN(value) ? '\u2013' : key === 'world' ? integer(value) : metric(key).write(value));
  };

  const newLine = (row: number): HTMLElement => {
    const name = t.text('trial', row);
    return h('div', { class: 'row', role: 'row', 'data-trial': name, click: () => select(name, false), dblclick: () => select(name, true) }, ...shownColumns.map((key) => cell(key, row)));
  };

  const draw = (): void => {
    const top = Math.floor(scroller.scrollTop / kRowHeight);
    const first = Math.max(0, top - kBeyond);
    const seen = rows.slice(first, top + Math.ceil(scroller.clientHeight / kRowHeight) + kBeyond);
    const chosen = state.get('trial');
    const keep = new Set(seen);
    for (const [row, line] of drawn) {
      if (keep.has(row)) continue;
      line.remove();
      drawn.delete(row);
    }
    let next = rowsBox.firstChild;
    seen.forEach((row, i) => {
      let line = drawn.get(row);
      if (line === undefined) drawn.set(row, line = newLine(row));
      line.style.top = `${(first + i) * kRowHeight}px`;
      line.classList.toggle('chosen', line.dataset['trial'] === chosen);
      if (line === next) next = next.nextSibling;
      else rowsBox.insertBefore(line, next);
    });
  };
  /** Words or colours of rows have changed. */
  const forget = (): void => {
    drawn.clear();
    replace(rowsBox);
  };

  const drawHead = (): void => {
    const [sorted, direction] = state.get('sort').split(':');
    replace(head, ...shownColumns.map((key) => {
      const active = key === sorted;
      return h('button', {
        type: 'button', class: isText(key) ? null : 'num', role: 'columnheader',
        'aria-sort': active ? (direction === 'down' ? 'descending' : 'ascending') : 'none',
        click: () => state.set({ sort: `${key}:${active && direction !== 'down' ? 'down' : 'up'}` }),
      }, columnOf(key).head, active ? (direction === 'down' ? ' \u2193' : ' \u2191') : '');
    }));
  };

  const refresh = (): void => {
    rows = filtered(model);
    rowsBox.style.height = `${rows.length * kRowHeight}px`;
    draw();
    count.textContent = rows.length === all ? `${plural(all, 'trial')}.` : `${integer(rows.length)} of ${plural(all, 'trial')}.`;
  };

  /** Rows that follow from the shown trials, independent of the filter. */
  const settle = (): void => {
    shownColumns = columns(model);
    all = view().series.reduce((sum, s) => sum + s.rows.length, 0);
    scroller.style.setProperty('--columns', shownColumns.map((key) => `minmax(${columnOf(key).width}px, ${key === 'contact' ? '2fr' : '1fr'})`).join(' '));
    scroller.style.setProperty('--total', `${shownColumns.reduce((sum, key) => sum + columnOf(key).width + 14, 16)}px`);
    drawHead();
    forget();
    refresh();
  };

  const fillControls = (): void => {
    const { series } = view();
    const present = new Set(series.flatMap((s) => s.rows.map((row) => t.outcome(row))));
    const names = [...new Set(series.map((s) => s.controller))];
    const texts = [...(model.page.stores === undefined ? [] : ['store']), 'trial', 'suite', 'robot', 'controller', 'point', 'family', 'mode', 'outcome', 'reason', 'link', 'object'];
    const numbers = ['world', ...kMetrics.map((m) => m.key).filter((key) => t.has(key))];
    const search = h('input', {
      type: 'search', placeholder: 'Filter: trial, link, object, reason, world:12', value: state.get('q'), 'aria-label': 'Filter trials',
      input: (event) => state.set({ q: (event.target as HTMLInputElement).value }),
    });
    replace(controls, search,
      choice('Outcome', [['', 'all'], ['failure', 'any failure'], ...kOutcomes.filter((o) => present.has(o)).map((o) => [o, outcomeName(o)] as const)], state.get('outcome'), (value) => state.set({ outcome: value })),
      names.length > 1 ? choice('Controller', [['', 'all'], ...names.map((n) => [n, n] as const)], state.get('who'), (value) => state.set({ who: value })) : null,
      button('Clear', () => { state.set({ q: '', outcome: '', who: '', sort: 'world:up' }); fillControls(); }),
      saveCsv('trials', () => ({ columns: [...texts, ...numbers], rows: rows.map((row) => [...texts.map((key) => t.text(key, row) || null), ...numbers.map((key) => t.number(key, row))]) })));
  };

  const showDetail = (trial: string): void => {
    const row = model.row(trial);
    detail.hidden = row === undefined;
    if (row === undefined) return;
    const line = command(model, trial);
    const outcome = t.outcome(row);
    replace(detail,
      h('div', { class: 'detail-head' },
        h('h3', null, h('span', { class: 'mono' }, trial), ' ', h('span', { class: 'chip', style: `--c:${outcomeColour(palette(), outcome)}` }, outcomeName(outcome))),
        h('div', { class: 'actions' },
          !model.playable(trial) ? null : button('Play', () => select(trial, true), 'play'),
          button('Close', () => state.set({ trial: '' })))),
      h('p', null, [t.text('controller', row), t.text('point', row), `${t.text('family', row)} world ${integer(t.number('world', row))}`, disturbed(model.point(row)) && `disturbed: ${disturbed(model.point(row))}`, contact(model, row)].filter((text) => text !== '').join(' \u00b7 ')),
      h('p', { class: 'command' }, h('code', null, line), copyButton(line)),
      h('dl', { class: 'metrics' }, ...terms(kMetrics.filter((m) => Number.isFinite(t.number(m.key, row))).map((m) => [m.name, withUnit(m, t.number(m.key, row))]))));
  };

  let pending = 0;
  scroller.addEventListener('scroll', () => {
    if (pending === 0) pending = requestAnimationFrame(() => { pending = 0; draw(); });
  });
  scroller.addEventListener('keydown', (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 12, PageUp: -12 }[event.key];
    const place = rows.findIndex((row) => t.text('trial', row) === state.get('trial'));
    if (event.key === 'Enter' && place >= 0) select(state.get('trial'), true);
    if (step === undefined) return;
    event.preventDefault();
    const row = rows[Math.max(0, Math.min(rows.length - 1, place + step))];
    if (row !== undefined) select(t.text('trial', row), false);
  });
  const reveal = (): void => {
    const place = rows.findIndex((row) => t.text('trial', row) === state.get('trial'));
    if (place < 0) return;
    const top = place * kRowHeight;
    if (top < scroller.scrollTop) scroller.scrollTop = top;
    else if (top + 2 * kRowHeight > scroller.scrollTop + scroller.clientHeight) scroller.scrollTop = top + 2 * kRowHeight - scroller.clientHeight;
  };
  fillControls();
  requestAnimationFrame(settle);
  state.listen(kView, () => { fillControls(); settle(); });
  state.listen(['theme'], () => { forget(); draw(); showDetail(state.get('trial')); });
  state.listen(['outcome', 'who', 'q', 'sort'], (changed) => {
    if (changed.has('outcome') || changed.has('who')) fillControls();
    if (changed.has('sort')) drawHead();
    scroller.scrollTop = 0;
    refresh();
  });
  state.listen(['trial'], () => { showDetail(state.get('trial')); reveal(); draw(); });
  onSelect((trial, play) => {
    // A trial without a stored motion shows the command that plays it.
    if (play && !model.playable(trial)) detail.scrollIntoView({ block: 'center' });
  });
  showDetail(state.get('trial'));
  return h('div', { class: 'panel' }, controls, scroller, h('footer', null, count), detail);
}
