// SPDX-License-Identifier: GPL-3.0-or-later
// Lengths and errors of the report, named as the catalog names them.
import type { Json, ReportField } from '../../jobs/contract';
import { formatCount, formatNumber, tipHandlers, withUnit } from '../../ui';
import type { ZippableSession } from './zippable_session';

const named = [
  'zipper_length_mm',
  'ribbon_width_mean_mm',
  'ribbon_width_min_mm',
  'ribbon_size_mm',
  'size_mm',
  'ribbon_to_model_mean_mm',
  'ribbon_to_model_max_mm',
  'model_to_ribbon_max_mm',
  'distortion_mean',
  'distortion_max',
  'isometry_error',
  'fabric_area_mm2',
  'interleaved_share',
  'orders',
  'handles_cut',
];

/** Not in the report of one fabric. */
const ofTwoFabrics = ['fabric_area_mm2', 'interleaved_share'];

function written(value: Json, { unit = '' }: ReportField): string {
  if (Array.isArray(value))
    return withUnit(
      value.map((item) => formatNumber(Number(item), 3)).join(unit === 'mm' ? ' × ' : ' and '),
      unit,
    );
  if (typeof value !== 'number') return '–';
  if (Number.isInteger(value)) return withUnit(formatCount(value), unit);
  if (Math.abs(value) < 1e-6) return value === 0 ? '0' : `under ${withUnit('10⁻⁶', unit)}`;
  return withUnit(formatNumber(value, 3), unit);
}

export function Figures({ session }: { session: ZippableSession }) {
  const shown = session.shown.value?.report;
  const report = shown && { ...shown, ...session.distances.value };
  const fields = session.operation.value?.report ?? [];
  if (report === undefined) return null;
  const rows = named
    .flatMap((name) => fields.find((field) => field.name === name) ?? [])
    .filter(({ name }) => !ofTwoFabrics.includes(name) || report[name] !== undefined);
  return (
    <section class="section figures" aria-label="Lengths and errors">
      <h3>Lengths and errors</h3>
      <dl>
        {rows.map((field) => (
          <div key={field.name} {...tipHandlers(field.help, 'left')}>
            <dt>{field.label}</dt>
            <dd>{written(report[field.name] ?? null, field)}</dd>
          </div>
        ))}
      </dl>
    </section>
  );
}
