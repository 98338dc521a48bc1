// SPDX-License-Identifier: GPL-3.0-or-later
import { expect, test } from 'vitest';
import type { Paper } from './paper';
import { decidedByPaper, layoutOf, paperParameters, papersToChoose, roomsOver } from './paper';

const paper = (name: string, margin: number, loaded: boolean, by_hand = false): Paper => ({
  name,
  label: name,
  width_mm: 210,
  height_mm: 297,
  margins_mm: { left: margin, right: margin + 1, top: margin + 2, bottom: margin + 3 },
  loaded,
  by_hand,
});

test('one paper of a name: what is loaded, with the widest margins', () => {
  const chosen = papersToChoose([
    paper('A4', 0, true),
    paper('A4', 4, true),
    paper('A4', 9, false),
    paper('A3', 5, false, true),
    paper('Letter', 3, true),
    paper('A2', 3, false),
  ]);
  expect(chosen.map(({ name, margins_mm }) => [name, margins_mm.left])).toEqual([
    ['A4', 4],
    ['Letter', 3],
    ['A3', 5],
  ]);
});

test('a paper decides size and margins, side by side', () => {
  expect(paperParameters(paper('A4', 4, true))).toEqual({
    media: 'custom',
    media_width_mm: 210,
    media_height_mm: 297,
    margin_left_mm: 4,
    margin_right_mm: 5,
    margin_top_mm: 6,
    margin_bottom_mm: 7,
  });
  expect(decidedByPaper).toContain('margin_top_mm');
});

test('rooms overlap by what was asked for and cover the content', () => {
  const layout = layoutOf({
    pages: 6,
    columns: 3,
    rows: 2,
    page_mm: [210, 297],
    room_mm: [190, 280],
    size_mm: [540, 500],
  });
  const rooms = roomsOver(layout, 10);
  expect(rooms).toHaveLength(6);
  expect(rooms[1]).toEqual({ x_mm: 180, y_mm: 0 });
  expect(rooms[5]).toEqual({ x_mm: 360, y_mm: 270 });
  expect((rooms[5]?.x_mm ?? 0) + 190).toBeGreaterThanOrEqual(540);
  expect((rooms[5]?.y_mm ?? 0) + 280).toBeGreaterThanOrEqual(500);
});
