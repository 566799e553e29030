// The site's search (scripts/site): all words of the query in a title, heading or text; index.js is a script, since a browser
// loads no other file of a page that was opened from the disk.
'use strict';
const box = document.getElementById('search'), found = document.getElementById('found');
const root = document.documentElement.dataset.root;
let at = -1;

function find(query) {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  if (!words.length || !window.siteIndex) return [];
  const hits = [];
  for (const [url, page, title, text] of window.siteIndex) {
    const t = title.toLowerCase(), all = t + ' ' + page.toLowerCase() + ' ' + text.toLowerCase();
    if (!words.every(w => all.includes(w))) continue;
    let score = 0;
    for (const w of words) score += t === w ? 12 : t.startsWith(w) ? 6 : t.includes(w) ? 4 : page.toLowerCase().includes(w) ? 2 : 1;
    hits.push([score, url, page, title, text]);
  }
  return hits.sort((a, b) => b[0] - a[0]).slice(0, 20);
}

function excerpt(text, word) {
  const i = Math.max(0, text.toLowerCase().indexOf(word) - 40);
  return (i ? '… ' : '') + text.slice(i, i + 130);
}

function show() {
  at = -1;
  const word = box.value.toLowerCase().trim().split(/\s+/)[0];
  found.replaceChildren(...find(box.value).map(([, url, page, title, text]) => {
    const item = document.createElement('li'), link = document.createElement('a'), small = document.createElement('small');
    link.href = root + url;
    link.textContent = title === page ? title : title + ' · ' + page;
    small.textContent = excerpt(text, word);
    link.append(small);
    item.append(link);
    return item;
  }));
}

box.addEventListener('input', show);
box.form.addEventListener('submit', event => {
  event.preventDefault();
  const link = found.querySelectorAll('a')[Math.max(at, 0)];
  if (link) location.href = link.href;
});
box.addEventListener('keydown', event => {
  const links = found.querySelectorAll('a');
  if (event.key === 'Escape') box.value = '', show();
  if (event.key !== 'ArrowDown' && event.key !== 'ArrowUp' || !links.length) return;
  event.preventDefault();
  at = (at + (event.key === 'ArrowDown' ? 1 : links.length - 1)) % links.length;
  links.forEach((link, i) => link.classList.toggle('at', i === at));
  links[at].scrollIntoView({block: 'nearest'});
});
document.addEventListener('keydown', event => {
  if (event.key === '/' && !/^(INPUT|TEXTAREA)$/.test(document.activeElement.tagName)) event.preventDefault(), box.focus();
});
