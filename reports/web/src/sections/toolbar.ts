// The bar that stays on top: sections, what is shown, light or dark.

import { choose, chosen, conditions, shortValue, type Condition } from '../conditions';
import type { Model } from '../data';
import { button, choice, h, replace, roving } from '../dom';
import { goToSection } from '../go_to';
import { keepFilled } from '../panel';
import * as state from '../state';
import { isDark, palette, seriesColour, toggleTheme } from '../theme';
import { toggleSeries, view } from '../view';

/** Few values side by side, many in a list. */
function under(of: Condition, place: number): HTMLElement {
  const now = chosen().get(place);
  if (of.values.length > 5) {
    return choice(of.key, [['', 'all'], ...of.values.map((v, i) => [String(i), shortValue(v)] as const)], now === undefined ? '' : String(now),
      (value) => choose(place, value === '' ? undefined : Number(value)));
  }
  return h('div', { class: 'choice' }, h('span', null, of.key), h('div', { class: 'segments', role: 'group', 'aria-label': of.key },
    ...[undefined, ...of.values.keys()].map((value) => h('button', { type: 'button', 'aria-pressed': value === now ? 'true' : 'false', click: () => choose(place, value) },
      value === undefined ? 'all' : shortValue(of.values[value] ?? '')))));
}

/** `watch` is to be called once the sections are in the page. */
export function toolbar(model: Model, sections: readonly (readonly [id: string, name: string])[]): { element: HTMLElement; watch: () => void } {
  const links = new Map(sections.map(([id, name]) => [id, h('a', { href: `#${id}`, click: (event) => {
    event.preventDefault();
    state.set({ in: id }, true);   // the hash belongs to the view
    goToSection(id);
  } }, name)]));
  const nav = roving(h('nav', { 'aria-label': 'Sections' }, ...links.values()), 'a');
  const what = h('div', { class: 'what-shown' });
  const theme = button('', toggleTheme);
  const fill = (): void => {
    const { slice, family, families, all, series } = view();
    const p = palette();
    theme.textContent = isDark() ? 'Light' : 'Dark';
    theme.setAttribute('aria-label', isDark() ? 'Use light colours' : 'Use dark colours');
    replace(what,
      model.slices.length > 1 ? choice('Shown', model.slices.map((s) => [s.id, s.id] as const), slice.id, (id) => state.set({ slice: id, family: '', show: '', at: '' })) : null,
      families.length > 1 ? h('div', { class: 'segments', role: 'group', 'aria-label': 'Family of worlds' }, ...['', ...families].map((name) =>
        h('button', { type: 'button', 'aria-pressed': name === family ? 'true' : 'false', click: () => state.set({ family: name }) }, name === '' ? 'all worlds' : name))) : null,
      ...conditions(model, slice).slice(0, 3).map(under),
      all.length > 1 ? h('div', { class: 'who-shown', role: 'group', 'aria-label': 'Controllers' }, ...(all.length > 8
        ? [choice(`Points (${series.length} of ${all.length})`, [['', series.length === all.length ? 'all' : 'best few'], ...all.map((s) => [String(s.index), s.name] as const)], '', (value) => (value === '' ? state.set({ show: '' }) : toggleSeries(Number(value))))]
        : all.map((s) => h('button', { type: 'button', class: 'toggle', style: `--c:${seriesColour(p, s.mark)}`, 'aria-pressed': series.includes(s) ? 'true' : 'false', click: () => toggleSeries(s.index) }, s.name)))) : null);
  };
  keepFilled(fill);
  // Marks the section that is being read.
  const spy = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      for (const [id, link] of links) {
        if (id === entry.target.id) link.setAttribute('aria-current', 'true');
        else link.removeAttribute('aria-current');
      }
    }
  }, { rootMargin: '-20% 0px -70% 0px' });
  const watch = (): void => {
    for (const id of ['top', ...links.keys()]) {   // at the top no section is current
      const target = document.getElementById(id);
      if (target !== null) spy.observe(target);
    }
  };
  const element = h('div', { class: 'toolbar' }, h('div', { class: 'inner' }, nav, what, theme));
  // The bar has as many lines as its contents need: what is scrolled to stands below all of them.
  new ResizeObserver(() => { document.documentElement.style.scrollPaddingTop = `${element.offsetHeight}px`; }).observe(element);
  return { element, watch };
}
