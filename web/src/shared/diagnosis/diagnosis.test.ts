// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Report } from '../../jobs/contract';
import {
  formatEstimate,
  formatPart,
  oddsAgainstNone,
  percent,
  readDiagnosis,
  readingWords,
} from './diagnosis';
import { extensionWords, goodPartWords, sureWords, whyWords } from './diagnosis_words';

const report: Report = {
  verdict: ['heating_gradient'],
  reading: 'cannot_separate',
  sentence: 'Uneven heating, 60 %.',
  doubts: ['Another explanation is nearly as likely.'],
  answers: [
    { causes: ['heating_gradient'], unknown_cause: false, label: 'Uneven heating', probability: 0.6 },
    { causes: ['thickness_wedge'], unknown_cause: false, label: 'Wedge', probability: 0.388 },
    { causes: [], unknown_cause: true, label: 'A cause that is not in the list', probability: 0.008 },
    { causes: [], unknown_cause: false, label: 'Nothing wrong', probability: 0.0035 },
  ],
  other_answers: 0.0005,
  failed: [{ causes: ['weak_vacuum'], label: 'Vacuum too weak', sentence: 'It would fit, but.' }],
  causes: [
    {
      name: 'heating_gradient',
      label: 'Uneven heating',
      probability: 0.6,
      strength: 0.4,
      unit: '',
      interval: [0.38, 0.42],
      values: { heating_gradient_x: 0.4 },
      remedy: 'Turn the heater.',
      fault_of: 'simulation',
      in_words: 'The sheet was hotter on the left.',
    },
    {
      name: 'thickness_wedge',
      label: 'Wedge',
      probability: 0.4,
      strength: 0.3,
      unit: 'mm',
      interval: [0.1, 0.5],
    },
  ],
  not_separable: [{ causes: ['heating_gradient', 'thickness_wedge'], measurement: 'Turn the sheet.' }],
  simulation: [
    {
      name: 'constant_volume',
      label: 'The plastic keeps its volume',
      taken: true,
      explanation: 'Hot plastic thins as much as it is stretched.',
      remedy: 'The setting elastic_law does that.',
      error_before_mm: 0.45,
      error_after_mm: 0.31,
    },
    { name: 'lasting_network', label: 'Network', taken: false, explanation: '', remedy: '' },
    {
      name: 'finer_sheet',
      label: 'The triangles are too large',
      taken: false,
      advised: true,
      explanation: 'Twice as many triangles follow the mould nearer.',
      remedy: 'They take longer.',
      error_before_mm: 0.31,
      error_after_mm: 0.27,
    },
  ],
  error_before_mm: 0.28,
  error_before_interval_mm: [0.2, 0.3],
  error_after_mm: 0.14,
  error_after_interval_mm: [0.1, 0.2],
  gain_share: 0.5,
  gain_interval: [0.4, 0.6],
  unseen: { objects: ['bowl'], error_before_mm: 1, error_after_mm: 0.5, gain_share: 0.5 },
  other_quantities: [{ object: 'lamp, thickness', readings: 4, error_before_mm: 0.12, error_after_mm: 0.03 }],
  noise_floor_mm: 0.12,
  noise: [{ object: 'lamp', sigma_mm: 0.08 }],
  hypotheses: [
    { causes: ['heating_gradient'], unknown_structure: false, probability: 0.6, log_evidence: 100 },
    { causes: [], unknown_structure: true, probability: 0.03, log_evidence: 90 },
  ],
};

describe('a diagnosis', () => {
  it('is read with its gains, on parts left out and on other objects', () => {
    const diagnosis = readDiagnosis(report);
    expect(diagnosis.named).toEqual(['heating_gradient']);
    expect(diagnosis.causes.map(({ faultOf }) => faultOf)).toEqual(['simulation', 'machine']);
    expect(diagnosis.gains.map(({ title }) => title)).toEqual(['Points left out', 'Kept for checking']);
    expect(diagnosis.gains[0]?.after).toEqual({ value: 0.14, low: 0.1, high: 0.2 });
    expect(diagnosis.gains[1]?.after).toEqual({ value: 0.5, low: 0.5, high: 0.5 });
    expect(diagnosis.sigma_mm.get('lamp')).toBe(0.08);
  });

  it('has answers that add up to 1, and says what failed a check', () => {
    const diagnosis = readDiagnosis(report);
    expect(diagnosis.answers.map(({ label }) => label)).toEqual([
      'Uneven heating',
      'Wedge',
      'All other answers',
    ]);
    expect(diagnosis.answers.reduce((sum, { probability }) => sum + probability, 0)).toBeCloseTo(1, 12);
    expect(diagnosis.failed).toEqual([
      { label: 'Vacuum too weak', causes: ['weak_vacuum'], why: 'It would fit, but.' },
    ]);
  });

  it('asks for a good part where the answer is in doubt and there is none', () => {
    expect(goodPartWords(readDiagnosis(report))).toEqual([expect.stringMatching(/^If you have a part over/)]);
    expect(goodPartWords(readDiagnosis({ ...report, doubts: [] }))).toEqual([]);
    expect(goodPartWords(readDiagnosis({ ...report, doubts: [], reading: 'unknown' }))).toHaveLength(1);
    const beside = readDiagnosis({ ...report, good_parts: ['June'] });
    expect(beside.goodParts).toEqual(['June']);
    expect(goodPartWords(beside)).toEqual([]);
  });

  it('says what happened, how sure, and what speaks against it', () => {
    const diagnosis = readDiagnosis(report);
    expect(whyWords(diagnosis)).toBe(
      'The sheet was hotter on the left. “Uneven heating” and “Wedge” explain this measurement equally well.',
    );
    expect(sureWords(diagnosis)).toEqual([
      '60\u2009% for “Uneven heating”.',
      'On points that were left out of the fit, the error falls from 0.28\u2009mm to 0.14\u2009mm.',
      'On the object kept for checking, the error falls from 1.0\u2009mm to 0.50\u2009mm.',
      'lamp, thickness, 4 readings: the error falls from 0.12\u2009mm to 0.030\u2009mm.',
      'Another explanation is nearly as likely.',
    ]);
    const nothing = readDiagnosis({ ...report, reading: 'none', verdict: ['none'], doubts: [] });
    expect(whyWords(nothing)).toMatch(/^Nothing to fix/);
    expect(sureWords(nothing)).toHaveLength(1);
  });

  it('says what the simulation left out and now includes, and what else would help', () => {
    expect(extensionWords(readDiagnosis(report))).toEqual([
      'Hot plastic thins as much as it is stretched. Our usual simulation leaves that out; it is included here, and the calibrated error is 0.31\u2009mm instead of 0.45\u2009mm. The setting elastic_law does that.',
      'Twice as many triangles follow the mould nearer. It is not included here, since it takes longer: with it and nothing else changed, the error is 0.27\u2009mm instead of 0.31\u2009mm. They take longer.',
    ]);
    expect(extensionWords(readDiagnosis({}))).toEqual([]);
  });

  it('says in words what looks alike and what would tell', () => {
    const diagnosis = readDiagnosis(report);
    expect(readingWords(diagnosis)).toBe(
      '“Uneven heating” and “Wedge” explain this measurement equally well.',
    );
    expect(diagnosis.alike[0]?.measurement).toBe('Turn the sheet.');
    for (const reading of ['none', 'unknown'] as const)
      expect(readingWords({ reading, alike: [] })).toMatch(/\.$/);
  });

  it('survives a report with nothing in it', () => {
    const empty = readDiagnosis({});
    expect(empty.causes).toEqual([]);
    expect(empty.reading).toBe('none');
    expect(oddsAgainstNone({}, 'x')).toBeNull();
  });

  it('compares evidence with and without a cause', () => {
    expect(oddsAgainstNone(report, 'heating_gradient')).toBeCloseTo(10 / Math.LN10, 9);
    expect(oddsAgainstNone(report, 'thickness_wedge')).toBeNull();
  });

  it('never claims to be certain', () => {
    expect([0, 0.004, 0.873, 0.9999].map((p) => percent(p).replace('\u2009', ' '))).toEqual([
      '< 1 %',
      '< 1 %',
      '87 %',
      '> 99 %',
    ]);
  });

  it('gives as many digits as the doubt leaves', () => {
    expect(formatEstimate({ value: 0.396, low: 0.3815, high: 0.4105 }, '')).toBe('0.40 ± 0.01');
    expect(formatEstimate({ value: -1.52, low: -1.8, high: -1.2 }, 'mm')).toBe('\u22121.5 ± 0.3\u2009mm');
    expect(formatEstimate({ value: 14, low: 10, high: 18 }, '°')).toBe('14 ± 4°');
  });

  it('gives no more digits to a part than the whole has', () => {
    const turn = { value: 1.09, low: 1.02, high: 1.16 };
    expect(formatPart(0.6, turn, '°')).toBe('0.60°');
    expect(formatPart(-0.90412, turn, '°')).toBe('\u22120.90°');
    expect(formatPart(-0.0044, turn, '°')).toBe('0.00°');
    expect(formatPart(0.0044, { value: 1, low: 1, high: 1 }, '°')).toBe('0.00440°');
  });
});
