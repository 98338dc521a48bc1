// SPDX-License-Identifier: GPL-3.0-or-later
// How far the points are off, and what an extended model gains on data it was not shown.
import { formatFixed, formatNumber, withUnit } from '../../../ui';
import type { Diagnosis, Gain } from '../../../shared/diagnosis/diagnosis';
import type { EvidenceSession, Look } from '../evidence_session';
import { modelWords, Pane } from './maps';
import { distancesOf, histogram, meanOf, niceUp, percentile } from './residuals';

const [width, height] = [400, 200];
const bins = 32;

export function Distances({ session, look }: { session: EvidenceSession; look: Look }) {
  const model = session.model.value;
  const { residuals, noiseFloor_mm } = look;
  const base = distancesOf(residuals, 'base');
  const shown = model === 'base' ? base : distancesOf(residuals, model);
  const maximum = niceUp(percentile(base, 0.95));
  const counts = histogram(shown, bins, maximum);
  const before = model === 'base' ? null : histogram(base, bins, maximum);
  const most = Math.max(...counts, ...(before ?? []), 1);
  const [left, bottom] = [8, height - 22];
  const step = (width - 2 * left) / bins;
  const y = (count: number) => bottom - (count / most) * (bottom - 14);
  const noise = noiseFloor_mm === null ? 0 : Math.min(1, noiseFloor_mm / maximum) * (width - 2 * left);
  const mean = withUnit(formatNumber(meanOf(shown), 2), 'mm');
  const beyond = shown.filter((distance) => distance > maximum).length;
  const words = [
    `Distances between measured and simulated, ${modelWords(look, model)}: mean ${mean}`,
    `half below ${withUnit(formatNumber(percentile(shown, 0.5), 2), 'mm')}`,
    `95 % below ${withUnit(formatNumber(percentile(shown, 0.95), 2), 'mm')}`,
    ...(noiseFloor_mm === null
      ? []
      : [`measuring noise alone would give ${withUnit(formatNumber(noiseFloor_mm, 2), 'mm')}`]),
  ].join(', ');
  return (
    <Pane title="Distances" detail={`${mean} on average`}>
      <svg class="chart" viewBox={`0 0 ${width} ${height}`} role="img" aria-label={`${words}.`}>
        {noise > 0 ? <rect class="noise" x={left} y="6" width={noise} height={bottom - 6} /> : null}
        {counts.map((count, i) => (
          <rect
            key={i}
            class={model}
            x={left + i * step + 0.5}
            y={y(count)}
            width={step - 1}
            height={bottom - y(count)}
          />
        ))}
        {before?.map((count, i) =>
          count > 0 ? (
            <rect
              key={`b${i}`}
              class="before"
              x={left + i * step + 1.5}
              y={y(count) - 1}
              width={step - 3}
              height="2"
            />
          ) : null,
        )}
        <line class="axis" x1={left} x2={width - left} y1={bottom} y2={bottom} />
        <text x={left} y={height - 6}>
          0
        </text>
        <text x={width - left} y={height - 6} text-anchor="end">
          {beyond > 0
            ? `${withUnit(formatNumber(maximum, 2), 'mm')} and more`
            : withUnit(formatNumber(maximum, 2), 'mm')}
        </text>
        <g class="key" transform={`translate(${width - 130} 14)`}>
          {noise > 0 ? <KeyLine at={0} kind="noise" text="mean of noise alone" /> : null}
          {before ? <KeyLine at={1} kind="before" text="material alone" /> : null}
        </g>
      </svg>
    </Pane>
  );
}

function KeyLine({ at, kind, text }: { at: number; kind: string; text: string }) {
  const thin = kind === 'before';
  return (
    <g transform={`translate(0 ${17 * at})`}>
      <rect class={kind} x="0" y={thin ? 4 : 0} width="11" height={thin ? 2 : 10} />
      <text x="18" y="9">
        {text}
      </text>
    </g>
  );
}

/** "−70 % (−76 to −62)": of the error. */
function gainWords({ share: { value, low, high } }: Gain): string {
  const change = (share: number) => {
    const rounded = Math.round(-100 * share);
    return rounded > 0 ? `+${rounded}` : formatFixed(rounded, 0);
  };
  return `${withUnit(change(value), '%')} (${change(high)} to ${change(low)})`;
}

export function Gains({ diagnosis }: { diagnosis: Diagnosis }) {
  const { gains, noiseFloor_mm } = diagnosis;
  const [first] = gains;
  if (first === undefined) return null;
  const left = 104;
  const maximum = Math.max(noiseFloor_mm, ...gains.flatMap(({ before, after }) => [before.high, after.high]));
  const x = (value: number) => left + (value / maximum) * (width - left - 52);
  const pitch = gains.length > 1 ? 70 : 86;
  const bottom = 16 + pitch * (gains.length - 1) + 52;
  const words = gains.map(
    (gain) =>
      `${gain.title} (${gain.detail}): mean distance ${formatNumber(gain.before.value, 2)} to ${withUnit(formatNumber(gain.after.value, 2), 'mm')}, ${gainWords(gain)}`,
  );
  return (
    <Pane title="Error on points left out of the fit" detail={gainWords(first)}>
      <svg
        class="chart"
        viewBox={`0 0 ${width} ${height}`}
        role="img"
        aria-label={`${words.join('. ')}. Noise alone: ${withUnit(formatNumber(noiseFloor_mm, 2), 'mm')}. Intervals are 95 %.`}
      >
        {gains.map((gain, i) => (
          <g key={gain.title} transform={`translate(0 ${16 + pitch * i})`}>
            <text class="strong" x="0" y="18">
              {gain.title}
            </text>
            <text x="0" y="33">
              {gain.detail.length > 17 ? `${gain.detail.slice(0, 16)}…` : gain.detail}
            </text>
            {(
              [
                ['base', gain.before, 0],
                ['extended', gain.after, 22],
              ] as const
            ).map(([model, estimate, top]) => (
              <g key={model}>
                <rect
                  class={model}
                  x={left}
                  y={top + 3}
                  width={Math.max(0, x(estimate.value) - left)}
                  height="16"
                  rx="2"
                />
                <path
                  class="interval"
                  d={`M${x(estimate.low)} ${top + 7}v8M${x(estimate.high)} ${top + 7}v8M${x(estimate.low)} ${top + 11}H${x(estimate.high)}`}
                />
                <text class="strong" x={x(Math.max(estimate.high, estimate.value)) + 6} y={top + 15}>
                  {formatNumber(estimate.value, 2)}
                </text>
              </g>
            ))}
          </g>
        ))}
        <line class="axis" x1={left} x2={left} y1="10" y2={bottom} />
        <line class="noise-line" x1={x(noiseFloor_mm)} x2={x(noiseFloor_mm)} y1="10" y2={bottom} />
        <text class="noise-text" x={x(noiseFloor_mm)} y={bottom + 14} text-anchor="middle">
          noise {formatNumber(noiseFloor_mm, 2)}
        </text>
        <text x={width - 4} y={bottom + 14} text-anchor="end">
          mm, mean
        </text>
        <g class="key" transform={`translate(${left} ${height - 12})`}>
          <rect class="base" width="11" height="10" />
          <text x="18" y="9">
            material alone
          </text>
          <g transform="translate(124 0)">
            <rect class="extended" width="11" height="10" />
            <text x="18" y="9">
              with the cause
            </text>
          </g>
        </g>
      </svg>
    </Pane>
  );
}
