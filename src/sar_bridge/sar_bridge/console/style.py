"""The page's looks: palettes for day, night, and eyes that are used to the dark."""

CSS = """
:root { --back: #e8ecef; --panel: #ffffff; --ink: #101418; --dim: #5a646e; --line: #b4bec8;
  --sea: #d4e4ee; --heli: #c03a00; --uav: #00509e; --plan: #007a3d; --gap: #d02020;
  --normal: #1c7c3c; --caution: #f0a000; --warning: #d01818; --idle: #66707a; --on: #ffffff; }
body.night { --back: #0c1116; --panel: #161d25; --ink: #dfe6ec; --dim: #8b98a5; --line: #33404d;
  --sea: #0f1a24; --heli: #ff8a50; --uav: #6ab0ff; --plan: #5ad08a; --gap: #ff5050;
  --normal: #1f7a40; --caution: #c88400; --warning: #c21f1f; --idle: #3c4650; --on: #ffffff; }
body.red { --back: #080000; --panel: #140000; --ink: #e03028; --dim: #96201a; --line: #4a1210;
  --sea: #0c0000; --heli: #ff5040; --uav: #b02820; --plan: #802018; --gap: #ff2010;
  --normal: #400c0a; --caution: #7a1a14; --warning: #d01c10; --idle: #240806; --on: #ffc4b8; }
body { background: var(--back); color: var(--ink); font-family: system-ui, sans-serif;
  overflow: hidden; }
.nicegui-content { padding: 0; gap: 0; width: 100vw; height: 100vh; }
.desk { display: grid; width: 100%; height: 100%; gap: 6px; padding: 6px; box-sizing: border-box;
  grid-template: "banner banner" auto "map side" 1fr "buttons side" auto / 1fr 356px; }
.desk.several { grid-template: "banner banner" auto "uavs side" auto "map side" 1fr
  "buttons side" auto / 1fr 356px; }
.uavs { grid-area: uavs; display: flex; flex-direction: column; gap: 4px; min-width: 0; }
.uavrow { display: grid; gap: 8px; align-items: center; padding: 2px 6px; border-radius: 6px;
  border-left: 8px solid var(--idle); min-width: 0;
  grid-template-columns: 84px 82px 50px 56px 56px minmax(0, 1fr) 66px minmax(0, 1.2fr) 82px; }
.uavrow.normal { border-color: var(--normal); } .uavrow.caution { border-color: var(--caution); }
.uavrow.warning { border-color: var(--warning); } .uavrow.chosen { background: var(--back); }
.uavrow .q-btn { min-height: 44px; text-transform: none; font-weight: 700;
  color: var(--ink) !important; }
.uavrow.chosen .q-btn { border: 3px solid var(--ink); }
.cell { min-width: 0; } .cell .name { font-size: 12px; color: var(--dim); }
.cell .value { font-size: 15px; font-weight: 600; line-height: 1.15; overflow: hidden;
  text-overflow: ellipsis; white-space: nowrap; }
.cell.alert .value, .cell.link .value, .cell.list .value { font-size: 13px; white-space: normal;
  max-height: 2.3em; }
.banner { grid-area: banner; display: flex; align-items: center; gap: 16px; padding: 6px 14px;
  border-radius: 6px; color: var(--on); min-height: 66px; }
.banner.idle { background: var(--idle); } .banner.normal { background: var(--normal); }
.banner.caution { background: var(--caution); } .banner.warning { background: var(--warning); }
.banner .shape { font-size: 40px; line-height: 1; } .banner .state { font-size: 30px;
  font-weight: 700; white-space: nowrap; } .banner .reason { font-size: 18px; line-height: 1.15; }
.banner .action { font-size: 18px; font-weight: 600; margin-left: auto; text-align: right; }
body:not(.red) .banner.caution { color: #141000; }
.map { grid-area: map; background: var(--sea); border-radius: 6px; overflow: hidden;
  position: relative; min-height: 0; }
.map .nicegui-interactive-image { width: 100%; height: 100%; }
.tools { position: absolute; right: 8px; top: 8px; display: flex; flex-direction: column;
  gap: 6px; z-index: 5; }
.tools .q-btn { min-width: 52px; min-height: 44px; background: var(--panel) !important;
  color: var(--ink) !important; }
.side { grid-area: side; display: flex; flex-direction: column; gap: 6px; min-height: 0;
  overflow: auto; }
.panel { background: var(--panel); border-radius: 6px; padding: 6px 10px; }
.figures { display: grid; grid-template-columns: 1fr 1fr; gap: 2px 12px; }
.figure .name { font-size: 13px; color: var(--dim); }
.figure .value { font-size: 28px; font-weight: 650; line-height: 1.1;
  font-variant-numeric: tabular-nums; white-space: nowrap; }
.figure.wide { grid-column: span 2; } .figure.small .value { font-size: 18px; }
.stale { opacity: 0.35; filter: grayscale(1); } body.red .stale { filter: none; }
svg .old { opacity: 0.35; }
.light { display: flex; gap: 8px; font-size: 14px; line-height: 1.35; align-items: baseline; }
.light .what { width: 74px; font-weight: 600; } .light .text { color: var(--dim); }
.dot.idle { color: var(--dim); } .dot.normal { color: var(--normal); }
.dot.caution { color: var(--caution); } .dot.warning { color: var(--warning); }
.buttons { grid-area: buttons; display: flex; gap: 8px; }
.buttons .q-btn { min-height: 58px; flex: 1; font-size: 14px; padding: 4px 6px; font-weight: 700;
  background: var(--panel) !important; color: var(--ink) !important; }
.buttons .q-btn.hold:active { background: linear-gradient(90deg, var(--warning) 50%,
  var(--panel) 50%) 100% 0 / 200% 100% !important; animation: held 1s linear forwards; }
@keyframes held { to { background-position: 0 0; } }
.answers { font-size: 14px; color: var(--dim); min-height: 20px; }
.check { display: flex; gap: 10px; font-size: 16px; align-items: baseline; padding: 3px 0; }
.check .why { color: var(--dim); font-size: 14px; }
.slot .q-btn[aria-pressed="true"] { background: var(--ink); color: var(--panel); }
.slot .q-btn { min-height: 48px; min-width: 64px; font-size: 15px; font-weight: 700; }
.q-card { background: var(--panel); color: var(--ink); }
.q-checkbox__label { font-size: 16px; }
body.night svg .tile { filter: brightness(0.35); }
body.red svg .tile { filter: grayscale(1) brightness(0.2); opacity: 0.6; }
svg .attribution { fill: var(--dim); font-size: 11px; }
svg .grid { stroke: var(--line); stroke-width: 1; } svg text { fill: var(--ink); font-size: 13px; }
svg .gridlabel, svg .ringlabel { fill: var(--dim); font-size: 12px; }
svg .swath { fill: none; stroke-opacity: 0.22; stroke-linejoin: round; }
svg .swath.helicopter { stroke: var(--heli); } svg .swath.uav { stroke: var(--uav); }
svg .track { fill: none; stroke-width: 2; } svg .track.helicopter { stroke: var(--heli); }
svg .track.uav { stroke: var(--uav); }
svg .track.other { stroke-opacity: 0.6; } svg .swath.other { stroke-opacity: 0.14; }
svg .gap { fill: var(--gap); fill-opacity: 0.55; }
svg .plan { fill: none; stroke: var(--plan); stroke-width: 3; stroke-dasharray: 9 5; }
svg .pattern { fill: none; stroke: var(--dim); stroke-width: 1.2; stroke-dasharray: 4 7; }
svg .plandot { fill: var(--plan); }
svg .escape { fill: none; stroke: var(--warning); stroke-width: 4; stroke-dasharray: 4 4; }
svg .escapedot { fill: var(--warning); }
svg .doubt { fill: var(--heli); fill-opacity: 0.15; stroke: var(--heli); }
svg .stop { fill: none; stroke: var(--heli); stroke-width: 3; }
svg .mark { fill: none; stroke: var(--gap); stroke-width: 3; } svg .marklabel { font-weight: 700; }
svg .ring { fill: none; stroke: var(--dim); stroke-opacity: 0.5; }
svg .least { fill: none; stroke: var(--warning); stroke-width: 2; stroke-dasharray: 3 5; }
svg g.helicopter path { fill: var(--heli); stroke: var(--panel); }
svg g.uav path { fill: var(--uav); stroke: var(--panel); }
svg .callsign { font-weight: 700; }
svg.trend { width: 100%; height: 44px; } svg .trendline { fill: none; stroke: var(--uav);
  stroke-width: 2; } svg .leastline { stroke: var(--warning); stroke-dasharray: 3 4; }
"""

SCRIPT = """
<script>
window.console_sound = null;
window.armSound = () => {
  window.console_sound = window.console_sound || new AudioContext();
  window.console_sound.resume(); window.beep(660, 0.15);
};
window.beeps = 0;
window.beep = (hertz, seconds) => {
  const context = window.console_sound;
  if (!context) return;
  window.beeps += 1;
  const tone = context.createOscillator(), gain = context.createGain();
  tone.frequency.value = hertz; gain.gain.value = 0.3;
  tone.connect(gain); gain.connect(context.destination);
  tone.start(); tone.stop(context.currentTime + seconds);
};
// What the page shows is old when its pulse stands: the console, or the way to it, is dead.
let pulseText = "", pulseSeen = Date.now();
setInterval(() => {
  const pulse = document.querySelector(".pulse"), text = pulse ? pulse.textContent : "";
  if (text !== pulseText) { pulseText = text; pulseSeen = Date.now(); }
  const desk = document.querySelector(".desk");
  if (desk) desk.classList.toggle("stale", Date.now() - pulseSeen > 2000);
}, 250);
</script>
"""
