// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import { headed, notesOf } from './report_notes';

describe('notes of a report', () => {
  const report = {
    notes: ['The tapes meet: trim them.', 'Sew slowly.'],
    warnings: ['It thins.', 'Sew slowly.'],
    fixes: [
      { sentence: 'It thins.', label: 'Make it smaller', parameters: { size_mm: 80 } },
      { sentence: 'No such note.', label: 'Nothing', parameters: {} },
      { sentence: 'Sew slowly.', label: 3, parameters: {} },
      'damaged',
    ],
  };
  it('come once each, with their fix', () => {
    expect(notesOf(report, 'warnings', 'notes')).toEqual([
      { sentence: 'It thins.', fix: { label: 'Make it smaller', parameters: { size_mm: 80 } } },
      { sentence: 'Sew slowly.', fix: null },
      { sentence: 'The tapes meet: trim them.', fix: null },
    ]);
    expect(notesOf({}, 'notes')).toEqual([]);
  });
  it('have a head and what follows', () => {
    expect(headed('The tapes meet: trim them.')).toEqual(['The tapes meet', 'Trim them.']);
    expect(headed('It thins to 0.1 mm. Use less.')).toEqual(['It thins to 0.1 mm', 'Use less.']);
    expect(headed('Sew slowly.')).toEqual(['Sew slowly', '']);
  });
});
