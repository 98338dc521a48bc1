// SPDX-License-Identifier: GPL-3.0-or-later
import { strToU8, zipSync } from 'fflate';
import { expect, test } from 'vitest';
import { sheetOf } from './send_sheet';

test('a sheet is found by its number, counted from 0', () => {
  const archive = zipSync({
    'sheet_1.dxf': strToU8('0'),
    'sheet_1.svg': strToU8('one'),
    'sheet_2.svg': strToU8('two'),
  });
  expect(new TextDecoder().decode(sheetOf(archive, 0))).toBe('one');
  expect(new TextDecoder().decode(sheetOf(archive, 1))).toBe('two');
  expect(sheetOf(archive, 2)).toBeUndefined();
});
