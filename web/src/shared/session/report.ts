// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of reports by name, tolerant of their absence.
import type { Report } from '../../jobs/contract';
import { formatCount } from '../../ui';

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
