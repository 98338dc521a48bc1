// SPDX-License-Identifier: GPL-3.0-or-later
import { useMemo } from 'preact/hooks';
import type { ColourMapping } from '../../view';
import { legendFor } from '../../view';

export interface LegendProps {
  readonly mapping: ColourMapping;
  readonly values: Float32Array;
  /** Where it is known better than from the values. */
  readonly mean?: number | undefined;
  readonly least?: number | undefined;
}

export function Legend({ mapping, values, mean, least }: LegendProps) {
  const legend = useMemo(
    () =>
      legendFor(mapping, values, {
        ...(mean === undefined ? {} : { mean }),
        ...(least === undefined ? {} : { least }),
      }),
    [mapping, values, mean, least],
  );
  return (
    <figure class="panel legend" role="img" aria-label={legend.summary}>
      <figcaption>
        <strong>{legend.label}</strong>
        {legend.mark ? <span>{legend.mark.text}</span> : null}
      </figcaption>
      <div class="legend-bar" style={{ background: legend.gradient }}>
        {legend.mark ? <i style={{ left: `${100 * legend.mark.fraction}%` }} /> : null}
      </div>
      <div class="legend-ticks">
        {legend.ticks.map((tick) => (
          <span key={tick.value} style={{ left: `${100 * tick.fraction}%` }}>
            {tick.text}
          </span>
        ))}
      </div>
    </figure>
  );
}
