"""Expressions for a page in a browser, each of which gives what readers could not read or reach."""

ASIDE = """
[...document.querySelectorAll('.scroll')].filter(e => e.scrollWidth > e.clientWidth)
  .map(e => e.getAttribute('aria-label') || e.getAttribute('aria-labelledby'))
"""
"""Tables that have columns beside the screen."""

CUT = """
[...document.querySelectorAll('svg')].flatMap(drawing => {
  const of = drawing.getBoundingClientRect();
  return [...drawing.querySelectorAll('g[id*=text]')].filter(text => {
    const at = text.getBoundingClientRect();
    return at.left < of.left - 1 || at.right > of.right + 1
      || at.top < of.top - 1 || at.bottom > of.bottom + 1;
  }).map(text => text.id);
})
"""
"""Texts of drawings that reach over the edge."""

CONTRAST = """
(() => {
  const light = c => {
    const [r, g, b] = c.match(/[\\d.]+/g).slice(0, 3).map(v => v / 255)
      .map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = e => {
    for (; e; e = e.parentElement) {
      const c = getComputedStyle(e).backgroundColor;
      if (c !== 'rgba(0, 0, 0, 0)') return c;
    }
  };
  const of = e => {
    const a = light(getComputedStyle(e).color), b = light(ground(e));
    return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  };
  const texts = [...document.querySelectorAll('body *')].filter(
    e => [...e.childNodes].some(n => n.nodeType === 3 && n.data.trim()));
  return Math.min(...texts.map(of));
})()
"""
"""The least contrast of any text with its ground."""

LEAST_CONTRAST = 4.5
"""Of text, by WCAG 2.2, level AA."""

SCALE = """
Math.min(...[...document.querySelectorAll('svg')].map(
  drawing => drawing.getBoundingClientRect().width / drawing.viewBox.baseVal.width))
"""
"""The size of the smallest drawing in pixels for each of its points; its texts have 8 points."""

LEAST_SCALE = 1.0
