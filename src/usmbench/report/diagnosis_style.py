"""The report's style sheet: light, dark, narrow and printed."""

STYLE = """
:root { color-scheme: light dark; --paper: #ffffff; --card: #f5f6f8; --ink: #1b1f24;
  --muted: #57606a; --rule: #d0d5db; --band: #dfe4ea; --measured: #98a1ab; --before: #b4480f;
  --after: #0b57a4; --good: #1a6e36; --warn: #8f5200; --bad: #b02318; }
@media (prefers-color-scheme: dark) { :root { --paper: #14171b; --card: #1e2329; --ink: #e8ebee;
  --muted: #a3adb8; --rule: #3a424c; --band: #313943; --measured: #77828e; --before: #f2935c;
  --after: #6cb3ff; --good: #6fcf8b; --warn: #f0b24f; --bad: #ff8a7d; } }
@media print { :root { --paper: #ffffff; --card: #ffffff; --ink: #000000; --muted: #444444;
  --rule: #bbbbbb; --band: #dddddd; --measured: #8a8a8a; --before: #b4480f; --after: #0b57a4;
  --good: #1a6e36; --warn: #8f5200; --bad: #b02318; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); overflow-wrap: anywhere;
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Liberation Sans", sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 24px 20px 48px; }
h1 { font-size: 1.05rem; font-weight: 600; color: var(--muted); margin: 0 0 12px; }
h2 { font-size: 1.3rem; margin: 44px 0 6px; padding-top: 14px; border-top: 1px solid var(--rule); }
h3 { font-size: 1.05rem; margin: 18px 0 4px; }
p, ul { margin: 6px 0 10px; max-width: 46rem; }
.verdict { background: var(--card); border: 1px solid var(--rule); border-left: 6px solid;
  border-radius: 6px; padding: 18px 20px; }
.verdict.no_discrepancy { border-left-color: var(--good); }
.verdict.explained { border-left-color: var(--after); }
.verdict.partly_explained { border-left-color: var(--warn); }
.verdict.unexplained { border-left-color: var(--bad); }
.verdict strong { display: block; font-size: 1.55rem; line-height: 1.25; margin-bottom: 6px; }
.verdict p { font-size: 1.1rem; margin: 0; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(170px, 1fr)); gap: 12px;
  margin: 16px 0 0; padding: 0; }
.figures div { background: var(--card); border: 1px solid var(--rule); border-radius: 6px;
  padding: 10px 14px; }
.figures dt { color: var(--muted); font-size: .86rem; }
.figures dd { margin: 0; font-size: 1.25rem; font-weight: 600; }
.figures dd small { display: block; font-size: .84rem; font-weight: 400; color: var(--muted); }
.note, figcaption, .how { color: var(--muted); font-size: .9rem; }
.warning { border-left: 4px solid var(--warn); padding-left: 12px; }
figure { margin: 12px 0; min-width: 0; }
figcaption { margin: 0 0 4px; }
figcaption b { color: var(--ink); }
.views { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 320px), 1fr));
  gap: 8px 20px; align-items: end; }
svg { display: block; width: 100%; height: auto; }
svg.narrow { display: none; }
svg text { font: 12px system-ui, -apple-system, "Segoe UI", "Liberation Sans", sans-serif;
  fill: var(--ink); text-anchor: middle; }
svg text.tick { fill: var(--muted); font-size: 11px; }
svg text.end { text-anchor: end; }
path { fill: none; stroke: none; }
path.frame { stroke: var(--muted); stroke-width: 1; }
path.grid { stroke: var(--rule); stroke-width: .6; }
path.zero { stroke: var(--muted); stroke-width: 1; }
path.band { fill: var(--band); }
path.measured { stroke: var(--measured); stroke-width: 3.2; stroke-linejoin: round; }
path.before { stroke: var(--before); stroke-width: 1.3; stroke-dasharray: 5 3; }
path.after { stroke: var(--after); stroke-width: 1.3; }
path.before.dense { stroke-dasharray: none; stroke-width: 2.6; opacity: .5; }
path.after.dense { stroke-width: .8; }
path.before.mark { fill: var(--paper); stroke-dasharray: none; }
path.after.mark { fill: var(--after); }
.legend { display: flex; flex-wrap: wrap; gap: 4px 20px; padding: 0; margin: 8px 0;
  list-style: none; font-size: .9rem; max-width: none; }
.legend li { display: flex; align-items: center; gap: 8px; }
.legend svg { width: 34px; height: 14px; flex: none; }
table { border-collapse: collapse; width: 100%; margin: 10px 0; font-size: .94rem; }
th, td { text-align: left; padding: 7px 10px 7px 0; border-bottom: 1px solid var(--rule);
  vertical-align: top; }
th { color: var(--muted); font-weight: 600; font-size: .86rem; }
td.figure, th.figure { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td:first-child { min-width: 11rem; }
tr.named td { font-weight: 600; }
tr.named td .how { font-weight: 400; }
.tag { display: inline-block; border: 1px solid currentColor; border-radius: 10px; padding: 0 8px;
  font-size: .8rem; font-weight: 600; white-space: nowrap; }
.tag.named { color: var(--after); }
.tag.tied { color: var(--warn); }
.bar { display: block; height: 9px; min-width: 90px; border: 1px solid var(--muted); }
.bar i { display: block; height: 100%; background: var(--muted); }
tr.named .bar i { background: var(--after); }
.cause { background: var(--card); border: 1px solid var(--rule); border-radius: 6px;
  padding: 6px 18px 8px; margin: 12px 0; }
summary { cursor: pointer; color: var(--muted); padding: 6px 0; }
pre { background: var(--card); border: 1px solid var(--rule); border-radius: 6px;
  padding: 12px 14px; white-space: pre-wrap;
  font: 13px/1.45 ui-monospace, "Liberation Mono", monospace; }
code { font: .92em ui-monospace, "Liberation Mono", monospace; }
@media (max-width: 640px) {
  main { padding: 14px 14px 32px; }
  svg.wide { display: none; }
  svg.narrow { display: block; }
  .verdict strong { font-size: 1.3rem; }
  .verdict p { font-size: 1rem; }
  .figures { grid-template-columns: 1fr 1fr; }
  thead { display: none; }
  tr { display: block; padding: 8px 0; border-bottom: 1px solid var(--rule); }
  td:first-child { min-width: 0; }
  td, td.figure { display: grid; grid-template-columns: 38% 1fr; gap: 10px; border: 0;
    padding: 2px 0; text-align: left; white-space: normal; }
  td::before { content: attr(data-label); color: var(--muted); font-weight: 400;
    font-size: .86rem; }
}
@media print {
  body { font-size: 11pt; }
  main { max-width: none; padding: 0; }
  figure, tr, .cause, .verdict, .figures div { break-inside: avoid; }
  h2, h3 { break-after: avoid; }
  .views { grid-template-columns: 1fr 1fr; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
"""
