// Elements by function. Text goes in as text nodes only, so that no name from a store can become markup.

export type Child = Node | string | number | null | undefined | false;
type Value = string | number | boolean | null | undefined | EventListener;

export function h<K extends keyof HTMLElementTagNameMap>(tag: K, attributes?: Record<string, Value> | null, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === 'function') element.addEventListener(name, value);
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  append(element, ...children);
  return element;
}

export function append(parent: ParentNode, ...children: Child[]): void {
  parent.append(...children.filter((child) => child !== null && child !== undefined && child !== false).map((child) => (child instanceof Node ? child : String(child))));
}

export function replace(parent: ParentNode, ...children: Child[]): void {
  parent.replaceChildren();
  append(parent, ...children);
}

export function button(text: string, click: (event: Event) => void, kind: 'quiet' | 'play' = 'quiet'): HTMLButtonElement {
  return h('button', { type: 'button', class: kind, click }, text);
}

/** The entries of a <dl>. */
export function terms(pairs: readonly (readonly [name: string, value: string])[]): HTMLElement[] {
  return pairs.map(([name, value]) => h('div', null, h('dt', null, name), h('dd', null, value)));
}

/** A name behind a spot of its colour. */
export function dotted(colour: string, name: string): HTMLElement {
  return h('span', { class: 'dotted', style: `--c:${colour}` }, name);
}

export function choice(label: string, options: readonly (readonly [value: string, text: string])[], value: string, change: (value: string) => void): HTMLLabelElement {
  const select = h('select', { change: () => change(select.value) }, ...options.map(([key, text]) => h('option', { value: key, selected: key === value }, text)));
  return h('label', { class: 'choice' }, h('span', null, label), select);
}

/** A table that scrolls by itself where it is wide; a row's first cell is its head, a cell may have several parts. */
export function table(label: string, heads: readonly (Child | Child[])[], rows: readonly (readonly (Child | Child[])[])[], more = ''): HTMLElement {
  const cell = (tag: 'th' | 'td', scope: string | null, content: Child | Child[] | undefined): HTMLElement => h(tag, { scope }, ...(Array.isArray(content) ? content : [content]));
  return h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': label }, h('table', { class: `plain ${more}`.trim() },
    h('thead', null, h('tr', null, ...heads.map((head) => cell('th', 'col', head)))),
    h('tbody', null, ...rows.map(([first, ...rest]) => h('tr', null, cell('th', 'row', first), ...rest.map((content) => cell('td', null, content)))))));
}

/** One stop of the Tab key for all of `selector` in `box`: arrows, Home and End move between them. */
export function roving(box: HTMLElement, selector: string): HTMLElement {
  const items = (): HTMLElement[] => [...box.querySelectorAll<HTMLElement>(selector)];
  const settle = (on?: HTMLElement): void => {
    const all = items();
    const stop = on ?? all.find((item) => item.getAttribute('aria-selected') === 'true' || item.hasAttribute('aria-current')) ?? all[0];
    for (const item of all) item.tabIndex = item === stop ? 0 : -1;
  };
  new MutationObserver(() => settle()).observe(box, { childList: true, subtree: true });
  box.addEventListener('focusin', (event) => {
    if (event.target instanceof HTMLElement && event.target.matches(selector)) settle(event.target);
  });
  box.addEventListener('keydown', (event) => {
    const all = items();
    const place = all.indexOf(event.target as HTMLElement);
    if (place < 0) return;
    const next = { ArrowRight: place + 1, ArrowDown: place + 1, ArrowLeft: place - 1, ArrowUp: place - 1, Home: 0, End: all.length - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    all[Math.min(Math.max(0, next), all.length - 1)]?.focus();
  });
  settle();
  return box;
}

export function download(name: string, blob: Blob): void {
  const url = URL.createObjectURL(blob);
  const link = h('a', { href: url, download: name });
  document.body.appendChild(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

export function copyButton(text: string): HTMLButtonElement {
  const made = button('Copy', async () => {
    try {
      await navigator.clipboard.writeText(text);
      made.textContent = 'Copied';
    } catch {
      made.textContent = 'Select and copy';
    }
    setTimeout(() => (made.textContent = 'Copy'), 1400);
  });
  return made;
}
