// Two controllers on the same worlds: one dot per world, A along x, B along y.

import { axis, kFont, kNarrow, legend, legendHeight, nice, plain, ruler, tip, tipOf, type FigureSpec } from '../chart';
import { pairs, pairsText, rates, type PairedWorld } from '../compare';
import { outcomeName, type Series } from '../data';
import { integer, upper } from '../format';
import { axisName, kMetrics, withUnit } from '../metrics';
import { chosenRow, select } from '../select';
import * as state from '../state';
import { extent } from '../stats';
import { outcomeColour, seriesColour } from '../theme';
import { baseline, bestRival, view } from '../view';
import { metricChoice } from './distribution';

/** The two series that are compared: as chosen, else the baseline with the best of the others that are shown. */
function chosen(): [Series | undefined, Series | undefined] {
  const { all } = view();
  const asked = (key: string): Series | undefined => all.find((s) => String(s.index) === state.get(key));
  const a = asked('f.a') ?? baseline();
  return [a, asked('f.b') ?? bestRival(a)];
}

/** The shown series, where there are more than the two that are compared. */
function series(): [string, string][] {
  const { all } = view();
  return all.length > 2 ? all.map((s) => [String(s.index), s.short]) : [];
}

export function paired(): FigureSpec {
  const chosenMetric = metricChoice('f.paired', 'Metric', 'time_to_goal_s', () => kMetrics.filter((m) => m.of !== 'world'));
  return {
    id: 'paired',
    title: () => `${upper(chosenMetric.of().name)} on the same worlds`,
    caption: () => `Each dot is one world that both controllers met. Where only one has a value, its dot lies in the strip named none. ${view().model.clickPlays()}`,
    empty: 'Two controllers that met the same worlds are needed.',
    linked: true,
    choices: [
      chosenMetric.choice,
      { key: 'f.a', label: 'Along x', options: series, value: () => String(chosen()[0]?.index) },
      { key: 'f.b', label: 'Along y', options: series, value: () => String(chosen()[1]?.index) },
    ],
    draw: (p, width) => {
      const { model } = view();
      const [a, b] = chosen();
      if (a === undefined || b === undefined || a === b) return null;
      const of = chosenMetric.of();
      const result = pairs(model, a, b, of.key);
      const ends = extent(result.worlds.flatMap((w) => [w.x, w.y]));
      if (ends === null) return null;
      const t = model.trials;
      const row = chosenRow(model);
      const marked = (w: PairedWorld): object => (row === w.a || row === w.b ? { symbolSize: 14, itemStyle: { borderColor: p.ink, borderWidth: 2.5, opacity: 1 } } : {});
      const range = nice(...ends, width < kNarrow ? 4 : 6);   // a strip is as wide as its name
      // Strips beside the axes, outside their numbers, are for worlds in which one has no value; dots are spread in them.
      const least = range.min - range.interval;
      const place = (value: number, world: number): number => (Number.isFinite(value) ? value : least + range.interval * (0.2 + 0.6 * ((world * 0.618033988749895) % 1)));
      const limits = { min: least, max: range.max, interval: range.interval, nameGap: 30 };
      const write = (v: number): string => (v < range.min - 1e-6 * range.interval ? '' : plain(v));
      const dots = result.worlds.filter((w) => Number.isFinite(w.x) || Number.isFinite(w.y));
      const groups = ([
        ['both succeed', true, true, 'circle', outcomeColour(p, 'success')], [`only ${a.short}`, true, false, 'triangle', seriesColour(p, a.mark)],
        [`only ${b.short}`, false, true, 'diamond', seriesColour(p, b.mark)], ['neither', false, false, 'rect', p.faint],
      ] as const).map(([name, ofA, ofB, symbol, colour]) => ({ name, symbol, colour, worlds: dots.filter((w) => t.success(w.a) === ofA && t.success(w.b) === ofB) })).filter((g) => g.worlds.length > 0);
      const names = groups.map((g) => g.name);
      const top = legendHeight(names, width);
      const left = 74;
      const side = Math.max(180, Math.min(width - left - 24, 460));
      const text = (x: number, y: number, rotation: number) => ({ type: 'text', x, y, rotation, style: { text: 'none', fill: p.muted, font: `11px ${kFont}`, align: 'center', verticalAlign: 'middle' } });
      const strip = (x: number, y: number, wide: number, high: number) => ({ type: 'rect', shape: { x, y, width: wide, height: high }, style: { fill: p.rule, opacity: 0.35 } });
      return {
        height: top + side + 62,
        note: pairsText(result, rates(model, result.worlds), a.short, b.short, of),
        columns: ['family', 'world', `${of.key}_a`, `${of.key}_b`, 'outcome_a', 'outcome_b', 'trial_a', 'trial_b'],
        rows: result.worlds.map((w) => [t.text('family', w.a), w.world, w.x, w.y, t.outcome(w.a), t.outcome(w.b), t.text('trial', w.a), t.text('trial', w.b)]),
        option: {
          legend: { ...legend(p, names), icon: undefined, itemWidth: 10, itemHeight: 10 },
          grid: { left, top, width: side, height: side, outerBoundsMode: 'none' },
          xAxis: axis(p, `${a.short}: ${axisName(of)}`, limits, write), yAxis: axis(p, `${b.short}: ${axisName(of)}`, { ...limits, nameGap: 50 }, write),
          tooltip: tipOf((w: PairedWorld) => tip(`${t.text('family', w.a)} world ${integer(w.world)}`, [
            [a.short, `${outcomeName(t.outcome(w.a))}, ${withUnit(of, w.x)}`], [b.short, `${outcomeName(t.outcome(w.b))}, ${withUnit(of, w.y)}`],
          ])),
          series: [
            {
              type: 'custom', silent: true, z: 0, tooltip: { show: false }, data: [[least, least]],
              renderItem: (_: unknown, api: { coord: (at: number[]) => number[] }) => {
                const [[x0 = 0, y0 = 0], [x1 = 0, y1 = 0], [x2 = 0, y2 = 0]] = [api.coord([least, least]), api.coord([range.min, range.min]), api.coord([range.max, range.max])];
                return { type: 'group', children: [strip(x0, y2, x1 - x0, y0 - y2), strip(x0, y1, x2 - x0, y0 - y1), text((x0 + x1) / 2, y0 + 11, 0), text(x0 - 10, (y0 + y1) / 2, Math.PI / 2)] };
              },
            },
            ruler(p, [range.min, range.min], [range.max, range.max]),
            ...groups.map((g) => ({
              name: g.name, type: 'scatter', symbol: g.symbol, symbolSize: g.symbol === 'circle' ? 7 : 8.5, cursor: 'pointer', data: g.worlds.map((w) => ({ value: [place(w.x, w.world), place(w.y, w.world)], of: w, ...marked(w) })),
              itemStyle: { color: g.colour, opacity: 0.72, borderColor: p.surface, borderWidth: 0.5 },
            })),
          ],
        },
      };
    },
    click: (w: PairedWorld) => {
      const t = view().model.trials;
      // The failed one of the two is the one to look at.
      const row = t.success(w.a) && !t.success(w.b) ? w.b : w.a;
      state.set({ beside: t.text('trial', row === w.a ? w.b : w.a) });
      select(t.text('trial', row), true);
    },
  };
}
