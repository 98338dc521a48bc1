// @vitest-environment happy-dom
// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, it } from 'vitest';
import { readSheets } from './sheet_drawing';

const svg = (inside: string, box = '0 0 420 100') =>
  `<?xml version="1.0" encoding="UTF-8"?>\n<svg xmlns="http://www.w3.org/2000/svg" width="420mm" height="100mm" viewBox="${box}">\n<title>Plan</title>\n${inside}</svg>\n`;
const frames =
  '<g id="note" fill="none" stroke="#888888"><path id="sheet-1" d="M0 100L200 100L200 0L0 0Z"/><path id="sheet-2" d="M220 100L420 100L420 0L220 0Z"/></g>';

it('parts what lies side by side into sheets, each from its own corner', () => {
  const sheets = readSheets(
    svg(
      `<g id="cut" stroke="#ff0000"><path id="a" d="M10 10L20 10.5Z"/><path d="M230 30L240 30"/><path d="M30 30L40 30"/></g>${frames}`,
    ),
  );
  expect(sheets).toEqual([
    {
      width_mm: 200,
      height_mm: 100,
      lines: [{ layer: 'cut', colour: '#ff0000', d: 'M10 10L20 10.5ZM30 30L40 30' }],
    },
    { width_mm: 200, height_mm: 100, lines: [{ layer: 'cut', colour: '#ff0000', d: 'M10 30L20 30' }] },
  ]);
});

it('takes nothing but lines and colours from a drawing', () => {
  const hostile = svg(
    '<script>alert(1)</script><g id="cut" stroke="url(https://example.org)"><path d="M0 0L1 1" onclick="alert(1)"/><path d="M0 0C1 1 2 2 3 3"/><path d="M1 1LNaN 2"/><path d="M1.2.3 1L2 2"/></g>',
  );
  expect(readSheets(hostile)).toEqual([
    { width_mm: 420, height_mm: 100, lines: [{ layer: 'cut', colour: '#000', d: 'M0 0L1 1' }] },
  ]);
});

it('has no sheets of what is no drawing', () => {
  for (const text of ['', 'words', svg(frames, '0 0 0 0'), '<svg xmlns="http://www.w3.org/2000/svg"/>'])
    expect(readSheets(text)).toEqual([]);
});
