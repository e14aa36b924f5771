// A person's notes in Markdown as elements. Nothing becomes markup by itself: of HTML the text is shown, links lead to
// web pages only, pictures are named and not fetched.

import { lexer, type Token, type Tokens } from 'marked';

import { h } from './dom';

function text(raw: string): string {
  return raw.replace(/&(amp|lt|gt|quot|#39);/g, (_, name: string) => ({ amp: '&', lt: '<', gt: '>', quot: '"', '#39': "'" })[name] ?? '');
}

function inline(tokens: readonly Token[] | undefined): Node[] {
  return (tokens ?? []).map((token): Node => {
    switch (token.type) {
      case 'strong': return h('strong', null, ...inline((token as Tokens.Strong).tokens));
      case 'em': return h('em', null, ...inline((token as Tokens.Em).tokens));
      case 'del': return h('s', null, ...inline((token as Tokens.Del).tokens));
      case 'codespan': return h('code', null, text((token as Tokens.Codespan).text));
      case 'br': return h('br');
      case 'link': {
        const { href, tokens: inner } = token as Tokens.Link;
        return /^https?:\/\//i.test(href) ? h('a', { href, rel: 'noopener noreferrer', target: '_blank' }, ...inline(inner)) : h('span', null, ...inline(inner));
      }
      case 'image': return document.createTextNode((token as Tokens.Image).text);
      case 'text': case 'escape': return 'tokens' in token && token.tokens !== undefined ? h('span', null, ...inline(token.tokens)) : document.createTextNode(text((token as Tokens.Text).text));
      default: return document.createTextNode(token.raw);
    }
  });
}

function list(token: Tokens.List): HTMLElement {
  const items = token.items.map((item) => h('li', null, ...blocks(item.tokens)));
  return token.ordered ? h('ol', { start: token.start === '' ? 1 : token.start }, ...items) : h('ul', null, ...items);
}

function blocks(tokens: readonly Token[]): Node[] {
  return tokens.flatMap((token): Node[] => {
    switch (token.type) {
      case 'space': case 'def': return [];
      case 'heading': return [h('h4', null, ...inline((token as Tokens.Heading).tokens))];
      case 'paragraph': return [h('p', null, ...inline((token as Tokens.Paragraph).tokens))];
      case 'text': return inline([token]);
      case 'code': return [h('pre', null, h('code', null, (token as Tokens.Code).text))];
      case 'blockquote': return [h('blockquote', null, ...blocks((token as Tokens.Blockquote).tokens))];
      case 'hr': return [h('hr')];
      case 'list': return [list(token as Tokens.List)];
      case 'table': {
        const { header, rows } = token as Tokens.Table;
        return [h('table', { class: 'plain' }, h('thead', null, h('tr', null, ...header.map((cell) => h('th', { scope: 'col' }, ...inline(cell.tokens))))),
          h('tbody', null, ...rows.map((row) => h('tr', null, ...row.map((cell) => h('td', null, ...inline(cell.tokens)))))))];
      }
      default: return [h('p', null, token.raw)];
    }
  });
}

export function markdown(source: string): HTMLElement {
  return h('div', { class: 'notes' }, ...blocks(lexer(source)));
}
