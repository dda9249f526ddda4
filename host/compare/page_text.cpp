// Without the script the page shows the pictures of every layer, one below the other. The script
// puts A over B, shows one layer, and moves the line between A and B (the CSS variable --at).
#include "compare/page_text.hpp"

namespace dapple {

const char* const kPageStyle = R"css(
:root { color-scheme: light dark; --at: 50%; --ink: #1b1b1f; --paper: #fafafa; --faint: #66666e;
  --line: #d4d4da; --accent: #7a1f80; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e8e8ec; --paper: #17171b; --faint: #a0a0aa; --line: #3a3a42; --accent: #e59ae8; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 110rem; padding: 1rem 1.5rem 3rem; color: var(--ink);
  background: var(--paper); font: 1rem/1.5 system-ui, sans-serif; }
h1 { font-size: 1.3rem; margin: 0 0 .5rem; }
h2 { font-size: 1.1rem; margin: 2rem 0 .5rem; }
h3 { font-size: 1rem; margin: 1rem 0 .5rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0 .75rem; margin: 0; }
dt { font-weight: 600; }
dd { margin: 0; overflow-wrap: anywhere; }
.controls { display: none; flex-wrap: wrap; gap: .5rem 1.5rem; align-items: center; }
.controls label { display: flex; gap: .5rem; align-items: center; }
.controls input[type=range] { width: min(24rem, 60vw); accent-color: var(--accent); }
.pictures { display: grid; gap: 1rem;
  grid-template-columns: repeat(auto-fit, minmax(min(28rem, 100%), 1fr)); }
figure { margin: 0; }
figcaption { color: var(--faint); font-size: .9rem; margin-top: .25rem; }
img { display: block; width: 100%; height: auto; background: #000; }
img.small { image-rendering: pixelated; }
.js .controls { display: flex; }
.js .swipe { position: relative; cursor: ew-resize; touch-action: pan-y; }
.js .swipe .over { position: absolute; inset: 0; clip-path: inset(0 calc(100% - var(--at)) 0 0); }
.js .swipe::after { content: ""; position: absolute; inset: 0 auto 0 var(--at); width: 2px;
  margin-left: -1px; background: #fff; outline: 1px solid #000; pointer-events: none; }
.ramp { display: block; height: .75rem; border: 1px solid var(--line); }
.ends { display: flex; justify-content: space-between; }
.scroll { overflow-x: auto; }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; white-space: nowrap; }
th, td { padding: .25rem .75rem; text-align: right; border-bottom: 1px solid var(--line); }
th:first-child { text-align: left; }
tr.chosen { background: color-mix(in srgb, var(--accent) 14%, transparent); }
.fails { color: var(--accent); font-weight: 600; }
.notes { color: var(--faint); font-size: .9rem; grid-template-columns: max-content minmax(0, 1fr); }
)css";

const char* const kPageScript = R"js(
'use strict';
const root = document.documentElement;
const layer = document.getElementById('layer');
const swipe = document.getElementById('swipe');
const sections = Array.from(document.querySelectorAll('section.layer'));
root.classList.add('js');

function showLayer() {
  for (const section of sections) section.hidden = section.id !== layer.value;
  for (const row of document.querySelectorAll('tr[data-layer]'))
    row.classList.toggle('chosen', row.dataset.layer === layer.value);
}

function moveLine(percent) {
  swipe.value = percent;
  swipe.setAttribute('aria-valuetext', Math.round(percent) + ' percent A');
  root.style.setProperty('--at', percent + '%');
}

function drag(event) {
  if (event.buttons === 0) return;
  const box = event.currentTarget.getBoundingClientRect();
  const percent = 100 * (event.clientX - box.left) / box.width;
  moveLine(Math.min(100, Math.max(0, percent)));
}

for (const picture of document.querySelectorAll('.swipe')) {
  picture.addEventListener('pointerdown', drag);
  picture.addEventListener('pointermove', drag);
  picture.addEventListener('dragstart', (event) => event.preventDefault());
}
layer.addEventListener('change', showLayer);
swipe.addEventListener('input', () => moveLine(Number(swipe.value)));
showLayer();
moveLine(50);
)js";

}  // namespace dapple
