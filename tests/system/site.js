// looks at a page of the site: what is wrong with it
({
  // beyond the column (a table may up to its edge), and not scrolled within it
  hangingOver: () => [...document.querySelectorAll('article *:not(math *, svg *)')].filter(box => {
    const article = box.closest('article');
    let outer = box.parentElement;
    while (outer !== article && getComputedStyle(outer).overflowX !== 'auto') outer = outer.parentElement;
    return outer === article && box.getBoundingClientRect().right > article.getBoundingClientRect().right + 17;
  }).map(box => `${box.tagName}: ${box.textContent.slice(0, 80)}`),
  // tables that scroll
  scrolling: () => [...document.querySelectorAll('.md-typeset__scrollwrap')].filter(
    box => box.scrollWidth > box.clientWidth + 1
  ).map(box => box.innerText.slice(0, 80)),
  // words and names in tables that go on in the next line
  broken: () => [...document.querySelectorAll('article :is(td, th)')].flatMap(cell => {
    const texts = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT), broken = [];
    while (texts.nextNode()) {
      const text = texts.currentNode;
      if (text.parentElement.closest('math')) continue;
      for (const { 0: word, index } of text.data.matchAll(/[\p{L}\p{N}_]+/gu)) {
        const range = document.createRange();
        range.setStart(text, index);
        range.setEnd(text, index + word.length);
        if (new Set([...range.getClientRects()].map(box => Math.round(box.top))).size > 1) broken.push(word);
      }
    }
    return broken;
  }),
  // formulas that were not typeset
  rawFormulas: () => {
    const text = document.querySelector('article').cloneNode(true);
    text.querySelectorAll('pre, code, math').forEach(part => part.remove());
    return text.textContent.match(/\$|\\\(|\\\[|\\frac/g) ?? [];
  },
  // or are not seen
  unseenFormulas: () => [...document.querySelectorAll('math')].filter(
    formula => formula.querySelector('merror') || formula.getBoundingClientRect().height < 2
  ).map(formula => formula.textContent),
  // pictures that are not there
  unloaded: () => [...document.images].filter(image => !image.naturalWidth).map(image => image.src),
})
