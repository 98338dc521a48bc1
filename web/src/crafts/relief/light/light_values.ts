// SPDX-License-Identifier: GPL-3.0-or-later
// What of `relief-light` the page asks for, and what its report says.
import type { JsonObject, Operation, Report } from '../../../jobs/contract';
import { counts } from '../../../shared/panels/parameters/find_parameters';
import { known, withoutDefaults } from '../../../shared/session/craft_document';
import { figure, vectorOf } from '../../../shared/session/report';
import type { ColourMapping } from '../../../view';
import { relief } from '../relief_document';

export const lightOperation = 'relief-light';

export const brightnessMapping: ColourMapping = {
  attribute: 'brightness',
  map: 'brightness',
  minimum: 0,
  maximum: 1,
  unit: '',
  label: 'Brightness',
};

/** The panel's controls: those of the light that count with the kind of light chosen. */
export function lightControls(operation: Operation, values: JsonObject): Operation {
  const all = Object.entries(operation.parameters.properties).filter(
    ([, schema]) => schema['x-group'] === 'Light',
  );
  const properties = Object.fromEntries(all.filter((entry) => counts(entry, values, all)));
  return { ...operation, parameters: { properties } };
}

export const setLight = (operation: Operation, values: JsonObject, coalesce?: string) =>
  relief.command({ label: 'Change the light', ...(coalesce ? { coalesce } : {}) }, ({ light }) => ({
    light: withoutDefaults(operation, { ...light, ...values }),
  }));

/** Along a preview's longer side, where light is computed while one looks for it. */
const previewPoints = 220;
const previewSamples = 48;

/** `made`: the parameters of the relief that is shown; `size_mm`: of its plate. */
export function lightParameters(
  operation: Operation,
  made: JsonObject,
  light: JsonObject,
  preview: { readonly report: Report } | null,
): JsonObject {
  const size = preview && vectorOf(preview.report, 'size_mm');
  if (!size) return { ...known(operation, made), ...light };
  const light_pixel_mm = Number((Math.max(size[0], size[1]) / previewPoints).toPrecision(3));
  const pixel_mm = made['pixel_mm'] ?? operation.parameters.properties['pixel_mm']?.default;
  return {
    ...known(operation, made),
    ...light,
    light_pixel_mm,
    light_samples: previewSamples,
    // The solid need not be finer than its light; what is exported keeps its own detail.
    pixel_mm: Math.min(10, Math.max(Number(pixel_mm), light_pixel_mm / 2)),
  };
}

/** As a screen shows it: IEC 61966-2-1. */
export const srgbOf = (linear: Float32Array): Float32Array =>
  linear.map((c) => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));

interface HourOfDay {
  readonly hour: number;
  readonly similarity: number | null;
  readonly sunOnWall: boolean;
}

export interface DayOfLight {
  readonly hours: readonly HourOfDay[];
  readonly best: number | null;
  readonly bestInSun: number | null;
}

/** Null where the report has none: only the sun has hours. */
export function dayOf(report: Report): DayOfLight | null {
  const rows = report['day'];
  if (!Array.isArray(rows)) return null;
  const hours = rows.flatMap((row): HourOfDay[] => {
    if (typeof row !== 'object' || row === null || Array.isArray(row)) return [];
    const { hour, similarity, sun_on_wall } = row;
    if (typeof hour !== 'number') return [];
    return [
      {
        hour,
        similarity: typeof similarity === 'number' ? similarity : null,
        sunOnWall: sun_on_wall === true,
      },
    ];
  });
  return { hours, best: figure(report, 'best_hour'), bestInSun: figure(report, 'best_sun_hour') };
}

/** 13.5 as "13:30". */
export function clock(hour: number): string {
  const minutes = Math.round(hour * 60);
  return `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, '0')}`;
}

/** The sentence beside the curve, for the eye and the ear. */
export function daySentence({ hours, best, bestInSun }: DayOfLight): string {
  const light = hours.filter(({ similarity }) => similarity !== null);
  const [first, last] = [light[0], light.at(-1)];
  if (!first || !last || best === null) return 'There is no daylight on this day.';
  const sun =
    bestInSun === null
      ? 'The sun does not shine on this wall on this day.'
      : `In the sun it is best at ${clock(bestInSun)}.`;
  return `Daylight from ${clock(first.hour)} to ${clock(last.hour)}. The relief looks most like the model at ${clock(best)}. ${sun}`;
}
