// SPDX-License-Identifier: GPL-3.0-or-later
// What a relief's report says, in lines.
import type { Report } from '../../jobs/contract';
import { formatDuration, formatFixed, withUnit } from '../../ui';
import { figure, vectorOf } from '../../shared/session/report';

/** "Watertight, 120.0 × 85.5 × 8.0 mm". */
export function solidLine(report: Report): string {
  const size = vectorOf(report, 'size_mm');
  const watertight = report['watertight'];
  const closed = watertight === true ? 'Watertight' : watertight === false ? 'Not watertight' : null;
  const dimensions = size && withUnit(size.map((length) => formatFixed(length, 1)).join(' × '), 'mm');
  return [closed, dimensions].filter(Boolean).join(', ');
}

/** "Looks deeper than the model simply squashed (shading 4.5° closer)". */
function gainLine(report: Report): string | null {
  const own = figure(report, 'normal_error_mean_deg');
  const plain = figure(report, 'normal_error_linear_mean_deg');
  if (own === null || plain === null) return null;
  const gain = plain - own;
  if (Math.abs(gain) < 0.05) return 'Looks as deep as the model simply squashed';
  const by = `${formatFixed(Math.abs(gain), 1)}°`;
  return gain > 0
    ? `Looks deeper than the model simply squashed (shading ${by} closer)`
    : `Looks flatter than the model simply squashed (shading ${by} further off)`;
}

export function solvedLine(seconds: number, report: Report): string {
  return [`Solved in ${formatDuration(seconds)}`, gainLine(report)].filter(Boolean).join('. ');
}

/** Time the solver itself took, without what it kept from before. */
export function solverSeconds(report: Report): number | null {
  const solve = figure(report, 'seconds_solve');
  return solve === null ? null : solve + (figure(report, 'seconds_setup') ?? 0);
}
