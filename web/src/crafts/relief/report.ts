// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of reports by name, tolerant of their absence.
import type { Report } from '../../jobs/contract';
import { formatCount, formatDuration, formatFixed, withUnit } from '../../ui';

export function figure(report: Report, name: string): number | null {
  const value = report[name];
  return typeof value === 'number' && Number.isFinite(value) ? value : null;
}

export function vectorOf(report: Report, name: string): [number, number, number] | null {
  const value = report[name];
  if (!Array.isArray(value) || value.length !== 3 || !value.every((x) => typeof x === 'number')) return null;
  return value as [number, number, number];
}

export function sentences(report: Report, name: string): string[] {
  const value = report[name];
  return Array.isArray(value) ? value.filter((item): item is string => typeof item === 'string') : [];
}

/** "63,338 triangles, 1 part". */
export function modelLine(report: Report): string {
  const faces = figure(report, 'faces');
  const parts = figure(report, 'components');
  const words = faces === null ? [] : [`${formatCount(faces)} ${faces === 1 ? 'triangle' : 'triangles'}`];
  if (parts !== null) words.push(`${formatCount(parts)} ${parts === 1 ? 'part' : 'parts'}`);
  return words.join(', ');
}

/** "Watertight, 120.0 × 85.5 × 8.0 mm". */
export function solidLine(report: Report): string {
  const size = vectorOf(report, 'size_mm');
  const watertight = report['watertight'];
  const closed = watertight === true ? 'Watertight' : watertight === false ? 'Not watertight' : null;
  const dimensions = size && withUnit(size.map((length) => formatFixed(length, 1)).join(' × '), 'mm');
  return [closed, dimensions].filter(Boolean).join(', ');
}

/** "Normals 11.1° closer than plain scaling". */
export function gainLine(report: Report): string | null {
  const own = figure(report, 'normal_error_mean_deg');
  const plain = figure(report, 'normal_error_linear_mean_deg');
  if (own === null || plain === null) return null;
  const gain = plain - own;
  if (Math.abs(gain) < 0.05) return 'Normals as close as plain scaling';
  return `Normals ${formatFixed(Math.abs(gain), 1)}° ${gain > 0 ? 'closer' : 'further off'} than plain scaling`;
}

export function solvedLine(seconds: number, report: Report): string {
  return [`Solved in ${formatDuration(seconds)}`, gainLine(report)].filter(Boolean).join('. ');
}

/** Time the solver itself took, without what it kept from before. */
export function solverSeconds(report: Report): number | null {
  const solve = figure(report, 'seconds_solve');
  return solve === null ? null : solve + (figure(report, 'seconds_setup') ?? 0);
}
