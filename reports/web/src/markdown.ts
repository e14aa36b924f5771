// A person's notes in Markdown as elements. Nothing becomes markup by itself: of HTML the text is shown, links lead to
// web pages only, pictures are named and not fetched.

import { lexer, type MarkedToken, type Token } from 'marked';

import { h } from './dom';

function text(raw: string): string {
  return raw.replace(/&(amp|lt|gt|quot|#39);/g, (_, name: string) => ({ amp: '&', lt: '<', gt: '>', quot: '"', '#39': "'" })[name] ?? '');
}

function inline(tokens: readonly Token[] | undefined): Node[] {
  return ((tokens ?? []) as MarkedToken[]).map((token): Node => {
    switch (token.type) {
      case 'strong': return h('strong', null, ...inline(token.tokens));
      case 'em': return h('em', null, ...inline(token.tokens));
      case 'del': return h('s', null, ...inline(token.tokens));
      case 'codespan': return h('code', null, text(token.text));
      case 'br': return h('br');
      case 'link': return /^https?:\/\//i.test(token.href) ? h('a', { href: token.href, rel: 'noopener noreferrer', target: '_blank' }, ...inline(token.tokens)) : h('span', null, ...inline(token.tokens));
      case 'image': return document.createTextNode(token.text);
      case 'text': case 'escape': return 'tokens' in token && token.tokens !== undefined ? h('span', null, ...inline(token.tokens)) : document.createTextNode(text(token.text));
      default: return document.createTextNode(token.raw);
    }
  });
}

function blocks(tokens: readonly Token[]): Node[] {
  return (tokens as MarkedToken[]).flatMap((token): Node[] => {
    switch (token.type) {
      case 'space': case 'def': return [];
      case 'heading': return [h('h4', null, ...inline(token.tokens))];
      case 'paragraph': return [h('p', null, ...inline(token.tokens))];
      case 'text': return inline([token]);
      case 'code': return [h('pre', null, h('code', null, token.text))];
      case 'blockquote': return [h('blockquote', null, ...blocks(token.tokens))];
      case 'hr': return [h('hr')];
      case 'list': return [h(token.ordered ? 'ol' : 'ul', { start: token.ordered && (token.start === '' ? 1 : token.start) }, ...token.items.map((item) => h('li', null, ...blocks(item.tokens))))];
      case 'table': return [h('table', { class: 'plain' }, h('thead', null, h('tr', null, ...token.header.map((cell) => h('th', { scope: 'col' }, ...inline(cell.tokens))))),
        h('tbody', null, ...token.rows.map((row) => h('tr', null, ...row.map((cell) => h('td', null, ...inline(cell.tokens)))))))];
      default: return [h('p', null, token.raw)];
    }
  });
}

export function markdown(source: string): HTMLElement {
  return h('div', { class: 'notes' }, ...blocks(lexer(source)));
}
