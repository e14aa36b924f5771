// Two controllers on the same worlds: one dot per world, A along x, B along y.

import { axis, legendHeight, nice, plain, tip, type FigureSpec } from '../chart';
import { pairs, pairsText } from '../compare';
import { kOutcomeNames } from '../data';
import { choice } from '../dom';
import { integer } from '../format';
import { axisName, kMetrics, metric, withUnit } from '../metrics';
import { select } from '../select';
import * as state from '../state';
import { extent } from '../stats';
import type { Palette } from '../theme';
import { view } from '../view';

/** The two series that are compared: as chosen, else the first two shown. */
function chosen(): [number, number] {
  const { all, series } = view();
  const valid = (text: string): number | undefined => all.find((s) => text !== '' && s.index === Number(text))?.index;
  const a = valid(state.get('f.a')) ?? series[0]?.index ?? 0;
  const b = valid(state.get('f.b')) ?? series.find((s) => s.index !== a)?.index ?? a;
  return [a, b];
}

export function paired(): FigureSpec {
  state.setDefault('f.paired', 'time_to_goal_s');
  return {
    id: 'paired',
    title: 'Two controllers on the same worlds',
    caption: 'Each dot is one world that both controllers met. Where only one has a value, its dot lies in the margin named none. A click plays the trial.',
    empty: 'Two controllers that met the same worlds are needed.',
    controls: (redraw) => {
      const { all, model, series } = view();
      const [a, b] = chosen();
      const names = all.map((s) => [String(s.index), s.name] as const);
      const metrics = kMetrics.filter((m) => series.some((s) => model.trials.any(m.key, s.rows))
        && !['goal_distance_m', 'objects', 'witness_clearance_m', 'blocked_fraction', 'narrowest_gap_m'].includes(m.key));
      const pick = (key: string) => (value: string) => { state.set({ [key]: value }); redraw(); };
      return [
        choice('Metric', metrics.map((m) => [m.key, axisName(m)] as const), state.get('f.paired'), pick('f.paired')),
        ...(all.length > 2 ? [choice('Along x', names, String(a), pick('f.a')), choice('Along y', names, String(b), pick('f.b'))] : []),
      ];
    },
    draw: (p: Palette, width: number) => {
      const { model, all } = view();
      const [ia, ib] = chosen();
      const a = all.find((s) => s.index === ia);
      const b = all.find((s) => s.index === ib);
      if (a === undefined || b === undefined || ia === ib) return null;
      const of = metric(state.get('f.paired'));
      const result = pairs(model, a, b, of.key);
      if (result.worlds.length === 0) return null;
      const t = model.trials;
      const ends = extent(result.worlds.flatMap((w) => [w.x, w.y]));
      if (ends === null) return null;
      const range = nice(...ends);
      // One step below the axis is for worlds in which a controller has no value.
      const margin = range.min - 0.55 * range.interval;
      const limits = { min: range.min - range.interval, max: range.max, interval: range.interval };
      const dots = result.worlds.filter((w) => Number.isFinite(w.x) || Number.isFinite(w.y)).map((w) => ({
        value: [Number.isFinite(w.x) ? w.x : margin, Number.isFinite(w.y) ? w.y : margin],
        w, one: !(Number.isFinite(w.x) && Number.isFinite(w.y)),
      }));
      const colour = (w: (typeof result.worlds)[number]): string => {
        const sa = t.success(w.a);
        const sb = t.success(w.b);
        return sa && sb ? p.outcomes.success : sa ? p.series[0] ?? p.ink : sb ? p.series[1] ?? p.ink : p.outcomes.collision;
      };
      const groups: [string, (w: (typeof result.worlds)[number]) => boolean, string][] = [
        ['both succeed', (w) => t.success(w.a) && t.success(w.b), 'circle'],
        [`only ${a.name}`, (w) => t.success(w.a) && !t.success(w.b), 'triangle'],
        [`only ${b.name}`, (w) => !t.success(w.a) && t.success(w.b), 'diamond'],
        ['neither', (w) => !t.success(w.a) && !t.success(w.b), 'rect'],
      ];
      const used = groups.map(([name, belongs, symbol]) => ({ name, symbol, data: dots.filter((d) => belongs(d.w)) })).filter((g) => g.data.length > 0);
      const label = { color: p.muted, fontSize: 11, formatter: (v: number) => (v < range.min - 0.5 * range.interval ? 'none' : plain(v)) };
      return {
        height: 440,
        note: pairsText(result, a.name, b.name, of),
        columns: ['family', 'world', `${of.key}_a`, `${of.key}_b`, 'outcome_a', 'outcome_b', 'trial_a', 'trial_b'],
        rows: result.worlds.map((w) => [t.text('family', w.a), w.world, w.x, w.y, t.outcome(w.a), t.outcome(w.b), t.text('trial', w.a), t.text('trial', w.b)]),
        option: {
          legend: { data: used.map((g) => g.name), top: 0, left: 0, itemWidth: 10, itemHeight: 10, itemGap: 16, selectedMode: false, textStyle: { color: p.muted, fontSize: 12 } },
          grid: { left: 24, right: 20, top: legendHeight(used.map((g) => g.name), width), bottom: 30, outerBoundsMode: 'same', outerBoundsContain: 'axisLabel' },
          xAxis: axis(p, `${a.name}: ${axisName(of)}`, { ...limits, nameGap: 30, axisLabel: label }),
          yAxis: axis(p, `${b.name}: ${axisName(of)}`, { ...limits, nameGap: 44, axisLabel: label }),
          tooltip: {
            trigger: 'item',
            formatter: ({ data }: { data: (typeof dots)[number] }) => tip(`${t.text('family', data.w.a)} world ${integer(data.w.world)}`, [
              [a.name, `${kOutcomeNames[t.outcome(data.w.a)]}, ${withUnit(of, data.w.x)}`],
              [b.name, `${kOutcomeNames[t.outcome(data.w.b)]}, ${withUnit(of, data.w.y)}`],
            ]),
          },
          series: [
            {
              type: 'line', data: [[range.min, range.min], [range.max, range.max]], showSymbol: false, silent: true, tooltip: { show: false },
              lineStyle: { color: p.faint, width: 1, type: [4, 4] }, z: 1,
            },
            ...used.map((g) => ({
              name: g.name, type: 'scatter', symbol: g.symbol, symbolSize: g.symbol === 'circle' ? 7 : 8.5, data: g.data,
              itemStyle: { color: g.data[0] === undefined ? p.ink : colour(g.data[0].w), opacity: 0.72, borderColor: p.surface, borderWidth: 0.5 },
              cursor: 'pointer',
            })),
          ],
        },
      };
    },
    click: (data) => {
      const w = (data as { w?: { a: number; b: number } } | undefined)?.w;
      if (w === undefined) return;
      const { model } = view();
      // The failed one of the two is the one to look at.
      const row = model.trials.success(w.a) && !model.trials.success(w.b) ? w.b : w.a;
      select(model.trials.text('trial', row), true);
    },
  };
}
