// SPDX-License-Identifier: GPL-3.0-or-later
import { useMemo } from 'preact/hooks';
import { legendFor } from '../../view';
import { errorMapping } from './meshes';

export function Legend({ values, mean }: { values: Float32Array; mean: number | undefined }) {
  const legend = useMemo(
    () => legendFor(errorMapping, values, mean === undefined ? undefined : { mean }),
    [values, mean],
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
