// SPDX-License-Identifier: GPL-3.0-or-later
// Printers on paper as the worker tells of them, and what their paper means for pages.
import type { JsonObject, Report } from '../../jobs/contract';

export interface Paper {
  readonly name: string;
  readonly label: string;
  readonly width_mm: number;
  readonly height_mm: number;
  readonly margins_mm: {
    readonly left: number;
    readonly right: number;
    readonly top: number;
    readonly bottom: number;
  };
  readonly loaded: boolean;
  readonly by_hand: boolean;
}

export interface PaperPrinter {
  readonly id: string;
  readonly name: string;
  readonly model?: string;
  readonly state: string;
  readonly reasons: readonly string[];
  readonly accepting?: boolean;
  readonly formats: readonly string[];
  readonly qualities: readonly string[];
  readonly max_copies: number;
  readonly scaling_can_be_off: boolean;
  readonly media: readonly Paper[];
}

const marginSum = ({ margins_mm: m }: Paper) => m.left + m.right + m.top + m.bottom;

/** One of a name, as the worker takes it when it is ordered by that name: what is loaded, and of that the one with
 *  the widest margins, which every tray keeps. Loaded ones first. */
export function papersToChoose(media: readonly Paper[]): Paper[] {
  const chosen = new Map<string, Paper>();
  for (const paper of media) {
    const before = chosen.get(paper.name);
    const better =
      before === undefined ||
      (paper.loaded && !before.loaded) ||
      (paper.loaded === before.loaded && marginSum(paper) > marginSum(before));
    if (better) chosen.set(paper.name, paper);
  }
  const all = [...chosen.values()].filter(({ loaded, by_hand }) => loaded || by_hand);
  return all.sort((a, b) => Number(b.loaded) - Number(a.loaded));
}

/** The parameters of the pages' operation that a paper decides. */
export const paperParameters = ({ width_mm, height_mm, margins_mm: m }: Paper): JsonObject => ({
  media: 'custom',
  media_width_mm: width_mm,
  media_height_mm: height_mm,
  margin_left_mm: m.left,
  margin_right_mm: m.right,
  margin_top_mm: m.top,
  margin_bottom_mm: m.bottom,
});

export const decidedByPaper = Object.keys(
  paperParameters({
    name: '',
    label: '',
    width_mm: 0,
    height_mm: 0,
    margins_mm: { left: 0, right: 0, top: 0, bottom: 0 },
    loaded: true,
    by_hand: false,
  }),
);

export interface PageLayout {
  readonly pages: number;
  readonly columns: number;
  readonly rows: number;
  readonly page_mm: readonly [number, number];
  readonly room_mm: readonly [number, number];
  readonly size_mm: readonly [number, number];
}

const pair = (report: Report, name: string): [number, number] => {
  const value = report[name];
  if (!Array.isArray(value) || value.length !== 2) throw new Error(`The pages' report has no ${name}.`);
  return [Number(value[0]), Number(value[1])];
};

export const layoutOf = (report: Report): PageLayout => ({
  pages: Number(report['pages']),
  columns: Number(report['columns']),
  rows: Number(report['rows']),
  page_mm: pair(report, 'page_mm'),
  room_mm: pair(report, 'room_mm'),
  size_mm: pair(report, 'size_mm'),
});

/** Where each page's room lies over the content, from its upper left, row by row. */
export function roomsOver(
  { columns, rows, room_mm }: PageLayout,
  overlap_mm: number,
): { x_mm: number; y_mm: number }[] {
  const rooms = [];
  for (let row = 0; row < rows; ++row)
    for (let column = 0; column < columns; ++column)
      rooms.push({ x_mm: column * (room_mm[0] - overlap_mm), y_mm: row * (room_mm[1] - overlap_mm) });
  return rooms;
}
