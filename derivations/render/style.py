"""The style sheet of the HTML page: for screens light and dark, wide and narrow, and for paper."""

STYLE = """\
:root {
  color-scheme: light dark;
  --paper: #fdfdfb; --ink: #1c1c1a; --faint: #5d5d57; --rule: #d9d8d0; --link: #0b4f8a;
  --result: #f1f4ee; --shade: #0004;
  --definition: #5d5d57; --proved: #1d6b34; --leading: #7a5200; --argued: #a3261b;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #161715; --ink: #e4e3dc; --faint: #a5a49b; --rule: #3b3c37; --link: #8dbdee;
    --result: #20241f; --shade: #fff5;
    --definition: #a5a49b; --proved: #7fcf97; --leading: #e0b25c; --argued: #f2948a;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0 auto; padding: 1.5rem 1rem 4rem; max-width: 46rem;
  background: var(--paper); color: var(--ink);
  font: 1.05rem/1.55 "STIX Two Text", "Latin Modern Roman", Cambria, Georgia, serif;
  overflow-wrap: break-word;
}
math { font-family: "STIX Two Math", "Latin Modern Math", "Cambria Math", math; }
/* Primes and stars of a font for mathematics are drawn for their place by this feature. */
:is(msup, msub, msubsup) > :not(:first-child) { font-feature-settings: "ssty" 1; }
h1, h2, h3 { line-height: 1.25; font-weight: 600; }
h1 { font-size: 1.9rem; margin: 0.5rem 0 1rem; }
h2 { font-size: 1.4rem; margin: 3rem 0 1rem; padding-bottom: 0.3rem;
  border-bottom: 1px solid var(--rule); }
h3 { font-size: 1.12rem; margin: 2.4rem 0 0.5rem; }
h3 a { color: var(--faint); font-variant-numeric: tabular-nums; }
a { color: var(--link); text-decoration: none; }
a:hover, a:focus-visible { text-decoration: underline; }
p { margin: 0.6rem 0; }
article > p, .given { overflow: auto hidden; }
code { font-size: 0.9em; }
.vocabulary { display: grid; grid-template-columns: max-content 1fr; gap: 0.35rem 1rem;
  margin: 1.2rem 0; font-size: 0.92rem; }
.vocabulary dd { margin: 0; }
nav ul { list-style: none; margin: 0; padding: 0; }
nav > ul > li { margin: 0.9rem 0; font-weight: 600; }
nav ul ul { columns: 2 17rem; column-gap: 2rem; margin-top: 0.3rem; font-size: 0.92rem;
  font-weight: 400; }
nav li li a { break-inside: avoid; display: flex; gap: 0.4rem; padding: 0.08rem 0; }
nav li li .number { flex: none; min-width: 2.3rem; }
article { scroll-margin-top: 0.5rem; }
article:target > h3 { text-decoration: underline 2px; text-underline-offset: 0.25em; }
.steps { list-style: none; margin: 0.8rem 0; padding: 0 0 0 0.9rem;
  border-left: 2px solid var(--rule); }
.steps li { padding: 0.15rem 0 0.15rem 0.3rem; }
.steps li.result { --paper: var(--result); background: var(--result); margin-left: -0.9rem;
  padding-left: 1.2rem; display: grid; grid-template-columns: minmax(0, 1fr) auto;
  align-items: first baseline; }
.steps li.step { padding-right: 3rem; }
.steps .number { min-width: 3rem; padding: 0 0.3rem 0 0.6rem; text-align: right;
  font-variant-numeric: tabular-nums; }
/* The reason stands after the formula, in its line or in the next one. */
.line { display: flex; flex-wrap: wrap; align-items: baseline; column-gap: 1.5rem; }
.reason { margin: 0; padding-left: 1.5rem; text-indent: -1.5rem; color: var(--faint); font-size: 0.9rem; }
.line .scroll + .reason { padding-left: 3rem; }
.status { color: var(--definition); white-space: nowrap; }
.status.proved { color: var(--proved); }
.status.proved-leading-order { color: var(--leading); }
.status.argued { color: var(--argued); }
/* A shade at the side says that there is more to scroll to; at an end its cover hides it. */
.scroll { overflow-x: auto; padding: 0.45rem 0; background:
  linear-gradient(to right, var(--paper) 40%, transparent) left / 2rem 100% no-repeat local,
  linear-gradient(to left, var(--paper) 40%, transparent) right / 2rem 100% no-repeat local,
  linear-gradient(to right, var(--shade), transparent) left / 0.6rem calc(100% - 2px) no-repeat scroll,
  linear-gradient(to left, var(--shade), transparent) right / 0.6rem calc(100% - 2px) no-repeat scroll; }
.line .scroll { flex: 0 0 auto; max-width: 100%; display: flex; flex-wrap: wrap;
  align-items: baseline; row-gap: 0.4rem; padding-left: 1.5rem; }
.line .scroll math { flex: none; width: max-content; margin: 0; }
.line .scroll > :first-child { margin-left: -1.5rem; }
.line .scroll .term { display: flex; flex-wrap: wrap; align-items: baseline; row-gap: 0.4rem;
  max-width: 100%; }
.line .scroll .end { flex: none; display: flex; column-gap: 1.5rem; align-items: baseline; }
.unbroken { white-space: nowrap; }
td math { math-style: normal; }
.domain { margin: 0.2rem 0; font-size: 0.9rem; }
.related { display: flex; flex-wrap: wrap; column-gap: 1.5rem; margin: 0.2rem 0;
  color: var(--faint); font-size: 0.9rem; }
table { border-collapse: collapse; font-size: 0.95rem; }
th, td { padding: 0.35rem 1.2rem 0.35rem 0; text-align: left; vertical-align: baseline; }
thead th { border-bottom: 1.5px solid var(--ink); }
td { border-bottom: 1px solid var(--rule); }
td:first-child { white-space: nowrap; }
footer { font-size: 0.95rem; }
@media (max-width: 30rem) {
  .vocabulary { grid-template-columns: 1fr; gap: 0.1rem; }
  .vocabulary dd { margin-bottom: 0.5rem; }
  .line .scroll { font-size: 0.92em; }
  .reason { max-width: 100%; }
  .reason, .domain { min-width: 0; overflow-x: auto; padding: 0.2rem 0; }
  .steps { padding-left: 0.5rem; }
  .steps li.result { margin-left: -0.5rem; padding-left: 0.8rem; grid-template-columns: minmax(0, 1fr); }
  .steps .number { justify-self: end; }
  .steps li.step { padding-right: 0; }
  td:first-child { white-space: normal; }
  th, td { padding-right: 0.7rem; }
  #nomenclature :is(th, td):nth-child(4) { display: none; }
}
@media print {
  :root { --paper: #fff; --ink: #000; --faint: #333; --link: #000; --result: #fff; }
  @page { margin: 20mm; }
  body { max-width: none; padding: 0; font-size: 10pt; }
  nav { display: none; }
  h2, h3, article > p:not(.related), .given { break-after: avoid; }
  .related { break-before: avoid; }
  .steps li, tr, .line { break-inside: avoid; }
  .steps li.result { outline: 0.5pt solid var(--rule); }
  .scroll, article > p, .given { overflow: visible; background: none; }
}
"""
