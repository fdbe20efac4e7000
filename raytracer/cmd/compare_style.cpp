// Looks and moving parts of a comparison's page. No framework and nothing fetched; the page reads well without the script.
#include "raytracer/cmd/compare_sections.h"

namespace iso {

const char* const kPageStyle = R"css(
:root {
  color-scheme: light dark;
  --paper: #ffffff; --panel: #f5f6f8; --ink: #1b1f24; --soft: #59626c; --line: #d4d9df; --link: #0b5cad;
  --ours: #0068a8; --theirs: #b34700; --exact: #00704c; --fault: #a3191b; --warning: #7a5200; --good: #14683a;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #13161a; --panel: #1c2127; --ink: #e3e7eb; --soft: #9da7b2; --line: #343c45; --link: #86bbff;
    --ours: #66b8f2; --theirs: #ff9d5c; --exact: #52d3a3; --fault: #ff938a; --warning: #f0c36b; --good: #82d9a4;
  }
}
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; }
body {
  margin: 0 auto; padding: clamp(1rem, 3vw, 2.5rem); max-width: 80rem; background: var(--paper); color: var(--ink);
  font: 1rem/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Liberation Sans", sans-serif; overflow-wrap: break-word;
}
h1 { font-size: clamp(1.3rem, 1rem + 1.3vw, 1.85rem); line-height: 1.3; margin: 0 0 .6rem; max-width: 56rem; text-wrap: pretty; }
h2 { font-size: 1.3rem; margin: 2.8rem 0 .9rem; padding-top: .9rem; border-top: 1px solid var(--line); }
h3 { font-size: 1.05rem; margin: 1.6rem 0 .6rem; }
p { margin: .4rem 0; max-width: 46rem; }
a { color: var(--link); }
code { font: .9em/1.5 ui-monospace, "DejaVu Sans Mono", monospace; overflow-wrap: anywhere; }
.kicker { color: var(--soft); font-size: .9rem; margin: 0 0 .5rem; }
.soft, .unit { color: var(--soft); }
.soft { font-size: .92rem; }
.unit { font-weight: 400; font-size: .88em; white-space: nowrap; }
.advice { border-left: .25rem solid var(--link); background: var(--panel); padding: .6rem .9rem; margin: 1rem 0; }
.advice strong { margin-right: .4rem; }
nav { display: flex; flex-wrap: wrap; gap: .2rem 1.1rem; margin: 1.2rem 0 0; font-size: .95rem; }
nav a { padding: .25rem 0; }

.findings { list-style: none; margin: .5rem 0; padding: 0; }
.findings li { margin: .35rem 0; max-width: 56rem; }
.tag {
  display: inline-block; border: 1px solid currentColor; border-radius: .25rem; padding: 0 .4rem; margin-right: .3rem;
  font-size: .82rem; font-weight: 600; line-height: 1.45; color: var(--soft);
}
.tag.fault { color: var(--fault); border-width: 2px; }
.tag.warning { color: var(--warning); border-style: dashed; }
.tag.good { color: var(--good); }
.meshes { margin-bottom: 1.6rem; }
.mesh { display: grid; grid-template-columns: 12rem minmax(0, 1fr); gap: 0 1.4rem; padding: .7rem 0; border-bottom: 1px solid var(--line); }
.mesh h3 { margin: 0; overflow-wrap: anywhere; }
.mesh p:first-child { margin-top: 0; }

/* A shadow at the right while there is more to scroll to. */
.scroll {
  overflow-x: auto; max-width: 100%;
  background: linear-gradient(to left, var(--paper) 30%, transparent) right / 2.4rem 100% no-repeat local,
    linear-gradient(to left, var(--line), transparent) right / .9rem 100% no-repeat scroll;
}
.scroll:focus-visible { outline: 2px solid var(--link); outline-offset: 2px; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .95rem; }
th, td { padding: .34rem .8rem; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
thead th { vertical-align: bottom; border-bottom: 2px solid var(--line); }
thead td { border-bottom: 2px solid var(--line); }
tbody th { text-align: left; font-weight: 400; position: sticky; left: 0; background: var(--paper); padding-left: 0; }
thead td:first-child, thead th:first-child { position: sticky; left: 0; background: var(--paper); text-align: left; padding-left: 0; }
.group th { font-weight: 600; padding-top: 1.1rem; }
.group th span { position: sticky; left: 0; }
td.none { color: var(--soft); }
.faces th { max-width: 18rem; }
.faces th, .faces thead th { white-space: normal; min-width: 6.5rem; }
.faces tbody th { overflow-wrap: anywhere; }
details { margin: .6rem 0; border: 1px solid var(--line); border-radius: .4rem; padding: .2rem .9rem; }
summary { cursor: pointer; padding: .4rem 0; font-weight: 600; overflow-wrap: anywhere; }
details[open] { padding-bottom: .8rem; }

.gallery { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 24rem), 1fr)); gap: 1.4rem 1.2rem; }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 21rem), 1fr)); gap: 1.4rem; }
figure { margin: 0; min-width: 0; }
figcaption strong { color: var(--ink); font-weight: 600; }
figcaption { font-size: .9rem; color: var(--soft); margin-top: .35rem; }
.file { display: inline-block; max-width: 100%; overflow-wrap: anywhere; }
.gallery .large { grid-column: 1 / -1; max-width: 60rem; }
.enlarge { font: inherit; color: var(--link); background: none; border: 0; padding: 0; text-decoration: underline; cursor: pointer; }
.pictures { border: 0; padding: 0; }
img { display: block; width: 100%; height: auto; background: var(--panel); border-radius: .2rem; }
.pair { grid-column: 1 / -1; max-width: 60rem; }
.frame { position: relative; --at: 50%; cursor: ew-resize; touch-action: pan-y; user-select: none; -webkit-user-select: none; }
.frame .over { position: absolute; inset: 0; clip-path: inset(0 calc(100% - var(--at)) 0 0); }
.frame .cut { position: absolute; top: 0; bottom: 0; left: var(--at); width: 2px; margin-left: -1px; background: #fff; box-shadow: 0 0 0 1px #000; }
.side { position: absolute; bottom: .5rem; background: #000b; color: #fff; font-size: .82rem; padding: .05rem .45rem; border-radius: .2rem; }
.side.left { left: .5rem; }
.side.right { right: .5rem; }
.wipe { display: flex; gap: .7rem; align-items: center; max-width: none; font-size: .9rem; }
.wipe input { flex: 1; min-width: 0; height: 2rem; accent-color: var(--link); }
[hidden] { display: none !important; }
.scale { margin-top: .45rem; font-size: .85rem; font-variant-numeric: tabular-nums; }
.bar { height: .8rem; border: 1px solid var(--line); border-radius: .15rem; }
.ends { display: flex; justify-content: space-between; }
.kinds { list-style: none; padding: 0; margin: .45rem 0 0; font-size: .85rem; display: flex; flex-wrap: wrap; gap: .2rem 1rem; }
.swatch { display: inline-block; width: .9em; height: .9em; border: 1px solid var(--line); vertical-align: -.08em; }

.chart svg { display: block; width: 100%; height: auto; font: 13px system-ui, "Liberation Sans", sans-serif; }
.chart text { fill: var(--soft); }
.chart .axis { fill: var(--ink); }
.grid { stroke: var(--line); stroke-width: 1; }
.exact { stroke: var(--exact); stroke-width: 2.5; }
.exact-mark { fill: var(--exact); stroke: var(--paper); stroke-width: 1.5; }
.chart .exact-text { fill: var(--exact); }
.guide { stroke: var(--soft); stroke-width: 1.3; stroke-dasharray: 5 4; }
.ours-line { fill: none; stroke: var(--ours); stroke-width: 2; }
.ours { fill: var(--ours); stroke: var(--paper); stroke-width: 1.5; }
.theirs { fill: var(--theirs); stroke: var(--paper); stroke-width: 1.5; }
.chart .ours-text { fill: var(--ours); }
.chart .theirs-text { fill: var(--theirs); }

dl { display: grid; grid-template-columns: minmax(8rem, max-content) minmax(0, 1fr); gap: .45rem 1.4rem; max-width: 62rem; margin: 0; }
dt { font-weight: 600; }
dd { margin: 0; min-width: 0; overflow-wrap: anywhere; }
.plain { list-style: none; margin: 0; padding: 0; }
@media (max-width: 40rem) {
  th, td { padding: .32rem .55rem; }
  tbody th { min-width: 9rem; max-width: 46vw; white-space: normal; }
  .group th { max-width: none; white-space: nowrap; }
  .enlarge { display: none; }
  dl, .mesh { grid-template-columns: minmax(0, 1fr); gap: .1rem; }
  dd { margin-bottom: .7rem; }
}
@media print {
  .wipe, nav { display: none; }
  .scroll { overflow: visible; }
}
)css";

// Small pictures can be enlarged. The exact picture is laid over the left part of each mesh's; dragging in the picture or the range below
// it moves the border.
const char* const kPageScript = R"js(
(() => {
  for (const figure of document.querySelectorAll('.gallery figure:not(.pair)')) {
    const button = document.createElement('button');
    button.className = 'enlarge';
    button.type = 'button';
    const say = large => {
      button.textContent = large ? 'smaller' : 'larger';
      button.setAttribute('aria-pressed', large);
    };
    button.addEventListener('click', () => say(figure.classList.toggle('large')));
    say(false);
    figure.querySelector('figcaption').append(' ', button);
  }
  const direct = document.getElementById('direct');
  if (!direct) return;
  for (const pair of document.querySelectorAll('.pair')) {
    const frame = pair.querySelector('.frame'), range = pair.querySelector('input'), cut = document.createElement('div');
    const over = direct.cloneNode();
    over.removeAttribute('id');
    over.className = 'over';
    over.alt = '';
    over.draggable = frame.querySelector('img').draggable = false;
    cut.className = 'cut';
    frame.append(over, cut);
    for (const side of frame.querySelectorAll('.side')) frame.append(side);
    for (const part of pair.querySelectorAll('[hidden]')) part.hidden = false;
    const show = () => frame.style.setProperty('--at', range.value / 10 + '%');
    const follow = event => {
      const box = frame.getBoundingClientRect();
      range.value = 1000 * (event.clientX - box.left) / box.width;
      show();
    };
    range.addEventListener('input', show);
    frame.addEventListener('pointerdown', event => {
      frame.setPointerCapture(event.pointerId);
      follow(event);
    });
    frame.addEventListener('pointermove', event => {
      if (frame.hasPointerCapture(event.pointerId)) follow(event);
    });
    show();
  }
})();
)js";

}  // namespace iso
